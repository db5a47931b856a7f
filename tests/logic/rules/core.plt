% What Python asks for, in JSON.
:- use_module('../../../logic/rules/core').
:- use_module(library(apply)).
:- use_module(library(http/json)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), grammar_problems([File], apart, 0.0, "[]").

:- begin_tests(core).

answer(Goal, Answer) :- call(Goal, Json), atom_json_dict(Json, Answer, []).

empty(R, Side, Seed, room(R,cell,Side,[],Seed)).
blocked(R, Seed, room(R,cell,north,[on(block,1,back,1),busy(back),last(back,1)],Seed)).

test(a_layout_becomes_a_plan) :-
    empty(0, north, 1, A), empty(1, east, 2, B),
    answer(placed(layout([A,B],[],3,minimal), 1000000), Answer),
    length(Answer.rooms, 2), Answer.floor.width > 0, Answer.inferences > 0.
test(the_same_layout_becomes_the_same_plan, A =@= B) :-
    empty(0, north, 1, Room), Layout = layout([Room],[],3,minimal),
    answer(placed(Layout, 1000000), One), answer(placed(Layout, 1000000), Two),
    A = One.put(inferences, 0), B = Two.put(inferences, 0).
test(rooms_that_are_infeasible_are_named_with_their_reasons, true(( R == 1, memberchk(["clause","size(cell,block)"], Reasons),
                                                                   memberchk(["holds","on(block,1,back,1)"], Reasons),
                                                                   memberchk(["fails","turned(block,1,far)"], Reasons) ))) :-
    empty(0, north, 1, A), blocked(1, 2, B),
    answer(placed(layout([A,B],[],3,minimal), 1000000), Answer), [[R,Reasons]] = Answer.infeasible.
test(the_other_rooms_of_that_house_wait_for_the_next_try, true(Later < First)) :-
    Crate = room(0,cell,north,[on(crate,1,left,1),busy(left),last(left,1)],41), blocked(1, 42, B), empty(1, north, 43, C),
    answer(placed(layout([Crate,C],[],3,minimal), 1000000), Fresh), First = Fresh.inferences,
    answer(placed(layout([Crate,B],[],3,minimal), 1000000), _),
    answer(placed(layout([Crate,C],[],3,minimal), 1000000), Next), Later = Next.inferences,
    Fresh.rooms =@= Next.rooms.
test(a_limit_of_inferences_is_kept, Pairs == [limit-true]) :-
    empty(0, north, 1, A), answer(placed(layout([A],[],3,minimal), 100), Answer), dict_pairs(Answer, _, Pairs).
test(a_fixed_room_has_no_plan_and_the_house_a_corner, true(( Rooms == [null], Corner = [_,_] ))) :-
    answer(placed(layout([fixed(0,north,size(3.0,3.0,1.0),at(5.0,2.0))],[],3,minimal), 1000000), Answer), Rooms = Answer.rooms, Corner = Answer.corner.
test(fixed_rooms_that_no_main_room_joins_do_not_fit, Any == true) :-
    Apart = [fixed(0,north,size(3.0,3.0,1.0),at(0.0,0.0)),fixed(1,north,size(3.0,3.0,1.0),at(20.0,0.5))],
    answer(placed(layout(Apart,[],3,minimal), 1000000), Answer),
    Any = Answer.misfit.
test(lengths_and_extremes_are_reported) :-
    answer(grammar_lengths([furniture(cell,[piece(crate,false)])], [passage]), Answer),
    Answer.lengths == [["passage",0.4]],
    [["cell",[3.0,4.0,3.0,3.0],[["crate",[1.0,1.0,0.5,0.5]]]]] = Answer.types.
test(a_conflict_is_found_for_a_room, true(memberchk(["clause","length(passage)"], Reasons))) :-
    answer(room_conflict(cell, [on(block,1,back,1),busy(back),last(back,1)], []), Reasons).
test(a_room_that_can_be_furnished_has_none, Json == "null") :- room_conflict(cell, [], [], Json).
test(the_system_of_a_room_is_rows_of_numbers) :-
    answer(room_system(cell, [on(crate,1,left,1),busy(left),last(left,1)]), System), Rows = System.rows, Rows \== [],
    forall(member([Pairs,Constant,Relation], Rows),
           ( number(Constant), memberchk(Relation, ["=<","="]), forall(member(Pair, Pairs), ( Pair = [N,F], integer(N), number(F) )) )).
test(both_solvers_say_whether_a_system_has_a_solution, Real-Rational == false-false) :-
    answer(room_system(cell, [on(block,1,back,1),busy(back),last(back,1)]), System), Real = System.real, Rational = System.rational.
test(clauses_are_found_by_their_place, Lines == [5]) :- answer(grammar_origins([length(passage)]), Origins), findall(L, member([_,_,L], Origins), Lines).
test(sizes_are_listed, true(memberchk(["piece_size","beam"], Found))) :-
    answer(grammar_sized, Clauses), findall([P,N], member([P,N|_], Clauses), Found).

:- end_tests(core).
