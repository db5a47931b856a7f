% Sizes and areas: what the linear constraints let in has the area that is stated, and where any size has it, some are let in.
:- use_module('../../../logic/rules/shared_walls/areas').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/linear/linear').
:- use_module('../../../logic/rules/linear/regions').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

sizes(W, D, [W >= 2, W =< 4, D >= 2, D =< 4]).
sizes(W, D, [W >= 1.1, W =< 1.6, D >= 2.4, D =< 9]).
sizes(W, D, [W >= 2, W =< 4, D = W]).
sizes(W, D, [W = 3, D >= 2, D =< 4]).
sizes(W, D, [D >= 2, D =< 3, W >= 2*D, W =< 3*D]).
sizes(W, D, [W >= 1, D >= 1, W + D =< 7, D =< 2*W]).

system(Sizes, System) :- maplist(at_most, Sizes, System).
at_most(A >= B, (B =< A)-[size]) :- !.
at_most(C, C-[size]).

:- begin_tests(areas).

%   possible(-W, -D, -System, -Areas): areas that some size has, hardly and easily.

possible(W, D, System, Least-Most) :-
    sizes(W, D, Sizes), system(Sizes, System),
    once(corners(System, W, D, Corners)), least_and_greatest_area(Corners, Low-_, High-_),
    member(From-To, [0-0,0-0.01,0.2-0.21,0.5-0.5,0.3-0.9,0.99-1,1-1,-0.3-0.05,0.9-1.5,-1-2]),
    Least is max(0, Low + From*(High-Low)), Most is Low + To*(High-Low).

test(some_size_has_a_possible_area, [forall(possible(W,D,System,Least-Most))]) :-
    areas:corners(System, W, D, Corners),
    findall(W1-W2, ( posted(System), inf(W, W1), sup(W, W2) ), [Width]), findall(D1-D2, ( posted(System), inf(D, D1), sup(D, D2) ), [Depth]),
    phrase(areas:area(Corners, Width, Depth, Least-Most, W, D, [room_area]), Areas), append(System, Areas, All),
    corners(All, W, D, Left),
    forall(member(V-E, Left), ( V*E > Least - 1.0e-6, V*E < Most + 1.0e-6 )).
test(no_size_has_an_area_beyond_all, [forall(( sizes(W,D,Sizes), member(Least-Most, [0-0.5,30-40]) )), fail]) :-
    system(Sizes, System),
    areas:corners(System, W, D, Corners),
    phrase(areas:area(Corners, 0-9, 0-9, Least-Most, W, D, [room_area]), Areas), append(System, Areas, All),
    posted(All).
test(the_corners_of_a_box, Corners == [2.0-3.0,2.0-5.0,4.0-3.0,4.0-5.0]) :-
    corners([(2 =< W)-x,(W =< 4)-x,(3 =< D)-x,(D =< 5)-x], W, D, Corners0), sort(Corners0, Corners).
test(the_greatest_area_on_a_slanted_edge, Area =:= 12.25) :-
    corners([(1 =< W)-x,(1 =< D)-x,(W+D =< 7)-x], W, D, Corners), least_and_greatest_area(Corners, 1.0-_, Area-_).

:- end_tests(areas).
