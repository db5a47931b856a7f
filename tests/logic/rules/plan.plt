% From the rooms' frames to the house's plan.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module('../../../logic/rules/room/plan').
:- use_module('../../../logic/rules/room/records').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(plan, [cleanup(set_cell(0))]).

%   room(+Stretches, +Islands, -Room): 4 m wide and 3 m deep, its door at 1 m.

room(Stretches, Islands, Room) :-
    make_room([type(cell),width(4.0),depth(3.0),door(1.0),core(core(0,4,0,3)),stretches(Stretches),row(across),islands(Islands)], Room).

link(Gap, Role, Type, Front, Link) :- link(Gap, Role, Type, Front, none, Link).

link(Gap, Role, Type, Front, Seat, Link) :-
    make_link([gap(Gap-[]),role(Role),item(item(Type,1.0,0.5,_)),along(1.0),out(0.5),front(Front),seat(Seat),why([])], Link).

island(Front, Seats, Island) :-
    make_island([item(item(crate,1.0,0.5,_)),across(1.0),inwards(0.5),xblock(block(1.5,1.0,[],[])),yblock(block(1.0,0.5,[],[])),
                 seats(Seats),front(Front)], Island).

planned(Side, Room, Plan) :- house_plan(main(6.0,5.0), [1.0], [Side-Room], House), [Plan] = House.rooms.

box(Plan, [Plan.x,Plan.y,Plan.width,Plan.height]).

piece(Name, Front, Plan) :-
    link(apart, piece(1), crate, Front, Link),
    room([stretch(Name,[Link],[block(0.5,1.0,[],[])])], [], Room),
    planned(north, Room, RoomPlan), [Plan] = RoomPlan.children.

test(the_main_room_lies_at_the_origin, Box == [0.0,0.0,6.0,5.0]) :- house_plan(main(6.0,5.0), [], [], Plan), box(Plan.floor, Box).
test(a_room_lies_outside_along_its_side, Boxes == [[1.0,-3.0,4.0,3.0],[6.0,1.0,3.0,4.0],[1.0,5.0,4.0,3.0],[-3.0,0.0,3.0,4.0]]) :-
    room([], [], Room),
    findall(Box, ( member(Side, [north,east,south,west]), planned(Side, Room, Plan), box(Plan, Box) ), Boxes).
test(its_door_lies_on_the_main_rooms_wall, Boxes == [[2.0,0.0,0.8,0.0],[6.0,2.0,0.0,0.8],[3.2,5.0,0.8,0.0],[0.0,2.2,0.0,0.8]]) :-
    room([], [], Room),
    findall(Box, ( member(Side, [north,east,south,west]), planned(Side, Room, Plan), box(Plan.door, B), maplist(tenths, B, Box) ), Boxes).
test(a_fixed_room_has_no_plan, Plans == [null]) :-
    house_plan(main(6.0,5.0), [1.0], [north-fixed(size(3.0,3.0,1.0),at(1.0,0.0))], House), Plans = House.rooms.
test(pieces_stand_at_their_walls, Boxes == [[1.5,-0.5,1.0,0.5],[1.0,-1.5,0.5,1.0],[1.5,-3.0,1.0,0.5],[4.5,-1.5,0.5,1.0],[3.5,-0.5,1.0,0.5]]) :-
    findall(Box, ( member(Name, [front_left,left,back,right,front_right]), piece(Name, out, Plan), box(Plan, Box) ), Boxes).
test(their_fronts_face_the_room, Fronts == ["N","E","S","W","N"]) :-      % a room on the north side opens to the south
    findall(O, ( member(Name, [front_left,left,back,right,front_right]), piece(Name, out, Plan), O = Plan.orientation ), Fronts).
test(a_turned_piece_faces_an_end_of_its_wall, Fronts == ["N","S"]) :-
    findall(O, ( member(Front, [far,near]), piece(left, Front, Plan), O = Plan.orientation ), Fronts).
