% The constraints of sizes as data: they mean what the clauses say.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/linear/linear').
:- use_module('../../../logic/rules/language/sizes').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(sizes, [cleanup(set_cell(0))]).

near(X, Y) :- abs(X - Y) < 1.0e-9.

range(X, Low, High) :- inf(X, L), sup(X, H), near(L, Low), near(H, High).

test(a_room_has_the_range_of_its_clause) :-
    room_size_system(cell, W, D, System), posted(System), range(W, 3, 4), D =:= 3.0.
test(sizes_that_depend_on_each_other_do_so_in_the_system) :-
    room_size_system(square, W, D, System), posted(System), {W = 3}, near(D, 3).
test(two_sizes_that_are_one_unknown_are_equal_wherever_the_room_lies) :-
    size_system([X2-X1,Y2-Y1], [A,A], why, System), X1 = 1.0, Y1 = 2.0, posted(System), {X2 = 3.5}, near(Y2, 4.5).
test(every_constraint_names_its_clause) :-
    room_size_system(wide, _, _, System), System \== [],
    forall(member(_-Why, System), Why == [size(wide)]).
test(a_piece_depends_on_its_wall) :-
    item_size_system(cell, item(shelf,L,_,Wall-_), System), posted(System), {Wall = 3}, range(L, 1.5, 3).
test(a_piece_depends_on_both_sides_of_the_room) :-
    item_size_system(cell, item(rug,L,D,Wall-Across), System), posted(System), {Wall = 4, Across = 3}, range(L, 1, 2), range(D, 1.5, 2).
test(a_fixed_size_is_an_equation_with_its_reason, System == [(L = 1.0)-[size(cell,crate)],(D = 0.5)-[size(cell,crate)]]) :-
    item_size_system(cell, item(crate,L,D,_), System).
test(a_piece_names_its_room_and_itself) :-
    item_size_system(cell, item(stand,_,_,_), System),
    forall(member(_-Why, System), Why == [size(cell,stand)]).
test(two_pieces_of_a_type_have_sizes_apart_from_each_other) :-
    item_size_system(cell, item(stand,A,_,_), One), item_size_system(cell, item(stand,B,_,_), Two),
    posted(One), posted(Two), {A = 0.4, B = 0.6}.
test(on_a_grid_sizes_are_bounds_in_cells, [setup(set_cell(0.5)), cleanup(set_cell(0)), true(System == Expected)]) :-
    Expected = [(6 =< W)-[size(cell)], (W =< 8)-[size(cell)], (6 =< D)-[size(cell)], (D =< 6)-[size(cell)]],
    room_size_system(cell, W, D, System).
test(on_a_grid_a_known_wall_bounds_a_piece, [setup(set_cell(0.5)), cleanup(set_cell(0)), true([A,B] == [4,7])]) :-
    item_size_system(cell, item(shelf,L,_,7-6), System),
    System = [(A =< L1)-_,(L2 =< B)-_|_], L1 == L, L2 == L.
test(on_a_grid_an_unknown_wall_is_any_of_the_rooms, [setup(set_cell(0.5)), cleanup(set_cell(0)), true([A,B] == [3,8])]) :-
    item_size_system(cell, item(shelf,L,_,_), System),
    System = [(A =< L1)-_,(L2 =< B)-_|_], L1 == L, L2 == L.

:- end_tests(sizes).
