% Metres and cells.
:- use_module('../../../logic/rules/linear/grid').
:- use_module(library(plunit)).

:- begin_tests(grid, [cleanup(set_cell(0))]).

test(without_a_grid_lengths_are_metres, [setup(set_cell(0)), true([M,X,R,Kind] == [2.0,0.7,0.2-0.5,real])]) :-
    metres(2, M), rounded_up(0.7, X), rounded_range(0.2-0.5, R), lattice(Kind), \+ on_grid.
test(on_a_grid_lengths_are_cells, [setup(set_cell(0.5)), true([M,Kind] == [1.0,whole])]) :- metres(2, M), lattice(Kind), on_grid.
test(a_fixed_length_is_rounded_up, [setup(set_cell(0.5)), true(X == 2)]) :- rounded_up(0.7, X).
test(what_fits_exactly_is_not_rounded_up, [setup(set_cell(0.1)), true(X == 3)]) :- rounded_up(0.3, X).
test(a_range_is_rounded_inwards, [setup(set_cell(0.5)), true(R == 2-4)]) :- rounded_range(0.7-2.2, R).
test(a_range_without_a_cell_is_the_one_above_it, [setup(set_cell(1.0)), true(R == 1-1)]) :- rounded_range(0.2-0.9, R).
test(a_grid_can_be_left, [setup(set_cell(0.5)), true(Kind == real)]) :- set_cell(0), lattice(Kind), \+ on_grid.

:- end_tests(grid).
