% Rooms whose sizes and doors are given.
:- use_module('../../../logic/rules/room/given_rooms').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module(library(http/json)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(given_rooms).

%   crate(+Doors, +Layout, +Frame, -Answer): a cell of 4 by 3 m; crates are 1.0 by 0.5 m, 0.5 m clear of doors.

crate(Doors, Layout, Frame, Answer) :-
    rooms_furnished([room(0,cell,Layout,1,4.0-3.0,Doors,Frame)], minimal, 1000000, Json),
    atom_json_dict(Json, Answer, []).

on(Stretch, [on(crate,1,Stretch,1),busy(Stretch),last(Stretch,1)]).

near(X, Y) :- abs(X-Y) < 1.0e-6.

test(a_piece_on_the_back_half_of_a_wall_stands_behind_the_door) :-
    on(left_back, Layout),                                   % seen from the north, left is east
    crate(doors([1.5-0.8],[0.2-0.8],[],[]), Layout, frame(south,4.0,0.0), Answer), [[Crate]] = Answer.rooms,
    near(Crate.x, 3.5), Crate.y >= 1.5 - 1.0e-6.
test(between_two_doors_it_keeps_clear_of_both) :-
    on(between(back,1), Layout),
    crate(doors([2.5-0.8],[],[0.2-0.5,3.3-0.5],[]), Layout, frame(north,0.0,0.0), Answer), [[Crate]] = Answer.rooms,
    Crate.x >= 1.2 - 1.0e-6, Crate.x =< 1.8 + 1.0e-6, near(Crate.y, -3.0).
test(where_the_doors_stand_too_near_it_is_infeasible_for_a_reason, true(memberchk(["holds","on(crate,1,between(back,1),1)"], Why))) :-
    on(between(back,1), Layout),
    crate(doors([2.5-0.8],[],[0.2-0.5,2.0-0.5],[]), Layout, frame(north,0.0,0.0), Answer), [[0,Why]] = Answer.infeasible.
test(a_door_in_a_corner_asks_for_an_open_corner, true(memberchk(["fails","open(front,left)"], Why))) :-
    on(left, Layout),
    crate(doors([0.1-0.8],[],[],[]), Layout, frame(north,0.0,0.0), Answer), [[0,Why]] = Answer.infeasible.
test(at_an_open_corner_it_stands_behind_the_doors_clearance) :-
    on(left, Layout),
    crate(doors([0.1-0.8],[],[],[]), [open(front,left)|Layout], frame(north,0.0,0.0), Answer), [[Crate]] = Answer.rooms,
    Crate.y + Crate.height =< -0.5 + 1.0e-6.
test(at_an_open_corner_the_free_floor_lies_beside_the_door, [nondet,true(( memberchk(["holds","open(front,left)"], Why),
                                                                   memberchk(["clause","length(passage)"], Why) ))]) :-
    Deep = [open(front,left),on(crate,1,left,1),turned(crate,1,near),busy(left),last(left,1)],
    Beside = [on(crate,2,front_right,1),joined(crate,2),busy(front_right),last(front_right,1)],
    append(Deep, Beside, Both),                              % 1.0 + 0.4 is more than 0.8 + 0.5
    crate(doors([0.0-0.8],[],[],[]), Deep, frame(north,0.0,0.0), One), One.infeasible == [],
    crate(doors([0.0-0.8],[],[],[]), Both, frame(north,0.0,0.0), Two), [[0,Why]] = Two.infeasible.
test(a_frame_turns_and_moves_what_stands_in_it) :-
    on(back, Layout),                                        % seen from the west: 3 m to the east
    crate(doors([1.5-0.8],[],[],[]), Layout, frame(east,10.0,5.0), Answer), [[Crate]] = Answer.rooms,
    near(Crate.x, 12.5), near(Crate.width, 0.5), near(Crate.height, 1.0).
test(past_the_limit_of_inferences_there_is_no_answer, Limit == true) :-
    on(back, Layout),
    rooms_furnished([room(0,cell,Layout,1,4.0-3.0,doors([1.5-0.8],[],[],[]),frame(north,0.0,0.0))], minimal, 10, Json),
    atom_json_dict(Json, Answer, []), Limit = Answer.limit.

:- end_tests(given_rooms).
