% Whether a grammar's clauses can be used: what is reported of good ones and of bad ones.
:- use_module('../../../logic/rules/grammar_files').
:- use_module('../../../logic/rules/grid').
:- use_module('../../../logic/rules/reports').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(reports, [cleanup(set_cell(0))]).

%   stated(+Text, :Goal): Goal, while the grammar states this text too.

:- meta_predicate stated(+, 0).

stated(Text, Goal) :-
    setup_call_cleanup(
        ( tmp_file_stream(File, Out, [extension(pl)]), write(Out, Text), nl(Out), close(Out), load_grammar([File], []) ),
        Goal,
        ( unload_file(File), delete_file(File) )).

near(Report, Numbers) :- maplist([X,Y]>>(abs(X-Y) < 1.0e-9), Report, Numbers).

test(a_length_is_reported_in_metres, Report == 0.4) :- length_report(passage, Report).
test(on_a_grid_it_is_rounded_up_to_cells, [setup(set_cell(0.25)), cleanup(set_cell(0)), true(Report == 0.5)]) :- length_report(passage, Report).
test(a_length_that_is_not_stated_is_null, Report == null) :- length_report(height, Report).
test(a_length_stated_twice, Report == "is stated more than once") :- stated("passage(0.5).", length_report(passage, Report)).
test(extremes_of_a_room) :- room_report(cell, Report), near(Report, [3,4,3,3]).
test(a_room_without_a_clause_is_null, Report == null) :- room_report(hall, Report).
test(extremes_of_a_piece) :- piece_report(cell, shelf, Report), near(Report, [1.5,4,0.2,0.4]).
test(a_piece_without_a_clause_is_null, Report == null) :- piece_report(cell, lamp, Report).
test(a_piece_in_a_room_without_a_clause_reports_nothing_wrong, Report == [0,0,0,0]) :- piece_report(hall, crate, Report).
test(two_solutions, Report == "has more than one solution: state one") :-
    stated("room_size(hall, 3.0, 3.0). room_size(hall, 4.0, 4.0).", room_report(hall, Report)).
test(a_size_without_a_bound, Report == "is not bounded on both sides") :-
    stated("room_size(hall, W, 3.0) :- { W >= 3 }.", room_report(hall, Report)).
test(a_size_of_nothing, Report == "allows a size that is not positive") :-
    stated("room_size(hall, W, 3.0) :- { W >= 0, W =< 3 }.", room_report(hall, Report)).
test(a_nonlinear_constraint_is_named, true(sub_string(Report, 0, _, _, "has the nonlinear constraint"))) :-
    stated("room_size(hall, W, D) :- { W >= 1, W =< 3, D >= 1, D =< 9, D = W*W }.", room_report(hall, Report)).
test(a_clause_that_recurs_without_end, Report == "recurs without end") :-
    stated("room_size(hall, W, D) :- room_size(hall, W, D).", room_report(hall, Report)).

:- end_tests(reports).
