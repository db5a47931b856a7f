% Why a clause cannot be used: the paths through it, minimal conflicts, constraints that are not linear.
:- use_module('../../../logic/rules/language/faults').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/language/nonlinear').
:- use_module('../../../logic/rules/language/paths').
:- use_module('../../../logic/rules/language/written').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

%   while_loaded(+Text, :Goal): Goal, while the grammar is a file with this text.

:- meta_predicate while_loaded(+, 0).

while_loaded(Text, Goal) :-
    setup_call_cleanup(
        ( tmp_file_stream(File, Out, [extension(pl)]), write(Out, Text), close(Out), written_terms([File], Terms), state_grammar(Terms) ),
        once(Goal),
        ( drop_grammar, delete_file(File) )).

%   paths(+Text, -Paths): Goals-End of all paths through the first clause of the text, with its head's variables.

paths(Text, Paths) :-
    while_loaded(Text,
        ( grammar_terms([Clause|Terms]), Clause = term(_,_,clause(Head0,_,_,_,_,_)), functor(Head0, Name, Arity), functor(Head, Name, Arity),
          findall(Goals-End, ( clause_path([Clause|Terms], Clause, []-Head, _, path(Steps,End)), maplist(step_goal, Steps, Goals) ), Paths) )).

step_goal(step(Goal,_,_), Goal).

:- begin_tests(paths).

test(constraints_are_steps_one_by_one, Paths =@= [[post(X >= 1),post(X =< 2)]-holds]) :- paths("a(X) :- { X >= 1, X =< 2 }.", Paths).
test(a_path_ends_where_it_fails, Paths =@= [[post(X >= 3),post(X =< 2)]-fails]) :- paths("a(X) :- { X >= 3, X =< 2, X = 5 }.", Paths).
test(steps_are_as_written_whatever_is_solved, Paths =@= [[post(X = 3),post(X = 4)]-fails]) :- paths("a(X) :- { X = 3, X = 4 }.", Paths).
test(there_is_a_path_for_each_clause_that_is_called, Ends == [holds,fails]) :-
    paths("a(X) :- { X >= 2 }, b(X).\nb(X) :- { X =< 3 }.\nb(X) :- { X =< 1 }.", Paths), findall(End, member(_-End, Paths), Ends).
test(a_clause_that_is_called_twice_has_variables_for_each_call, Paths =@= [[post(_ >= 1),post(_ >= 1)]-holds]) :-
    paths("a(X, Y) :- b(X), b(Y).\nb(Z) :- { Z >= 1 }.", Paths).
test(a_condition_leads_to_one_branch, Paths =@= [[N is 2,N > 1,post(_ = N)]-holds]) :-
    paths("a(X) :- N is 2, ( N > 1 -> { X = N } ; { X = 0 } ).", Paths).
test(or_to_another, Paths =@= [[post(_ = 0)]-holds]) :- paths("a(X) :- ( 1 > 2 -> { X = 2 } ; { X = 0 } ).", Paths).
test(a_disjunction_to_both, Length == 2) :- paths("a(X) :- ( { X = 1 } ; { X = 2 } ).", Paths), length(Paths, Length).
test(an_error_ends_a_path, true(Ends = [raises(error(instantiation_error,_))])) :-
    paths("a(X) :- X >= 2.", Paths), findall(End, member(_-End, Paths), Ends).
test(a_call_that_no_clause_matches_fails, Paths =@= [[b(_,small)]-fails]) :- paths("a(X) :- b(X, small).\nb(1, large).", Paths).
test(a_recursion_that_ends_is_followed_to_its_end, Ends == [holds,fails]) :-
    paths("a(X) :- b(1, X).\nb(N, X) :- N >= 3, { X = N }.\nb(N, X) :- N < 3, M is N+1, b(M, X).", Paths),
    findall(End, ( member(Goals-End, Paths), length(Goals, Count), Count >= 5 ), Ends).

