% What CLP(R) refutes falsely has a solution in CLP(Q), and what has none is a conflict.
:- use_module('../../../logic/rules/linear/exact').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/linear/linear').
:- use_module(library(clpq), []).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(exact, [cleanup(set_cell(0))]).

% To CLP(R) a factor of less than 1e-10 is zero.
refuted_falsely([(0 =< X)-[a], (1 =< 1.0e-11*X)-[b], (X =< Y)-[c], (Y =< 2.0e11)-[d]]).

whys(Constraints, Whys) :- findall(Why, member(_-[Why], Constraints), Found), sort(Found, Whys).

test(clpr_refutes_a_system_that_has_a_solution, fail) :- refuted_falsely(S), posted(S).
test(clpq_finds_the_solution) :- refuted_falsely(S), exactly_posted(S).
test(it_has_no_conflict, fail) :- refuted_falsely(S), member(Proof, [minimal,quick]), exact_conflict(Proof, S, _).
test(a_conflict_beside_it_is_found_without_it, Whys == [d,e]) :-
    refuted_falsely(S), last(S, (Y =< _)-_), append(S, [(3.0e11 =< Y)-[e]], All),
    exact_conflict(minimal, All, Conflict), whys(Conflict, Whys).
test(a_quick_conflict_beside_it_is_proved_too) :-
    refuted_falsely(S), last(S, (Y =< _)-_), append(S, [(3.0e11 =< Y)-[e]], All),
    exact_conflict(quick, All, Conflict), \+ exactly_posted(Conflict).
test(numbers_are_taken_as_they_are_written) :- exactly_posted([(0.3 = 0.1+0.2)-[], (0.1+0.2 =< 0.3)-[]]).
test(each_unknown_is_sampled_in_what_those_before_it_leave) :-
    refuted_falsely(S), S = [(0 =< X)-_|_], last(S, (Y =< _)-_),
    exactly_posted(S), call(exactly_sampled([1-X,1-Y]), 1, _),
    X >= 10**11, X =< Y, Y =< 2*10**11.
test(on_a_grid_it_is_whole, [setup(set_cell(1.0)), cleanup(set_cell(0))]) :-
    clpq:{0 =< X, X =< 9}, call(exactly_sampled([1-X]), 1, _), integer(X).
test(both_verdicts_are_given, Real-Rational == false-true) :-
    refuted_falsely(S), solver_verdicts(S, Record), Real = Record.real, Rational = Record.rational.

:- end_tests(exact).
