% Linear systems as data.
:- use_module('../../../logic/rules/linear/linear').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(linear).

whys(Constraints, Whys) :- findall(Why, member(_-Why, Constraints), Found), sort(Found, Whys).

system([(0 =< Z)-[d], (3 =< X)-[a], (Z =< X)-[e], (X =< Y)-[b], (Z =< 9)-[f], (Y =< 2)-[c], (Y =< 5)-[g]]).

test(a_system_with_a_solution_is_posted) :- posted([(1 =< X)-[a], (X =< Y)-[b], (Y =< 2)-[c]]), {X >= 1}.
test(a_system_without_a_solution_fails, fail) :- posted([(3 =< X)-[a], (X =< Y)-[b], (Y =< 2)-[c]]).
test(the_empty_system_holds) :- posted([]).
test(a_minimal_conflict_is_all_that_is_needed, Whys == [[a],[b],[c]]) :- system(S), minimal_conflict(S, Conflict), whys(Conflict, Whys).
test(without_any_part_of_it_there_is_a_solution) :-
    system(S), minimal_conflict(S, Conflict),
    forall(select(_, Conflict, Rest), \+ \+ posted(Rest)).
test(a_quick_conflict_holds_a_minimal_one, Whys == [[a],[b],[c],[d]]) :-
    S = [(0 =< _)-[d], (3 =< X)-[a], (X =< Y)-[b], (Y =< 2)-[c], (Y =< 5)-[g]],
    findall(Count, posted(S, Count), [Count]), conflict_at(quick, S, Count, Conflict),
    whys(Conflict, Whys).
test(below_where_posting_stops_lies_the_minimal_conflict, Whys == Minimal) :-
    system(S), findall(Count, posted(S, Count), [Count]), conflict_at(minimal, S, Count, Conflict), whys(Conflict, Whys),
    minimal_conflict(S, Whole), whys(Whole, Minimal).
test(a_false_constraint_between_numbers_is_a_conflict_alone, Whys == [[b]]) :-
    minimal_conflict([(0 =< _)-[a], (3 =< 2)-[b]], Conflict), whys(Conflict, Whys).
test(a_system_with_a_solution_has_no_conflict, fail) :- minimal_conflict([(0 =< X)-[a], (X =< 2)-[b]], _).
test(a_system_with_a_solution_has_no_quick_conflict, fail) :-
    S = [(0 =< X)-[a], (X =< 2)-[b]], posted(S, Count), conflict_at(quick, S, Count, _).
test(searching_for_a_conflict_posts_nothing, X == free) :- minimal_conflict([(1 =< X)-[a], (X =< 0)-[b]], _), X = free.
test(the_interval_of_one_unknown_is_that_of_the_solver_bit_for_bit) :-
    forall(( between(1, 50, I), A is I/7, B is A+0.45, C is 9.3+I/11 ),
           ( Rows = [(A+0.762 =< X)-[a], (B =< X+0.1)-[b], (X+0.762+0.45 =< C)-[c], (A =< B)-[d]],
             interval(X, Rows, Low-High),
             findall(L-H, ( posted(Rows), inf(X, L), sup(X, H) ), [L0-H0]),
             Low =:= L0, High =:= H0 )).
test(an_empty_interval_fails, fail) :- interval(X, [(3 =< X)-[a], (X =< 2)-[b]], _).
test(an_interval_under_a_false_constraint_fails, fail) :- interval(X, [(0 =< X)-[a], (X =< 2)-[b], (3 =< 2)-[c]], _).
test(a_known_position_takes_its_place, X =:= 3.0) :- posted([(X = 1.0+2.0)-[a], (X =< 3.0)-[b]]).
test(a_known_position_out_of_place_fails, fail) :- posted([(X = 1.0+2.0)-[a], (X =< 2.9)-[b]]).
test(numbers_are_equal_within_the_solvers_tolerance) :- posted([(0.3 = 0.1+0.2)-[], (0.1+0.2 =< 0.3)-[]]).
test(rows_are_numbers, Rows == [[[[0,1],[1,-2]],-0.5,"=<"],[[[1,1]],-3,"="]]) :-
    rows([(_ =< Y*2+0.5)-[a], (Y = 3)-[b]], Rows).
test(rows_add_up_what_is_said_twice, Rows == [[[[0,1]],2,"=<"]]) :- rows([(X+X+1 =< X-1)-[]], Rows).
test(rows_leave_the_system_as_it_is) :- rows([(X =< Y)-[]], _), var(X), var(Y), X \== Y.

:- end_tests(linear).