conflicting(Goals, Conflict) :-
    maplist([G,step(G,_,_)]>>true, Goals, Steps), conflict(Steps, Found), maplist(step_goal, Found, Conflict).

test(a_conflict_is_minimal, Conflict == [post(X >= 5),post(X =< 4)]) :-
    conflicting([post(X >= 3),post(X >= 5),post(Y =< 9),post(X =< 4),post(Y >= X)], Conflict).
test(every_bound_of_it_is_needed, Conflict == [post(X =< Y),post(X + Y >= 8),post(Y =< 3)]) :-
    conflicting([post(X >= 1),post(X =< Y),post(X + Y >= 8),post(Y =< 3)], Conflict).
test(of_equal_ones_the_first_is_left_out, Conflict == [post(X >= 6),post(X =< 4)]) :-
    conflicting([post(X >= 5),post(X >= 6),post(X =< 4)], Conflict).
test(other_goals_are_part_of_it, Conflict == [Y is 2+3,post(X >= Y),post(X =< 4)]) :- conflicting([Y is 2+3,post(X >= Y),post(X =< 4)], Conflict).
test(what_holds_has_none, fail) :- conflicting([post(X >= 3),post(X =< 4)], _).

:- end_tests(paths).

:- begin_tests(nonlinear).

test(linear_constraints) :- forall(member(C, [W =< 3, 2*W + D*3 >= 1, W/2 = D, W = sin(1)*D, W*(2+3) =< -(D), 3*2 =< W]), \+ nonlinear(C, _)).
test(constraints_that_are_not) :- forall(member(C, [W*D =< 3, W/D >= 1, 3/W = D, W^2 =< 4, D =< abs(W), 1 + 2*(W*D) = 3]), nonlinear(C, _)).
test(a_known_factor_makes_a_product_linear, fail) :- D = 3.0, nonlinear(_*D =< 12, _).

:- end_tests(nonlinear).

:- begin_tests(faults).

found(Text, Kind, Head, Line/Column-Said) :- while_loaded(Text, fault_report(Kind, []-Head, wrong(_,Line,Column,Said))).

test(the_longest_path_is_told, Found == 1/1-"room_size(a, W, 1) allows no size: W >= 5 and W =< 4 exclude each other") :-
    found("room_size(a, W, 1) :- { W >= 5 }, ( 1 > 2 ; { W =< 9, W =< 4 } ).", empty, room_size(a,_,_), Found).
test(a_bound_in_another_line_is_named_with_it, Found == 1/1-"room_size(a, W, 1) allows no size: W >= 5 and W =< 4 (line 2) exclude each other") :-
    found("room_size(a, W, 1) :- { W >= 5,\n W =< 4 }.", empty, room_size(a,_,_), Found).
test(without_an_explanation_the_clause_is_named, Found == 1/1-"room_size(a, 1, 1) allows no size") :-
    found("room_size(a, 1, 1).", empty, room_size(a,_,_), Found).
test(a_clause_through_others_that_recurs, Found == 1/1-"room_size(a, W, W) never ends: b/1 calls itself in line 3") :-
    found("room_size(a, W, W) :- b(W).\nb(W) :- c(W).\nc(W) :- b(W).", endless, room_size(a,_,_), Found).
test(what_is_given_is_said_with_the_names_of_the_head, Text == "piece_size(p, Long, 1, _) allows no size: Long >= 5 and Long =< Wall exclude each other") :-
    while_loaded("piece_size(p, Long, 1, _) :- { Long >= 5 }.",
        fault_report(empty, [(Wall =< 3)-said("",[]),(L =< Wall)-said("~w =< ~w",[2,4])]-piece_size(p,L,_,Wall), wrong(_,1,1,Text))).
test(a_size_without_bounds_says_which, Found == 1/1-"room_size(a, W, D): W has no upper bound, D has no lower and no upper bound (E gives none, because it is not in the head)") :-
    found("room_size(a, W, D) :- { W >= 1, D >= E }.", unbounded, room_size(a,_,_), Found).

:- end_tests(faults).