test(on_the_south_side_all_is_turned_round, O == "S") :-
    link(apart, piece(1), crate, out, Link), room([stretch(front_left,[Link],[block(0.5,1.0,[],[])])], [], Room),
    planned(south, Room, Plan), [Piece] = Plan.children, O = Piece.orientation.
test(companions_are_children_of_their_piece, Types == [crate-[stool]]) :-
    link(apart, piece(1), crate, out, One), link(joined, with(crate-1), stool, out, Two),
    room([stretch(back,[One,Two],[block(0.5,2.0,[],[])])], [], Room), planned(north, Room, Plan),
    findall(T-Ts, ( member(P, Plan.children), T = P.type, findall(C, ( member(Child, P.children), C = Child.type ), Ts) ), Types).
test(joined_links_stand_end_to_end, Xs == [1.5,2.5,4.0]) :-
    link(apart, piece(1), crate, out, One), link(joined, piece(2), crate, out, Two), link(apart, piece(3), crate, out, Three),
    room([stretch(back,[One,Two,Three],[block(0.5,2.0,[],[]),block(3.0,1.0,[],[])])], [], Room), planned(north, Room, Plan),
    findall(X, ( member(P, Plan.children), X = P.x ), Xs).
test(an_island_stands_in_the_middle, Box-O == [2.5,-1.5,1.0,0.5]-"") :-
    island(none, [], Island), room([], [Island], Room), planned(north, Room, Plan), [Piece] = Plan.children,
    box(Piece, Box), O = Piece.orientation.
test(a_seat_stands_at_the_middle_of_its_side_and_faces_it, Boxes == [[2.5,-1.45,0.4,0.4]-"E"]) :-      % the block begins with the seat
    island(none, [seat(left,item(stool,0.4,0.4,_))], Island), room([], [Island], Room), planned(north, Room, Plan),
    [Piece] = Plan.children,
    findall(Rounded-O, ( member(C, Piece.children), box(C, Box), maplist(hundredths, Box, Rounded), O = C.orientation ), Boxes).
test(so_does_one_in_front_of_a_piece_at_a_wall, Boxes == [[1.8,-0.9,0.4,0.4]-"S",[1.5,-1.2,0.4,0.4]-"W",[1.8,-2.5,0.4,0.4]-"N"]) :-
    findall(Rounded-O,
            ( member(Name, [front_left,left,back]),
              link(apart, piece(1), crate, out, with(crate,1,stool,front)-item(stool,0.4,0.4,_), Link),
              room([stretch(Name,[Link],[block(0.5,1.0,[],[])])], [], Room), planned(north, Room, Plan), [Piece] = Plan.children,
              [Seat] = Piece.children, box(Seat, Box), maplist(hundredths, Box, Rounded), O = Seat.orientation ),
            Boxes).
test(one_that_is_apart_stands_a_passage_away, Boxes == [[1.8,-1.3,0.4,0.4]-"S",[2.5,-1.45,0.4,0.4]-"E"]) :-
    link(apart, piece(1), crate, out, with(crate,1,stool,away(front))-item(stool,0.4,0.4,_), Link),
    island(none, [seat(away(left),item(stool,0.4,0.4,_))], Island),
    findall(Rounded-O,
            ( member(Room0-Islands, [[stretch(front_left,[Link],[block(0.5,1.0,[],[])])]-[], []-[Island]]),
              room(Room0, Islands, Room), planned(north, Room, Plan), [Piece] = Plan.children, [Seat] = Piece.children,
              box(Seat, Box), maplist(hundredths, Box, Rounded), O = Seat.orientation ),
            Boxes).
test(on_a_grid_the_plan_is_in_metres_all_the_same, [setup(set_cell(0.5)), cleanup(set_cell(0)), true(Box == [0.0,0.0,6.0,5.0])]) :-
    house_plan(main(12,10), [], [], Plan), box(Plan.floor, Box).

tenths(X, Y)     :- Y is round(X*10)/10.0.
hundredths(X, Y) :- Y is round(X*100)/100.0.

:- end_tests(plan).
