:- module(opening_sizes, [opening_wall/4, opening_range/4, opening_clause/3]).

/** <module> How wide an opening between two rooms is: a door without a leaf, at least as wide as every door

It has no margin: a clause may leave some of the wall.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module('../language/grammar_files').
:- use_module('../language/lengths').
:- use_module('../linear/grid').

:- table opening_wall/4.

%!  opening_clause(+Type, +Other, -Head) is semidet.
%
%   Head is opening_size(A,B,Length,Wall), called as the grammar states it for these types: for one of them and the other.

opening_clause(T, U, opening_size(A,B,L,Wall)) :-
    member(A-B, [T-U,U-T]),
    \+ \+ sized(opening_size(A,B,L,Wall)), !.

%!  opening_wall(+Type, +Other, -Least, -Why) is det.
%
%   Least is the shortest part of a wall, in the house's unit, that has an opening between rooms of these types, for these clauses.

opening_wall(T, U, Least, Why) :-
    door_width_of(T, U, Width, Clause),
    (   opening_clause(T, U, opening_size(A,B,L,Wall))
    ->  Why = [opening_size(A,B),Clause],
        metres(Width, W),
        (   findall(Low, ( sized(opening_size(A,B,L,Wall)), {L >= W, L =< Wall}, inf(Wall, Low) ), [Shortest])
        ->  rounded_up(Shortest, First), some_opening(T-U, First, Least)
        ;   Least = 1000000 )                       % there is none
    ;   Why = [Clause], Least = Width ).

%   some_opening(+Types, +From, -Least): on a grid the first wall from this length on that has an opening of whole cells.

some_opening(Types, Wall, Wall) :- \+ on_grid, !, Types = _.
some_opening(T-U, Wall, Least) :-
    (   opening_range(T, U, Wall, _)
    ->  Least = Wall
    ;   Wall < 1000, Longer is Wall + 1, some_opening(T-U, Longer, Least) ), !.
some_opening(_, _, 1000000).

%!  opening_range(+Type, +Other, +Wall, -Range) is semidet.
%
%   Range is how wide an opening may be, least and greatest, in a part of a wall as long as Wall: all of it without a clause. Fails
%   where it has none, but for a rounding error.

opening_range(T, U, Wall, Low-High) :-
    opening_clause(T, U, opening_size(A,B,L,Long)), !,
    door_width_of(T, U, Width, _),
    maplist(metres, [Wall,Width], [M,W]),
    Long is M + 1.0e-6,
    findall(Least-Most, ( sized(opening_size(A,B,L,Long)), {L >= W, L =< Long}, extremes(L, Least-Most) ), [Range]),
    Range = Least-Most,
    maplist(in_unit, [Least,Most], [From,To]),
    inner_range(From-To, First-Last), First =< Last,
    Low is min(First, Wall), High is min(Last, Wall).
opening_range(T, U, Wall, Wall-Wall) :- door_width_of(T, U, Width, _), Wall >= Width - 1.0e-6.
