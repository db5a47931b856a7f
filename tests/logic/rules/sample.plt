% Random numbers: with a given state the numbers are given.
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/linear/sample').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(sample).

near(X, Y) :- abs(X - Y) < 1.0e-9.

sampled(Goal, State) :- call(Goal, State, _).

samples(Count, Goal^X, Xs) :- findall(X, ( between(1, Count, Seed), call(Goal, Seed, _) ), Xs).

numbers(0, _, []) :- !.
numbers(N, State0, [U|Us]) :- unit_sample(U, State0, State), N1 is N-1, numbers(N1, State, Us).

test(numbers_lie_between_0_and_1, true(( Least >= 0.0, Most < 1.0 ))) :-
    numbers(1000, 7, Us), min_list(Us, Least), max_list(Us, Most).
test(their_mean_is_a_half, true(abs(Mean - 0.5) < 0.03)) :-
    numbers(1000, 7, Us), sum_list(Us, Sum), Mean is Sum/1000.
test(the_stream_is_that_of_knuths_mmix, State == 1442695040888963407) :- unit_sample(_, 0, State).
test(a_stream_depends_on_its_seed_alone, true(( A == B, A \== C ))) :-
    numbers(5, 1, A), numbers(5, 1, B), numbers(5, 2, C).
test(a_projection_sample_lies_in_its_projection, true(( X >= 2, X =< 4 ))) :- {X >= 2, X =< 4}, sampled(projection_sample(X), 99).
test(each_projection_is_what_those_before_leave) :-
    forall(between(1, 50, Seed), ( {X >= 0, Y >= 0, X + Y =< 1}, sampled(all_projections_sample([X,Y]), Seed), X + Y =< 1 + 1.0e-9 )).
test(a_known_number_takes_no_random_number, State == 99) :- {X = 1}, call(projection_sample(X), 99, State).
test(one_gap_is_uniform) :- unit_sample(U, 5, _), sampled(interval_sample(0, 2, 1, X), 5), near(X, 2*U).
test(of_three_gaps_the_first_is_least) :- unit_sample(U, 5, _), sampled(interval_sample(0, 1, 3, X), 5), near(X, 1 - (1-U)**(1/3)).
test(ends_that_meet_are_a_point) :- sampled(interval_sample(1, 1.0000000001, 1, X), 5), near(X, 1.00000000005).
test(on_a_grid_samples_are_whole_and_all_occur, [setup(set_cell(1.0)), cleanup(set_cell(0)), true(Found == [1,2,3])]) :-
    samples(100, interval_sample(0.5, 3.2, 1, X)^X, Xs),
    sort(Xs, Found).
test(a_whole_range_of_one_cell_is_that_cell, [setup(set_cell(1.0)), cleanup(set_cell(0)), true(Found == [2])]) :-
    samples(20, interval_sample(2, 2.0, 2, X)^X, Xs),
    sort(Xs, Found).

:- end_tests(sample).
