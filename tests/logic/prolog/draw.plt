% Drawing numbers: with a given state the numbers are given.
:- use_module('../../../logic/rules/draw').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(draw, [cleanup(grid(real))]).

near(X, Y) :- abs(X - Y) < 1.0e-9.

grid(Kind) :- retractall(draw:lattice(_)), assertz(draw:lattice(Kind)).

drawn(Goal, State) :- call(Goal, State, _).

test(numbers_lie_between_0_and_1, true(( Least >= 0.0, Most < 1.0 ))) :-
    numbers(1000, 7, Us), min_list(Us, Least), max_list(Us, Most).
test(their_mean_is_a_half, true(abs(Mean - 0.5) < 0.03)) :-
    numbers(1000, 7, Us), sum_list(Us, Sum), Mean is Sum/1000.
test(a_stream_depends_on_its_seed_alone, true(( A == B, A \== C ))) :-
    numbers(5, 1, A), numbers(5, 1, B), numbers(5, 2, C).
test(uniform_lies_in_its_projection, true(( X >= 2, X =< 4 ))) :- {X >= 2, X =< 4}, drawn(uniform(X), 99).
test(a_known_number_takes_none, State == 99) :- {X = 1}, call(uniform(X), 99, State).
test(one_gap_is_uniform) :- random(U, 5, _), drawn(between_ends(0, 2, 1, X), 5), near(X, 2*U).
test(of_three_gaps_the_first_is_least) :- random(U, 5, _), drawn(between_ends(0, 1, 3, X), 5), near(X, 1 - (1-U)**(1/3)).
test(ends_that_meet_are_a_point) :- drawn(between_ends(1, 1.0000000001, 1, X), 5), near(X, 1.00000000005).
test(on_a_grid_numbers_are_whole, Found == [1,2,3]) :-
    grid(whole),
    findall(X, ( between(1, 100, Seed), drawn(between_ends(0.5, 3.2, 1, X), Seed) ), Xs),
    sort(Xs, Found).

numbers(0, _, []) :- !.
numbers(N, State0, [U|Us]) :- random(U, State0, State), N1 is N-1, numbers(N1, State, Us).

:- end_tests(draw).
