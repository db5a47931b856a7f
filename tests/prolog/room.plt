% The constraints of a room: what fits, what does not, and where things may stand at the extremes.
:- use_module('../../logic/rules/grammar').
:- use_module('../../logic/rules/room').
:- use_module(library(clpr)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(room).

ends(X, Low, High) :- inf(X, L), sup(X, H), Low is round(L*1000), High is round(H*1000).

test(an_empty_room_leaves_the_door_free, [Low,High] == [0,3200]) :-
    furnished(cell, [], room(_,_,_,Door,_,_,_)), ends(Door, Low, High).
test(a_piece_on_the_left_keeps_the_door_clear, Low == 1000) :-       % depth 0.5, clearance 0.5
    furnished(cell, [on(crate,1,left,1)], room(_,_,_,Door,_,_,_)), ends(Door, Low, _).
test(an_open_gap_is_a_passage, [Low,High] == [400,1600]) :-          % 3 m deep, a passage at both ends
    furnished(cell, [on(crate,1,left,1)], room(_,_,_,_,_,[_,chain(left,[piece(_,S,_,_,_)],_)|_],_)),
    ends(S, Low, High).
test(a_joined_piece_stands_at_the_end) :-
    furnished(cell, [on(crate,1,left,1),joined(crate,1)], room(_,_,_,_,_,[_,chain(left,[piece(_,S,_,_,_)],_)|_],_)),
    S =:= 0.
test(pieces_keep_their_order, Low == 1800) :-                         % 0.4 + 1.0 + 0.4
    furnished(cell, [on(crate,1,back,1),on(crate,2,back,2)],
              room(_,_,_,_,_,[_,_,chain(back,[_,piece(_,S,_,_,_)],_)|_],_)),
    ends(S, Low, _).
test(a_whole_wall_may_be_filled) :-
    furnished(cell, [on(beam,1,back,1),joined(beam,1),end(back)], _).
test(a_beam_leaves_no_gap, fail) :-
    furnished(cell, [on(beam,1,back,1),joined(beam,1)], _).
test(a_block_leaves_no_passage, fail) :-                              % 2.7 + 0.4 > 3.0
    furnished(cell, [on(block,1,back,1)], _).
test(two_stretches_meet_behind_the_owner, Low == 500) :-              % behind the depth of the left crate
    furnished(cell, [on(crate,1,left,1),joined(crate,1),on(crate,2,front_left,1),joined(crate,2),
                     corner(front_left,left,left)],
              room(_,_,_,_,_,[chain(front_left,[piece(_,S,_,_,_)],_)|_],_)),
    ends(S, Low, _).
test(an_island_has_a_passage_round_it, [Low,High] == [400,2600]) :-    % up to 4 m wide, 1 m long
    furnished(cell, [on(crate,1,middle,1)], room(_,_,_,_,_,_,[island(_,X,_,_,_)])), ends(X, Low, High).

test(islands_stand_in_a_row, Low == 1800) :-                          % 0.4 + 1.0 + 0.4
    furnished(cell, [on(crate,1,middle,1),on(crate,2,middle,2),row(across)],
              room(_,_,_,_,_,_,[_,island(_,X,_,_,_)])), ends(X, Low, _).
test(or_one_behind_the_other, Low == 1400) :-                         % 0.5 + 0.5 + 0.4
    furnished(cell, [on(crate,1,middle,1),on(crate,2,middle,2),row(inwards)],
              room(_,_,_,_,_,_,[_,island(_,_,Y,_,_)])), ends(Y, Low, _).

:- end_tests(room).
