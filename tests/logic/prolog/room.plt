% The constraints of a room: what fits, what does not, and where things may stand at the extremes.
:- use_module('../../../logic/rules/grammar').
:- use_module('../../../logic/rules/furnish').
:- use_module('../../../logic/rules/linear').
:- use_module('../../../logic/rules/room').
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(room).

%   ranged(+Layout, +What, -Low, -High): in whole millimetres, where a cell with this layout may have it.

ranged(Layout, What, Low, High) :-
    room(cell, Layout, Room),
    Room = room(_,W,D,_,_,_,_),
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    furnish:system(cell, W, D, Items, Constraints, System),
    posted(System),
    found(What, Room, X),
    ( number(X) -> L = X, H = X ; inf(X, L), sup(X, H) ),
    Low is round(L*1000), High is round(H*1000).

found(door, room(_,_,_,Door,_,_,_), Door).
found(start(Name,N), room(_,_,_,_,_,Stretches,_), S) :-
    memberchk(stretch(Name,_,Blocks), Stretches), nth1(N, Blocks, block(S,_,_,_)).
found(across(N), room(_,_,_,_,_,_,islands(_,Islands)), X) :- nth1(N, Islands, island(_,_,_,block(X,_,_,_),_,_,_)).
found(inwards(N), room(_,_,_,_,_,_,islands(_,Islands)), Y) :- nth1(N, Islands, island(_,_,_,_,block(Y,_,_,_),_,_)).

fits(Layout) :- call(furnished(cell, Layout, quick, Answer), 1, _), Answer = room(_,_,_,_,_,_,_).

test(an_empty_room_leaves_the_door_free, [Low,High] == [0,3200]) :- ranged([], door, Low, High).
test(a_piece_on_the_left_keeps_the_door_clear, Low == 1000) :-       % depth 0.5, clearance 0.5
    ranged([on(crate,1,left,1),busy(left),last(left,1)], door, Low, _).
test(an_open_gap_is_a_passage, [Low,High] == [400,1600]) :-          % 3 m deep, a passage at both ends
    ranged([on(crate,1,left,1),busy(left),last(left,1)], start(left,1), Low, High).
test(a_joined_piece_stands_at_the_end, [Low,High] == [0,0]) :-
    ranged([on(crate,1,left,1),joined(crate,1),busy(left),last(left,1)], start(left,1), Low, High).
test(pieces_keep_their_order, Low == 1800) :-                         % 0.4 + 1.0 + 0.4
    ranged([on(crate,1,back,1),on(crate,2,back,2),busy(back),last(back,2)], start(back,2), Low, _).
test(a_turned_piece_takes_its_depth_of_the_wall, High == 2100) :-     % 3 m - 0.4 - 0.5
    ranged([on(crate,1,left,1),turned(crate,1,near),busy(left),last(left,1)], start(left,1), _, High).
test(a_companion_takes_its_place_beside_it, [Low,High] == [400,1200]) :-   % 3 m - 0.4 - 1.0 - 0.4
    ranged([on(crate,1,left,1),with(crate,1,stool,far),busy(left),last(left,1)], start(left,1), Low, High).
test(a_whole_wall_may_be_filled) :-
    fits([on(beam,1,back,1),joined(beam,1),end(back),busy(back),last(back,1)]).
test(a_beam_leaves_no_gap, fail) :-
    fits([on(beam,1,back,1),joined(beam,1),busy(back),last(back,1)]).
test(a_block_leaves_no_passage, fail) :-                              % 2.7 + 0.4 > 3.0
    fits([on(block,1,back,1),busy(back),last(back,1)]).
test(two_stretches_meet_behind_the_owner, Low == 500) :-      % behind the depth of the left crate
    ranged([on(crate,1,left,1),joined(crate,1),on(crate,2,front_left,1),joined(crate,2),corner(front_left,left,left),
            busy(left),busy(front_left),last(left,1),last(front_left,1)], start(front_left,1), Low, _).
test(an_island_has_a_passage_round_it, [Low,High] == [400,2600]) :-    % up to 4 m wide, 1 m long
    ranged([on(crate,1,middle,1)], across(1), Low, High).
test(a_seat_stands_in_its_ring, [Low,High] == [400,2200]) :-
    ranged([on(crate,1,middle,1),with(crate,1,stool,left)], across(1), Low, High).
test(an_island_that_faces_sideways_is_turned, High == 3100) :-          % 0.5 m across
    ranged([on(crate,1,middle,1),faces(crate,1,left)], across(1), _, High).
test(islands_stand_in_a_row, Low == 1800) :-                          % 0.4 + 1.0 + 0.4
    ranged([on(crate,1,middle,1),on(crate,2,middle,2),row(across)], across(2), Low, _).
test(or_one_behind_the_other, Low == 1400) :-                         % 0.5 + 0.5 + 0.4
    ranged([on(crate,1,middle,1),on(crate,2,middle,2),row(inwards)], inwards(2), Low, _).

% - refutations ---------------------------------------------------------------

clash(Layout, Proof, Reasons) :- call(furnished(cell, Layout, Proof, clash(Reasons)), 1, _).

test(a_clash_names_what_is_to_blame_and_nothing_else,
     Reasons == [length(passage),not(turned(block,1,far)),not(turned(block,1,near)),size(cell),size(cell,block),on(block,1,back,1)]) :-
    clash([on(block,1,back,1),busy(back),last(back,1),on(crate,1,left,1),busy(left),last(left,1)], least, Reasons).
test(a_quick_clash_names_that_too) :-
    Layout = [on(block,1,back,1),busy(back),last(back,1),on(crate,1,left,1),busy(left),last(left,1)],
    clash(Layout, least, Least), clash(Layout, quick, Quick),
    subtract(Least, Quick, []).

:- end_tests(room).
