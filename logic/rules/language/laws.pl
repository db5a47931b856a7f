:- module(laws, [room_law/2, piece_law/3, law_at_wall/3]).

/** <module> How the two sizes of a room or a piece depend on each other

A law is in metres, and is what can be sampled without the solver:

    box(A,AA,B,BB)     not at all: the one lies in A..AA, the other in B..BB
    line(A,AA,B,BB)    on the straight line from (A,B) to (AA,BB)
    clause             in a way that only the clause itself says
    sloped(Law)        a box or line whose numbers may be on(Wall,Y,Slope): Y where the wall is Wall long, and
                       from there on in a straight line
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(grammar_files).
:- use_module('../linear/grid').
:- use_module(lengths).

:- table room_law/2, piece_law/3.         % a few simplex runs each, needed in every room

%!  room_law(+Type, -Law) is det.
%
%   Law of the width and the depth of a room.

room_law(Type, Law) :-
    sized(room_size(Type, W, D)),
    law(W, D, Law).

%!  piece_law(+Type, +Piece, -Law) is det.
%
%   Law of the length and the depth of a piece in a room of this type.

piece_law(Type, Piece, Law) :-
    room_range(Type, W1-W2, D1-D2),
    Short is min(W1, D1), Long is max(W2, D2), Middle is (Short+Long)/2,
    piece_sized(Piece, L, D, Wall-Across),
    (   attvar(Across)
    ->  Law = clause
    ;   \+ attvar(Wall)
    ->  law(L, D, Law)
    ;   maplist(law_for_wall(Piece), [Short,Middle,Long], [Law1,Law2,Law3]),
        Law1 =.. [Kind|As], Law2 =.. [Kind|Bs], Law3 =.. [Kind|Cs],
        straight(As, Bs, Cs, Short-Long, Straight)
    ->  Sloped =.. [Kind|Straight], Law = sloped(Sloped)
    ;   Law = clause ).

law_for_wall(Piece, Wall, Law) :- piece_sized(Piece, L, D, Wall-_), law(L, D, Law).

%   The least and the greatest of a linear program are convex and concave in what is given: what lies on the straight
%   line in the middle lies on it throughout.

straight([], [], [], _, []).
straight([A|As], [B|Bs], [C|Cs], Short-Long, [Y|Ys]) :-
    abs(B - (A+C)/2) < 1.0e-9,
    ( abs(A-C) < 1.0e-9 -> Y = A ; Slope is (C-A)/(Long-Short), Y = on(Short,A,Slope) ),
    straight(As, Bs, Cs, Short-Long, Ys).

law(A, B, Law) :-
    extremes(A, A1-A2), extremes(B, B1-B2),
    (   ( on_grid ; A \== B, independent(A, B) )
    ->  Law = box(A1,A2,B1,B2)
    ;   value_at(A, A1, B, V1), value_at(A, A2, B, V2)
    ->  Law = line(A1,A2,V1,V2)
    ;   Law = clause ).

independent(A, B) :-
    copy_term(A-B, _, Goals),
    forall(member({Goal}, Goals), ( term_variables(Goal, Variables), length(Variables, 1) )).

value_at(A, V, B, W) :- findall(B, {A = V}, [W]), number(W).

%!  law_at_wall(+Law, +Walls, -Here) is det.
%
%   Here is the law with its numbers for a wall this long, in the house's unit.

law_at_wall(sloped(Law), Wall-_, Here) :- !,
    Law =.. [Kind|Ys],
    metres(Wall, Metres),
    maplist(number_at_wall(Metres), Ys, Xs),
    Here =.. [Kind|Xs].
law_at_wall(Law, _, Law).

number_at_wall(Wall, on(Wall1,Y1,Slope), Y) :- !, Y is Y1 + Slope*(Wall-Wall1).
number_at_wall(_, Y, Y).
