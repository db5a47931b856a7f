% Drawing from a solved store: with given random numbers the places are given.
:- use_module('../../logic/rules/draw').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(draw).

near(X, Y) :- abs(X - Y) < 1.0e-9.

test(uniform_lies_in_its_share, X =:= 3.0) :- {X >= 2, X =< 4}, phrase(uniform(X), [0.5], []).
test(a_box_that_fits_takes_one_number, Rest == [0.9]) :-
    {X >= 0, X =< 10}, phrase(uniform(X, 0, 10), [0.25,0.9], Rest), near(X, 2.5).
test(a_box_too_wide_takes_two, Rest == []) :-
    {X >= 0, X =< 1}, phrase(uniform(X, 0, 10), [0.5,0.25], Rest), near(X, 0.75).
test(a_fixed_number_takes_none, Rest == [0.5]) :- {X = 1}, phrase(uniform(X), [0.5], Rest).
test(one_gap_behind_is_uniform) :- {X >= 0, X =< 1}, phrase(start(X, 1), [0.25], []), near(X, 0.75).
test(three_gaps_behind) :- {X >= 0, X =< 1}, phrase(start(X, 3), [0.125], []), near(X, 0.5).
test(no_gap_behind_is_the_end) :- {X >= 1, X =< 1}, phrase(start(X, 0), [0.3], _), near(X, 1.0).
test(ends) :- {A >= 0.5, B =< 2}, lowest(A), highest(B), near(A, 0.5), near(B, 2.0).

:- end_tests(draw).
