:- module(lengths, [stated_length/2, length_of/2, door_width_of/4, stated_for/1, sized/1, turning_side/2, piece_sized/4, given_walls/3, room_range/3, always_longer/1, piece_range/4, room_extent/3, piece_extent/4, extremes/2]).

/** <module> A grammar's lengths and the extremes of its sizes

The grammar's clauses are the single source of lengths; what stage 1 needs of them is derived here. A range is
Low-High: a `range` is in metres, an `extent` is the same in the house's own unit (grid.pl).
*/

:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(grammar_files).
:- use_module('../linear/grid').

:- table room_extent/3, piece_extent/4.   % a few simplex runs each, needed in every room

%!  stated_length(+Name, -Metres) is nondet.
%
%   The grammar states this length, once unless it is wrong.

stated_length(door_width,     M) :- grammar:door_width(M).
stated_length(door_clearance, M) :- grammar:door_clearance(M).
stated_length(passage,        M) :- grammar:passage(M).
stated_length(room_gap,       M) :- grammar:room_gap(M).
stated_length(door_margin,    M) :- ( clause(grammar:door_margin(_), _) -> grammar:door_margin(M) ; M = 0.0 ).
stated_length(window_margin,  M) :- ( clause(grammar:window_margin(_), _) -> grammar:window_margin(M) ; M = 0.0 ).
stated_length(inner_wall,     M) :- ( stated_wall(inner) -> grammar:wall_thickness(inner, M) ; M = 0.0 ).
stated_length(outer_wall,     M) :- ( stated_wall(outer) -> grammar:wall_thickness(outer, M) ; stated_length(inner_wall, M) ).

stated_wall(Kind) :- \+ \+ ( clause(grammar:wall_thickness(K, _), _), K == Kind ).

%!  length_of(+Name, -Length) is det.
%
%   Length is that of the grammar, in the house's unit.

length_of(Name, Length) :- stated_length(Name, M), rounded_up(M, Length).

%!  door_width_of(+Type, +Other, -Width, -Why) is det.
%
%   Width is that of a door between rooms of these types, or a room and `outside`, in the house's unit, for this clause.

door_width_of(T, U, Width, Why) :-
    (   member(A-B, [T-U,U-T]), once(( clause(grammar:door_width(A0,B0,_), _), A0-B0 == A-B )), grammar:door_width(A, B, M)
    ->  rounded_up(M, Width), Why = door_width(A,B)
    ;   length_of(door_width, Width), Why = length(door_width) ).

%!  stated_for(+Head) is semidet.
%
%   The grammar has a clause for the type that is the first argument of this Head: that names it, or is for every type, or for those
%   that its body gives.

stated_for(Head) :-
    functor(Head, Name, Arity), functor(Any, Name, Arity),
    arg(1, Head, Type),
    clause(grammar:Any, Body), arg(1, Any, For),
    (   nonvar(For)
    ->  For == Type
    ;   \+ ( term_variables(Body, Variables), member(V, Variables), V == For )
    ->  true
    ;   \+ \+ sized(Head) ), !.

%!  sized(?Head) is semidet.
%
%   The grammar's clause of a size holds. Throws endless(Head) where that takes more inferences than any size should.

sized(Head) :-
    call_with_inference_limit(grammar:Head, 300 000, Result),
    ( Result == inference_limit_exceeded -> throw(endless(Head)) ; true ), !.

%!  turning_side(+Type, -Side) is semidet.
%
%   A square as wide as Side is free in rooms of this type, metres. Fails where the grammar does not say so.

turning_side(Type, Side) :- clause(grammar:turning(_,_), _), sized(turning(Type, Side)).

%!  room_range(+Type, -Width, -Depth) is semidet.
%
%   Width and Depth are the ranges of a room of this type. Fails where the grammar has no clause for it.

room_range(Type, Width, Depth) :-
    sized(room_size(Type, W, D)),
    extremes(W, Width),
    extremes(D, Depth).

%!  room_extent(+Type, -Width, -Depth) is semidet.
%
%   As room_range/3, in the house's unit.

room_extent(Type, Width, Depth) :-
    room_range(Type, W, D),
    rounded_range(W, Width),
    rounded_range(D, Depth).

%!  always_longer(+Type) is semidet.
%
%   By its size alone no room of this type is wider than it is deep.

always_longer(Type) :- room_range(Type, _-Widest, Shallowest-_), Widest =< Shallowest.

%!  piece_sized(+Piece, ?Length, ?Depth, ?Walls) is semidet.
%
%   The grammar's clause of the piece's size holds in a room of these Walls, Wall-Across: the wall behind the piece and the
%   room's other side. Most clauses are of the Wall alone.

piece_sized(Piece, L, D, Walls) :-
    given_walls(Piece, Walls, Given),
    sized(piece_size(Piece, L, D, Given)).

%!  given_walls(+Piece, ?Walls, -Given) is det.
%
%   Given is what the piece's clause is called with: the Wall, or Wall-Across where it is written so.

given_walls(Piece, Wall-Across, Given) :-
    (   clause(grammar:piece_size(Piece, _, _, Written), _), nonvar(Written)
    ->  Given = Wall-Across
    ;   Given = Wall ).

%!  piece_range(+Piece, ?Walls, -Length, -Depth) is semidet.
%
%   Length and Depth are the ranges of a piece in a room of these walls, numbers of metres or constrained.

piece_range(Piece, Walls, Length, Depth) :-
    piece_sized(Piece, L, D, Walls),
    extremes(L, Length),
    extremes(D, Depth).

%!  piece_extent(+Type, +Piece, -Length, -Depth) is semidet.
%
%   As piece_range/4, at any wall of a room of this type, in the house's unit.

piece_extent(Type, Piece, Length, Depth) :-
    room_range(Type, W1-W2, D1-D2),
    Least is min(W1, D1), Most is max(W2, D2),
    { Wall >= Least, Wall =< Most, Across >= Least, Across =< Most },
    piece_range(Piece, Wall-Across, L, D),
    rounded_range(L, Length),
    rounded_range(D, Depth).

%!  extremes(?X, -Range) is semidet.
%
%   Range is what the store leaves of X. Fails where X is not bounded on both sides.

extremes(X, X-X)      :- number(X), !.
extremes(X, Low-High) :- inf(X, Low), sup(X, High).
