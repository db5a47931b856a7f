% Whether a grammar's clauses can be used: what is reported of good ones and of bad ones.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/language/reports').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- dynamic tiny/1.
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), assertz(tiny(File)), load_grammar([File], []).

:- begin_tests(reports, [cleanup(set_cell(0))]).

%   stated(+Text, :Goal): Goal, while the grammar states this text too.

:- meta_predicate stated(+, 0).

stated(Text, Goal) :-
    tiny(Tiny),
    setup_call_cleanup(
        ( tmp_file_stream(File, Out, [extension(pl)]), write(Out, Text), nl(Out), close(Out), load_grammar([Tiny,File], []) ),
        Goal,
        ( load_grammar([Tiny], []), delete_file(File) )).

says(Text, Part) :- sub_string(Text, _, _, _, Part), !.

near(Report, Numbers) :- maplist([X,Y]>>(abs(X-Y) < 1.0e-9), Report, Numbers).

test(a_length_is_reported_in_metres, Report == 0.4) :- length_report(passage, Report).
test(on_a_grid_it_is_rounded_up_to_cells, [setup(set_cell(0.25)), cleanup(set_cell(0)), true(Report == 0.5)]) :- length_report(passage, Report).
test(a_length_that_is_not_stated_is_null, Report == null) :- length_report(height, Report).
test(a_length_stated_twice, Line/Column-Text == 1/1-"passage(0.5) is a second clause: the first is in line 5 of rules/grammar.pl. State one") :-
    stated("passage(0.5).", length_report(passage, wrong(_,Line,Column,Text))).
test(extremes_of_a_room) :- room_report(cell, Report), near(Report, [3,4,3,3]).
test(a_room_without_a_clause_is_null, Report == null) :- room_report(hall, Report).
test(extremes_of_a_piece) :- piece_report(cell, shelf, false, Report), near(Report, [1.5,4,0.2,0.4]).
test(a_piece_without_a_clause_is_null, Report == null) :- piece_report(cell, lamp, false, Report).
test(a_second_clause_is_named_with_the_first, Line/Column-Text == 1/28-"room_size(hall, 4.0, 4.0) is a second clause: the first is in line 1. State one") :-
    stated("room_size(hall, 3.0, 3.0). room_size(hall, 4.0, 4.0).", room_report(hall, wrong(_,Line,Column,Text))).
test(a_clause_for_all_types_beside_others, true(says(Text, "room_size(_, 3.0, 3.0) applies to every type"))) :-
    stated("room_size(_, 3.0, 3.0).", room_report(cell, wrong(_,1,1,Text))).
test(a_size_without_a_bound, Text == "room_size(hall, W, 3.0): W has no upper bound") :-
    stated("room_size(hall, W, 3.0) :- { W >= 3 }.", room_report(hall, wrong(_,1,1,Text))).
test(a_size_of_nothing, Text == "room_size(hall, W, 3.0): W can be 0.0 m, but a size must be more than 0") :-
    stated("room_size(hall, W, 3.0) :- { W >= 0, W =< 3 }.", room_report(hall, wrong(_,1,1,Text))).
test(a_nonlinear_constraint_is_named_at_its_place, true(( Column == 60, says(Text, "D = W*W is nonlinear") ))) :-
    stated("room_size(hall, W, D) :- { W >= 1, W =< 3, D >= 1, D =< 9, D = W*W }.", room_report(hall, wrong(_,1,Column,Text))).
test(a_clause_that_recurs_without_end, Text == "room_size(hall, W, D) never ends: room_size/3 calls itself in line 1") :-
    stated("room_size(hall, W, D) :- room_size(hall, W, D).", room_report(hall, wrong(_,1,1,Text))).
test(a_goal_that_raises_an_error_is_named_at_its_place, true(( Column == 28, says(Text, "write constraints in braces, { W >= 3 }") ))) :-
    stated("room_size(hall, W, 3.0) :- W >= 3, { W =< 4 }.", room_report(hall, wrong(_,1,Column,Text))).
test(a_size_that_is_empty_is_not_an_absent_one, true(says(Text, "W >= 5 and W =< 4 exclude each other"))) :-
    stated("room_size(hall, W, 3.0) :- { W >= 5, W =< 4 }.", room_report(hall, wrong(_,1,1,Text))).
test(a_piece_longer_than_its_wall, true(says(Text, "L >= 1.1*V and L =< V exclude each other"))) :-
    stated("piece_size(pole, L, 0.2, V) :- { L >= 1.1*V, L =< 2*V }.", piece_report(cell, pole, false, wrong(_,1,1,Text))).
test(a_piece_longer_than_the_walls_of_one_type_names_it, true(says(Text, "4.5, L =< Wall and Wall =< 4 (in cell, line 8 of rules/grammar.pl) exclude each other"))) :-
    stated("piece_size(pole, L, 0.2, _) :- { L >= 4.5, L =< 4.8 }.", piece_report(cell, pole, false, wrong(_,1,1,Text))).
test(a_piece_that_is_larger_than_the_room_allows_by_both_its_sides, true(says(Text, "L >= 1.1*V and L =< its wall exclude each other"))) :-
    stated("piece_size(pole, L, D, V-A) :- { L >= 1.1*V, L =< 2*V, D = A/2 }.", piece_report(cell, pole, false, wrong(_,1,1,Text))).
test(it_fits_where_it_may_be_turned, true(is_list(Report))) :-
    stated("piece_size(pole, L, 0.2, V) :- { L >= 1.1*V, L =< 2*V }.", piece_report(cell, pole, true, Report)).
test(it_fits_in_a_larger_type, true(is_list(Report))) :-
    stated("piece_size(pole, L, 0.2, _) :- { L >= 4.5, L =< 4.8 }.", piece_report(square, pole, false, Report)).

:- end_tests(reports).
