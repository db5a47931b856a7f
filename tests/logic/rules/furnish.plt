% A room's furniture, solved: what fits, what does not, and why.
:- use_module('../../../logic/rules/room/furnish').
:- use_module('../../../logic/rules/room/solution').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/linear/linear').
:- use_module('../../../logic/rules/room/records').
:- use_module('../../../logic/rules/room/room').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- use_module(library(prolog_wrap)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(furnish, [cleanup(set_cell(0))]).

furnished_by(Seed, Layout, Room) :- call(furnished(cell, Layout, quick, Room), Seed, _), is_room(Room).

fits(Layout) :- furnished_by(1, Layout, _).

reasons(Layout, Proof, Reasons) :- call(furnished(cell, Layout, Proof, infeasible(Reasons)), 1, _).

crate([on(crate,1,left,1),busy(left),last(left,1)]).
blocked([on(block,1,back,1),busy(back),last(back,1),on(crate,1,left,1),busy(left),last(left,1)]).

test(every_length_of_a_furnished_room_is_known) :- crate(L), furnished_by(3, L, Room), ground(Room).
test(it_satisfies_the_constraints_of_its_layout) :-
    crate(Layout),
    forall(( between(1, 30, Seed), furnished_by(Seed, Layout, Room) ),
           ( phrase(room_constraints(Room), Constraints), posted(Constraints) )).
test(seeds_give_different_rooms, true(Count > 25)) :-
    crate(Layout), findall(W, ( between(1, 30, Seed), furnished_by(Seed, Layout, Room), room_width(Room, W) ), Ws),
    sort(Ws, Different), length(Different, Count).
test(a_seed_gives_the_same_room, A == B) :- crate(L), furnished_by(7, L, A), furnished_by(7, L, B).
test(a_wall_may_be_filled_from_end_to_end) :-
    fits([on(beam,1,back,1),joined(beam,1),end(back),busy(back),last(back,1)]).
test(a_piece_as_long_as_its_wall_leaves_no_gap, fail) :-
    fits([on(beam,1,back,1),joined(beam,1),busy(back),last(back,1)]).
test(a_piece_that_is_too_deep_leaves_no_passage, fail) :-              % 2.7 + 0.4 > 3.0
    fits([on(block,1,back,1),busy(back),last(back,1)]).
test(a_room_that_no_try_meets_is_solved_with_every_size_unknown) :-      % three crates of 1 m fill a wall of 3 m, not of 3.1
    L = [on(crate,1,back,1),joined(crate,1),on(crate,2,back,2),joined(crate,2),on(crate,3,back,3),joined(crate,3),
         end(back),busy(back),last(back,3)],
    call(furnished(square, L, quick, Room), 1, _),       % as deep as wide: its two sizes are sampled as one
    room_width(Room, W), abs(W - 3) < 1.0e-6.
test(on_a_grid_every_length_is_whole, [setup(set_cell(0.5)), cleanup(set_cell(0))]) :-
    crate(L),
    forall(( between(1, 10, Seed), furnished_by(Seed, L, Room) ),
           ( room_width(Room, W), room_door(Room, Door), W =:= round(W), Door =:= round(Door) )).

% - what CLP(R) refutes falsely -----------------------------------------------

%   doubted(:Goal): Goal, where no try succeeds and CLP(R) refutes every room, as it may refute some that has a solution.

doubted(Goal) :-
    setup_call_cleanup(
        ( wrap_predicate(linear:posted(_,Count), doubted, _, Count = 0), wrap_predicate(furnish:tries_sample(_,_,_,_), doubted, _, fail) ),
        Goal,
        ( unwrap_predicate(linear:posted/2, doubted), unwrap_predicate(furnish:tries_sample/4, doubted) )).

test(a_room_that_is_refuted_falsely_is_furnished_by_its_constraints) :-
    crate(Layout),
    doubted(forall(between(1, 5, Seed), ( furnished_by(Seed, Layout, Room), phrase(room_constraints(Room), Constraints), posted(Constraints), ground(Room) ))).
test(such_a_room_of_given_size_keeps_it, W-D == 3.5-2.5) :-
    crate(Layout), doubted(call(furnished(cell, Layout, shape(3.5,2.5,doors([door(1.2,0.8,[])],[],[],[])), quick, Room), 1, _)),
    room_width(Room, W), room_depth(Room, D).
test(such_a_room_on_a_grid_is_whole, [setup(set_cell(0.5)), cleanup(set_cell(0))]) :-
    crate(L), doubted(furnished_by(1, L, Room)), room_width(Room, W), integer(W).
test(a_room_that_has_no_solution_has_a_minimal_conflict, Pieces == [block]) :-
    blocked(L), doubted(reasons(L, minimal, Reasons)), findall(P, member(size(cell,P), Reasons), Pieces).

% - infeasible rooms ----------------------------------------------------------

test(a_minimal_conflict_names_its_reasons_and_nothing_else,
     Reasons == [length(passage),not(turned(block,1,far)),not(turned(block,1,near)),size(cell),size(cell,block),on(block,1,back,1)]) :-
    blocked(Layout), reasons(Layout, minimal, Reasons).
test(a_quick_conflict_names_these_too) :-
    blocked(Layout), reasons(Layout, minimal, Minimal), reasons(Layout, quick, Quick),
    subtract(Minimal, Quick, []).
test(without_a_clause_that_is_to_blame_there_is_no_conflict, fail) :-
    blocked(Layout), conflict_without(cell, Layout, [size(cell,block)], _).
test(without_another_clause_the_conflict_remains) :-
    blocked(Layout), conflict_without(cell, Layout, [size(cell,crate)], Reasons), memberchk(size(cell,block), Reasons).
test(a_room_without_its_clause_may_have_any_size) :-
    conflict_without(cell, [on(block,1,back,1),busy(back),last(back,1)], [size(cell)], _) -> fail ; true.
test(the_whole_system_has_the_sizes_and_the_items, Count-Kinds == 1-[size(cell),size(cell,crate)]) :-
    crate(L), whole_system(cell, L, Room, System), room_items(Room, Items), length(Items, Count),
    findall(size(A), member(_-[size(A)], System), As), findall(size(A,B), member(_-[size(A,B)], System), Bs),
    append(As, Bs, All), sort(All, Kinds).

:- end_tests(furnish).
