:- module(regions, [corners/4, least_and_greatest_area/3, point_of_area/4]).

/** <module> What linear constraints leave to a width and a depth: a convex polygon, and the areas in it

A point is W-D, a rectangle's width and depth. An area W*D is not linear, but its extremes over a polygon are known exactly.
*/

:- use_module(library(apply)).
:- use_module(library(clpq), []).
:- use_module(library(lists)).
:- use_module(library(yall)).
:- use_module(exact).

%!  corners(+Constraints, +W, +D, -Corners) is semidet.
%
%   Corners are those of the polygon that the Constraints (linear.pl) leave to W and D, in turn. Fails where they leave nothing,
%   or bound a side not at all.

corners(Constraints, W, D, Corners) :-
    findall(Points, ( exactly_posted(Constraints), polygon(W, D, Points) ), [Corners]).

polygon(W, D, Points) :-
    maplist(farthest(W, D), [-1 - 0, 0 - 1, 1 - 0, 0 - -1], Extremes),
    Extremes = [First|_], append(Extremes, [First], Turns),
    phrase(edges(Turns, W, D), Found),
    list_to_set(Found, Exact),
    maplist([X-Y,V-E]>>( V is float(X), E is float(Y) ), Exact, Points).

edges([_], _, _)         --> [].
edges([P,Q|Ps], W, D) --> edge(P, Q, W, D), edges([Q|Ps], W, D).

%   edge(+P, +Q, +W, +D)// describes the corners from P on before Q: what lies farthest out from the line between them.

edge(W1-D1, W2-D2, W, D) -->
    { Across is D1 - D2, Along is W2 - W1, Across-Along \== 0-0,
      farthest(W, D, Across-Along, W3-D3),
      Across*(W3-W1) + Along*(D3-D1) > 0 }, !,
    edge(W1-D1, W3-D3, W, D), edge(W3-D3, W2-D2, W, D).
edge(P, _, _, _) --> [P].

%   farthest(+W, +D, +Way, -Corner) is semidet.

farthest(W, D, A-B, Corner) :-
    clpq:sup(A*W + B*D, Most),
    findall(V-E, ( clpq:{A*W + B*D = Most}, clpq:inf(W, V), clpq:{W = V}, clpq:inf(D, E) ), [Corner]).

%!  least_and_greatest_area(+Corners, -Least, -Greatest) is det.
%
%   Least and Greatest are Area-Point. On a line, an area is least at an end.

least_and_greatest_area(Corners, Least, Greatest) :-
    maplist(with_area, Corners, Sized), min_member(Least, Sized),
    Corners = [First|_], append(Corners, [First], Turns),
    findall(Area-Point, ( nextto(P, Q, Turns), between_ends(P, Q, Point), with_area(Point, Area-Point) ), Between),
    append(Sized, Between, All), max_member(Greatest, All).

with_area(W-D, Area-(W-D)) :- Area is W*D.

%   between_ends(+P, +Q, -Point) is semidet: there the area is greatest on the line between them, and at no end.

between_ends(W1-D1, W2-D2, W-D) :-
    DW is W2 - W1, DD is D2 - D1, DW*DD < 0,
    T is -(W1*DD + D1*DW) / (2*DW*DD), T > 0, T < 1,
    W is W1 + T*DW, D is D1 + T*DD.

%!  point_of_area(+Area, +P, +Q, -Point) is det.
%
%   Point has this Area on the line from P to Q, of which P has less and Q has more.

point_of_area(Area, P, Q, Point) :- halved(60, Area, P, Q, Point).

halved(0, _, P, _, P) :- !.
halved(N, Area, W1-D1, W2-D2, Point) :-
    W is (W1+W2)/2, D is (D1+D2)/2, Fewer is N - 1,
    ( W*D > Area -> halved(Fewer, Area, W1-D1, W-D, Point) ; halved(Fewer, Area, W-D, W2-D2, Point) ).
