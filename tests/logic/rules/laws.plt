% How two sizes depend on each other.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/language/laws').
:- use_module(library(apply)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(laws, [cleanup(set_cell(0))]).

like(Law, Expected) :-
    Law =.. [Kind|Xs], Expected =.. [Kind|Ys],
    maplist([X,Y]>>(abs(X-Y) < 1.0e-9), Xs, Ys).

test(sizes_that_do_not_depend_on_each_other_are_a_box) :- room_law(cell, Law), like(Law, box(3,4,3,3)).
test(sizes_of_one_degree_of_freedom_are_a_line) :- room_law(square, Law), like(Law, line(2,5,2,5)).
test(sizes_bound_together_are_left_to_the_clause, Law == clause) :- room_law(wide, Law).
test(a_piece_of_fixed_size_is_a_box) :- piece_law(cell, crate, Law), like(Law, box(1.0,1.0,0.5,0.5)).
test(a_piece_on_a_line) :- piece_law(cell, stand, Law), like(Law, line(0.4,0.6,0.5,0.7)).
test(a_piece_that_depends_on_its_wall_is_sloped) :-
    piece_law(cell, shelf, Law), law_at_wall(Law, 3.5-3.0, Here), Law = sloped(_), like(Here, box(1.75,3.5,0.2,0.4)).
test(a_piece_that_depends_on_both_sides_of_the_room_is_left_to_the_clause, Law == clause) :- piece_law(cell, rug, Law).
test(elsewhere_the_wall_is_of_no_account) :-
    piece_law(cell, crate, Law), law_at_wall(Law, 99-99, Here), Here == Law.
test(on_a_grid_each_size_is_rounded_by_itself, [setup(set_cell(0.5)), cleanup(set_cell(0))]) :-
    room_law(square, Law), like(Law, box(2,5,2,5)).
test(on_a_grid_a_wall_is_a_number_of_cells, [setup(set_cell(0.5)), cleanup(set_cell(0))]) :-
    piece_law(cell, shelf, Law), law_at_wall(Law, 7-6, Here), like(Here, box(1.75,3.5,0.2,0.4)).

:- end_tests(laws).
