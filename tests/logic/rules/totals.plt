% Areas that are sums: what is known of a room's area while its sides are unknown, and how often ranges are halved.
:- use_module('../../../logic/rules/shared_walls/totals').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(totals).

%   area(+Constraints, -Low, -High): what is left of the area of a room that is W by D, of 2 to 4 m each, and 5 to 15 square metres.

area(W, D, Constraints, Low, High) :-
    totals:boxes_bounded([box(r,W,D,ranges(2-4,2-4,5-15),[own],[all])], [r-A], Bounds),
    append(Constraints, Bounds, All),
    findall(L-H, ( forall_posted(All), inf(A, L), sup(A, H) ), [Low-High]).

forall_posted([]).
forall_posted([C-_|Cs]) :- {C}, forall_posted(Cs).

near(X, Y) :- abs(X - Y) < 1.0e-6.

test(an_area_lies_between_those_that_are_stated, true(( near(Low, 5), near(High, 15) ))) :- area(_, _, [], Low, High).
test(the_area_of_a_room_of_least_width_is_exact, true(( near(Low, 6), near(High, 6) ))) :- area(W, D, [(W = 2)-w,(D = 3)-d], Low, High).
test(the_area_of_a_room_of_greatest_depth_is_exact, true(( near(Low, 10), near(High, 10) ))) :-
    area(W, D, [(W = 2.5)-w,(D = 4)-d], Low, High).
test(no_area_is_lost_between, true(( Low =< 9, High >= 9 ))) :- area(W, D, [(W = 3)-w,(D = 3)-d], Low, High).
test(bounds_between_are_those_of_mccormick, true(( near(Low, 8), near(High, 10) ))) :- area(W, D, [(W = 3)-w,(D = 3)-d], Low, High).
test(any_number_of_halvings_is_never_used_up, [true(Fewer == any), nondet]) :- totals:fewer(any, Fewer).
test(a_number_of_halvings_is_used_up, Fewer == 0) :- totals:fewer(1, Fewer).
test(no_halvings_are_left, fail) :- totals:fewer(0, _).

:- end_tests(totals).
