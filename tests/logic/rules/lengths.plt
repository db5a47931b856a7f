% A grammar's lengths, and the extremes of its sizes.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/language/lengths').
:- use_module(library(clpr)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(lengths, [cleanup(set_cell(0))]).

near(A-B, C-D) :- abs(A-C) < 1.0e-9, abs(B-D) < 1.0e-9.

test(named_lengths_are_the_grammars, Lengths == [0.8,0.5,0.4,0.3]) :-
    findall(L, ( member(Name, [door_width,door_clearance,passage,room_gap]), length_of(Name, L) ), Lengths).
test(on_a_grid_they_are_rounded_up, [setup(set_cell(0.5)), cleanup(set_cell(0)), true(L == 2)]) :- length_of(door_width, L).
test(an_unknown_name_has_no_length, fail) :- length_of(height, _).
test(the_extremes_of_a_room_are_its_clauses) :- room_extent(cell, W, D), near(W, 3-4), near(D, 3-3).
test(a_size_that_depends_on_the_other_has_extremes) :- room_extent(square, W, D), near(W, 2-5), near(D, 2-5).
test(a_type_without_a_clause_has_none, fail) :- room_extent(hall, _, _).
test(a_piece_is_as_long_as_the_walls_allow) :- piece_extent(cell, beam, L, D), near(L, 3-4), near(D, 0.5-0.5).
test(in_a_room_of_one_size_a_piece_is_as_long_as_its_walls) :- piece_extent(closet, beam, L, _), near(L, 2-2).
test(at_a_wall_of_known_length_a_piece_is_bounded_by_it) :- piece_range(shelf, 3.0-_, L, D), near(L, 1.5-3), near(D, 0.2-0.4).
test(a_piece_in_no_type_of_room_has_no_extremes, fail) :- piece_extent(hall, crate, _, _).
test(on_a_grid_extremes_are_cells, [setup(set_cell(0.4)), cleanup(set_cell(0)), true(W-D == (8-10)-(8-8))]) :- room_extent(cell, W, D).
test(tables_are_forgotten_with_the_grid, A-B == (8-10)-(3-4)) :-
    set_cell(0.4), room_extent(cell, A, _), set_cell(1.0), room_extent(cell, B, _), set_cell(0).
test(a_number_is_its_own_extremes, R == 2-2) :- extremes(2, R).
test(what_is_unbounded_has_no_extremes, fail) :- {X >= 1}, extremes(X, _).

:- end_tests(lengths).
