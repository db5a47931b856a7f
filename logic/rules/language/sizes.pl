:- module(sizes, [room_size_system/4, item_size_system/3, item_extent/4, size_system/4, projected_system/4]).

/** <module> The linear constraints that the clauses of sizes state, as data (linear.pl)

An item is item(Piece,Length,Depth,Walls): what has a size by piece_size/4, in a room of these walls (lengths.pl).
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(yall)).
:- use_module(grammar_files).
:- use_module('../linear/grid').
:- use_module(lengths).

:- table clause_system/4.                 % a clause is solved once, whatever the wall

%!  room_size_system(+Type, ?Width, ?Depth, -Constraints) is det.

room_size_system(Type, W, D, Constraints) :-
    on_grid, !,
    room_extent(Type, Width, Depth),
    box_system(W-D, Width, Depth, size(Type), Constraints).
room_size_system(Type, W, D, Constraints) :-
    sized(room_size(Type, W0, D0)),
    size_system([W,D], [W0,D0], size(Type), Constraints).

%!  item_size_system(+Type, ?Item, -Constraints) is det.
%
%   Constraints of an item in a room of this type.

item_size_system(Type, item(Piece,L,D,Walls), Constraints) :-
    on_grid, !,
    item_extent(Type, item(Piece,L,D,Walls), Length, Depth),
    box_system(L-D, Length, Depth, size(Type,Piece), Constraints).
item_size_system(Type, item(Piece,L,D,Wall-Across), Constraints) :-
    clause_system(Type, Piece, Sizes, Constraints),
    Sizes = [L,D,Wall,Across].

%!  item_extent(+Type, +Item, -Length, -Depth) is det.
%
%   The ranges of an item's sizes, in the house's unit: of a room with these walls if they are known, else of any of this type.

item_extent(_, item(Piece,_,_,Wall-Across), Length, Depth) :-
    number(Wall), !,
    metres(Wall, Metres), metres(Across, MetresAcross),
    piece_range(Piece, Metres-MetresAcross, L, D),
    rounded_range(L, Length),
    rounded_range(D, Depth).
item_extent(Type, item(Piece,_,_,_), Length, Depth) :- piece_extent(Type, Piece, Length, Depth).

box_system(L-D, L1-L2, D1-D2, Reason, Constraints) :-
    maplist(reasoned(Reason), [L1 =< L, L =< L2, D1 =< D, D =< D2], Constraints).

clause_system(Type, Piece, Sizes, Constraints) :-
    piece_sized(Piece, L, D, Wall-Across),
    size_system(Sizes, [L,D,Wall,Across], size(Type,Piece), Constraints).

%!  size_system(?Sizes, +Solved, +Reason, -Constraints) is det.
%
%   Constraints of Sizes: what the store states about Solved.

size_system(Sizes, Solved, Reason, Constraints) :-
    copy_term(Solved, Plain, Goals),
    stated_system(Sizes, Plain, Goals, Reason, Constraints).

%!  projected_system(?Sizes, +Solved, +Reason, -Constraints) is det.
%
%   As size_system/4, but Constraints are of these Sizes alone: all other variables are projected out.

projected_system(Sizes, Solved, Reason, Constraints) :-
    term_variables(Solved, Unknown),
    copy_term_nat(Solved-Unknown, Plain-Names),
    dump(Unknown, Names, Goals),
    maplist([Goal,{Goal}]>>true, Goals, Braced),
    stated_system(Sizes, Plain, Braced, Reason, Constraints).

stated_system(Sizes, Plain, Goals, Reason, Constraints) :-
    equated(Sizes, Plain, [], Equations),
    phrase(residual(Goals), Residual),
    append(Equations, Residual, All),
    maplist(reasoned(Reason), All, Constraints).

reasoned(Reason, Constraint, Constraint-[Reason]).

%   equated(?Sizes, ?Plain, +Known, -Equations): an unknown becomes the first size that it stands for; further sizes equal it.

equated([], [], _, []).
equated([S|Ss], [P|Ps], Known, Equations) :-
    (   var(P), \+ ( member(K, Known), K == P )
    ->  S = P, Equations = Others
    ;   Equations = [S = P|Others] ),
    equated(Ss, Ps, [P|Known], Others).

residual([])             --> [].
residual([{Goal}|Goals]) --> conjuncts(Goal), residual(Goals).

conjuncts((A,B))   --> !, conjuncts(A), conjuncts(B).
conjuncts(A >= B)  --> !, [B =< A].
conjuncts(A > B)   --> !, [B =< A].
conjuncts(A < B)   --> !, [A =< B].
conjuncts(A =:= B) --> !, [A = B].
conjuncts(C)       --> [C].
