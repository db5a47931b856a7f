% Linear systems as data.
:- use_module('../../../logic/rules/linear').
:- use_module(library(clpr)).
:- use_module(library(plunit)).

:- begin_tests(linear).

test(a_system_with_a_solution_is_posted) :- posted([(1 =< X)-[a], (X =< Y)-[b], (Y =< 2)-[c]]), {X >= 1}.
test(one_without_fails, fail) :- posted([(3 =< X)-[a], (X =< Y)-[b], (Y =< 2)-[c]]).
test(a_clash_is_least, Whys == [[a],[b],[c]]) :-
    clash([(0 =< Z)-[d], (3 =< X)-[a], (Z =< X)-[e], (X =< Y)-[b], (Z =< 9)-[f], (Y =< 2)-[c], (Y =< 5)-[g]], Clash),
    findall(Why, member(_-Why, Clash), Found), sort(Found, Whys).
test(a_quick_clash_holds_the_least_one, Whys == [[a],[b],[c],[d]]) :-
    clash_among([(0 =< _)-[d], (3 =< X)-[a], (X =< Y)-[b], (Y =< 2)-[c], (Y =< 5)-[g]], Clash),
    findall(Why, member(_-Why, Clash), Found), sort(Found, Whys).
test(what_has_a_solution_has_no_clash, fail) :- clash([(0 =< X)-[a], (X =< 2)-[b]], _).
test(a_known_position_takes_its_place, X =:= 3.0) :- posted([(X = 1.0+2.0)-[a], (X =< 3.0)-[b]]).
test(a_known_position_out_of_place, fail) :- posted([(X = 1.0+2.0)-[a], (X =< 2.9)-[b]]).
test(rows_are_numbers, Rows == [[[[0,1],[1,-2]],-0.5,"=<"],[[[1,1]],-3,"="]]) :-
    rows([(_ =< Y*2+0.5)-[a], (Y = 3)-[b]], Rows).

:- end_tests(linear).
