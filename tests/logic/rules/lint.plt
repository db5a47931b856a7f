% What must not stand in a grammar's files, found before anything of them is run.
:- use_module('../../../logic/rules/language/lint').
:- use_module('../../../logic/rules/language/written').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(lint).

%   found(+Texts, -Found): in files with these texts, as Number/Line/Column-Text.

found(Texts, Found) :-
    maplist(written, Texts, Files),
    written_terms(Files, Terms), term_problems(Terms, Problems),
    findall(N/Line/Column-Text, ( member(problem(File,Line,Column,Text,_), Problems), nth1(N, Files, File) ), Found),
    maplist(delete_file, Files).

written(Text, File) :- tmp_file_stream(File, Out, [extension(pl),encoding(utf8)]), write(Out, Text), nl(Out), close(Out).

says(Text, Part) :- sub_string(Text, _, _, _, Part), !.

test(a_good_file_has_no_problem, Found == []) :-
    found(["passage(0.4).\nroom_size(a, W, 1) :- { W >= 1, W =< 2 }, W = 1.\npiece_size(b, L, 1, _) :- ( L = 1 -> true ; L is 1+1 )."], Found).
test(a_grammar_may_have_predicates_that_it_calls, Found == []) :-
    found(["room_size(a, W, D) :- both(W), once(both(D)).\nboth(W) :- { W >= 1, W =< 2 }."], Found).
test(every_goal_of_the_closed_language_is_let_through, Found == []) :-
    found(["room_size(a, W, 1) :- W = 1, W \\= 2, W == 1, W \\== 2, X is 1+1, X < 3, X > 1, X =< 2, X >= 2, X =:= 2, X =\\= 3, !, true.",
           "room_size(b, W, 1) :- member(X, [2]), memberchk(X, [2]), between(1, 2, W), number(X), nonvar(X), atom(b), var(_).",
           "room_size(c, 1, 1) :- fail.\nroom_size(c, 2, 1) :- false."], Found).
test(they_may_stand_in_another_file, Found == []) :-
    found(["room_size(a, W, D) :- both(W), \\+ \\+ both(D), D = W.", "both(W) :- { W >= 1, W =< 2 }."], Found).
test(a_directive_that_loads_clpr_is_harmless, Found == []) :- found([":- use_module(library(clpr)).\npassage(0.4)."], Found).
test(another_directive_runs_code, true(( Place == 1/2/1, says(Text, "a directive runs code") ))) :-
    found(["passage(0.4).\n:- shell(ls)."], [Place-Text]).
test(a_query_is_a_directive_too, true(says(Text, "a directive runs code"))) :- found(["?- halt."], [_-Text]).
test(a_goal_that_runs_code_is_named, true(says(Text, "shell/1 runs code"))) :- found(["room_size(a, 1, 1) :- shell(ls)."], [_-Text]).
test(it_is_found_under_control_constructs) :-
    forall(member(Body, ["( true ; shell(ls) )", "( true -> shell(ls) ; true )", "\\+ shell(ls)", "once(shell(ls))"]),
           ( format(string(Text), "room_size(a, 1, 1) :- ~w.", [Body]), found([Text], [_-Said]), says(Said, "shell/1 runs code") )).
test(an_unknown_goal_is_named_with_one_that_looks_like_it, Text == "there is no predicate bpth/1: did you mean both/1?") :-
    found(["room_size(a, W, 1) :- bpth(W), both(W).\nboth(1)."], [_-Text]).
test(a_goal_that_is_a_variable, Text == "a goal cannot be a variable: write the goal itself") :- found(["room_size(a, 1, 1) :- X, X = true."], [_-Text]).
test(a_clause_that_nothing_uses, Text == "nothing uses room_gab/1: did you mean room_gap/1?") :- found(["room_gab(0.6)."], [_-Text]).
test(another_arity_of_a_known_name, Text == "nothing uses room_size/2: did you mean room_size/3?") :- found(["room_size(a, 1)."], [_-Text]).
test(a_predicate_that_only_calls_itself_is_not_used, true(says(Text, "nothing uses loop/1"))) :- found(["loop(X) :- loop(X)."], [_-Text]).
test(a_clause_without_a_name, Text == "a clause must begin with a name, as in room_size(hall, W, D)") :- found(["3."], [_-Text]).
test(a_dcg_rule, Text == "a grammar may not contain DCG rules: write the clause with :-") :- found(["a --> b."], [_-Text]).
test(a_syntax_error_is_found_by_line_and_column_and_reading_goes_on, true(( Place == 1/2/16, says(Text, "syntax error"), Next == 3 ))) :-
    found(["passage(0.4).\nroom_size(a, W 1).\nroom_gab(0.6)."], [Place-Text,1/Next/_-_]).
test(nothing_is_run, true(var(Value))) :-
    found([":- nb_setval(lint_ran, yes)."], [_]), ( catch(nb_getval(lint_ran, Value), _, true) -> true ; true ).

:- end_tests(lint).
