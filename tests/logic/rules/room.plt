% The constraints of a room: where the door and things may stand at the extremes.
:- use_module('../../../logic/rules/room/solution').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/linear').
:- use_module('../../../logic/rules/room/records').
:- use_module('../../../logic/rules/room/room').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(room).

%   ranged(+Layout, +What, -Low, -High): in whole millimetres, where a cell with this layout may have it.

ranged(Layout, What, Low, High) :-
    layout_room(cell, Layout, Room),
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    solution:system(Room, Items, Constraints, System),
    posted(System),
    found(What, Room, X),
    ( number(X) -> L = X, H = X ; inf(X, L), sup(X, H) ),
    Low is round(L*1000), High is round(H*1000).

found(door, Room, Door) :- room_door(Room, Door).
found(start(Name,N), Room, S) :-
    room_stretches(Room, Stretches), memberchk(stretch(Name,_,Blocks), Stretches), nth1(N, Blocks, block(S,_,_,_)).
found(across(N), Room, X)  :- room_islands(Room, Islands), nth1(N, Islands, Island), island_xblock(Island, block(X,_,_,_)).
found(inwards(N), Room, Y) :- room_islands(Room, Islands), nth1(N, Islands, Island), island_yblock(Island, block(Y,_,_,_)).

test(an_empty_room_leaves_the_door_free, [Low,High] == [0,3200]) :- ranged([], door, Low, High).
test(the_core_of_an_empty_room_is_the_room) :-
    layout_room(cell, [], Room), room_width(Room, W), room_depth(Room, D), room_core(Room, core(X1,X2,Y1,Y2)),
    X1 =:= 0, Y1 =:= 0, X2 == W, Y2 == D.
test(a_wall_with_furniture_bounds_the_core, true(( var(X1), X2 == W ))) :-
    layout_room(cell, [on(crate,1,left,1),busy(left),last(left,1)], Room), room_width(Room, W), room_core(Room, core(X1,X2,_,_)).
test(a_piece_on_the_left_keeps_the_door_clear, Low == 1000) :-       % depth 0.5, clearance 0.5
    ranged([on(crate,1,left,1),busy(left),last(left,1)], door, Low, _).
test(a_piece_on_the_right_keeps_the_door_clear, High == 2200) :-     % 4 m - 0.5 - 0.5 - the door's 0.8
    ranged([on(crate,1,right,1),busy(right),last(right,1)], door, _, High).
test(pieces_keep_their_order, Low == 1800) :-                         % 0.4 + 1.0 + 0.4
    ranged([on(crate,1,back,1),on(crate,2,back,2),busy(back),last(back,2)], start(back,2), Low, _).
test(two_stretches_meet_behind_the_owner_of_the_corner, Low == 500) :-      % behind the depth of the left crate
    ranged([on(crate,1,left,1),joined(crate,1),on(crate,2,front_left,1),joined(crate,2),corner(front_left,left,left),
            busy(left),busy(front_left),last(left,1),last(front_left,1)], start(front_left,1), Low, _).
test(furniture_and_islands_keep_a_passage_between_them, Low == 900) :-      % 0.5 deep, 0.4
    ranged([on(crate,1,left,1),busy(left),last(left,1),on(crate,2,middle,1)], across(1), Low, _).
test(an_island_has_a_passage_round_it, [Low,High] == [400,2600]) :-    % up to 4 m wide, 1 m long
    ranged([on(crate,1,middle,1)], across(1), Low, High).
test(an_island_keeps_clear_of_the_front_wall_with_the_door, Low == 500) :- ranged([on(crate,1,middle,1)], inwards(1), Low, _).
test(an_island_with_a_seat_needs_room_for_both, [Low,High] == [400,2200]) :-
    ranged([on(crate,1,middle,1),with(crate,1,stool,left)], across(1), Low, High).
test(islands_stand_in_a_row, Low == 1800) :-                          % 0.4 + 1.0 + 0.4
    ranged([on(crate,1,middle,1),on(crate,2,middle,2),row(across)], across(2), Low, _).
test(islands_stand_one_behind_the_other, Low == 1400) :-                         % 0.5 + 0.5 + 0.4
    ranged([on(crate,1,middle,1),on(crate,2,middle,2),row(inwards)], inwards(2), Low, _).

test(items_are_all_that_has_a_size, Types == [beam,crate,stool]) :-
    layout_room(cell, [on(crate,1,middle,1),with(crate,1,stool,left),on(beam,1,back,1),joined(beam,1),end(back),busy(back),last(back,1)],
                Room),
    room_items(Room, Items), findall(T, member(_-item(T,_,_,_), Items), Found), msort(Found, Types).
test(where_sizes_are_known_the_core_reaches_the_furniture, [X1,X2] == [0.5,4.0]) :-
    layout_room(cell, [on(crate,1,left,1),busy(left),last(left,1)], Room),
    room_width(Room, 4.0), room_depth(Room, 3.0), room_items(Room, [_-item(_,1.0,0.5,_)]),
    widest_core(Room), room_core(Room, core(X1,X2,_,_)).
test(chains_are_those_of_the_walls_and_of_the_islands, Lengths == [0,0,0,0,0,2,1,1]) :-
    layout_room(cell, [on(crate,1,middle,1),on(crate,2,middle,2),row(across)], Room),
    room_chains(Room, Chains), maplist(length, Chains, Lengths).

:- end_tests(room).
