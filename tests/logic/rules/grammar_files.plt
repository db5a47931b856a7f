% Loading a grammar's files: every mistake is a problem by its place.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/language/lengths').
:- use_module('../../../logic/rules/language/written').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(grammar_files).

%   loaded(+Texts, -Problems): files with these texts, each problem as Number/Line/Column-Text.

loaded(Texts, Found) :-
    maplist(written, Texts, Files),
    setup_call_cleanup(load_grammar(Files, Problems), true, ( drop_grammar, maplist(delete_file, Files) )),
    findall(N/Line/Column-Text, ( member(problem(File,Line,Column,Text,_), Problems), nth1(N, Files, File) ), Found).

written(Text, File) :- tmp_file_stream(File, Out, [extension(pl),encoding(utf8)]), write(Out, Text), nl(Out), close(Out).

test(a_good_file_has_no_problem, Found == []) :- loaded(["passage(0.4)."], Found).
test(its_clauses_are_the_grammars, P == 0.4) :-
    written("passage(0.4).", File), load_grammar([File], []), length_of(passage, P), drop_grammar, delete_file(File).
test(a_dropped_grammar_leaves_no_clause, fail) :-
    written("passage(0.4).", File), load_grammar([File], []), drop_grammar, delete_file(File), length_of(passage, _).
test(clauses_may_stand_in_any_order_and_in_several_files, Found == []) :-
    loaded(["room_size(a,1,1).\npiece_size(b,1,1,_).\nroom_size(c,1,1).", "room_size(d,1,1).\npassage(0.4)."], Found).
test(constraints_of_clpr_are_known_without_a_directive, Found == []) :- loaded(["room_size(a,W,1) :- { W >= 1, W =< 2 }."], Found).
test(a_syntax_error_is_named_by_line_and_column, Places == [1/2/16]) :-
    loaded(["passage(0.4).\nroom_size(a, W 1) :- { W >= 1 }.\n"], Found), findall(Place, member(Place-_, Found), Places).
test(its_text_says_which, Texts == ["syntax error: operator_expected"]) :-
    loaded(["room_size(a W, 1)."], Found), findall(Text, member(_-Text, Found), Texts).
test(a_clause_that_does_not_end_is_a_problem, true(sub_string(Text, 0, _, _, "syntax error: end_of_file"))) :-
    loaded(["passage(0.4).\nroom_size(a, 1, 1)"], [_-Text]).
test(a_problem_of_the_second_file_is_named_by_it, Places == [2/1]) :-
    loaded(["passage(0.4).", "room_size(a W, 1)."], Found), findall(N/Line, member(N/Line/_-_, Found), Places).
test(a_variable_that_stands_alone_is_a_problem, true(sub_string(Text, 0, _, _, "W occurs nowhere else in its clause"))) :-
    loaded(["room_size(a, W, D) :- { D >= 1, D =< 2 }."], [1/1/14-Text]).
test(problems_of_one_load_are_not_of_the_next, Found == []) :- loaded(["room_size(a W, 1)."], _), loaded(["passage(0.4)."], Found).
test(of_a_dropped_grammar_nothing_is_left, P == []) :-
    written("passage(0.4).", File), load_grammar([File], []), drop_grammar, findall(X, stated_length(passage, X), P), delete_file(File).
test(its_terms_are_those_that_are_loaded, Heads == [passage(0.4),room_gap(1)]) :-
    maplist(written, ["passage(0.4).", "room_gap(1)."], Files), load_grammar(Files, []), grammar_terms(Terms), drop_grammar, maplist(delete_file, Files),
    findall(Head, member(term(_,_,clause(Head,_,_,_,_,_)), Terms), Heads).
test(letters_beyond_ascii_are_read, Found == []) :- loaded(["passage(0.4).  % größer als der Körper"], Found).

%   stated(+Text): a grammar with this text, whatever lint says of it.

stated(Text) :- written(Text, File), written_terms([File], Terms), delete_file(File), state_grammar(Terms).

test(what_lint_would_miss_the_sandbox_refuses, [forall(member(Goal, ["shell(ls)","open(a,write,_)","assertz(core:a)","call(X)","lists:subseq(X,X,X)"])), error(_)]) :-
    format(string(Text), "passage(X) :- X = 1, ~w.", [Goal]), stated(Text).
test(and_drops_the_grammar, P == []) :- catch(stated("passage(0.4).\nroom_gap(X) :- shell(X)."), _, true), findall(X, stated_length(passage, X), P).

:- end_tests(grammar_files).
