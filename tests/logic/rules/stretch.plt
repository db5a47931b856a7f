% A stretch of wall as a chain of blocks: where they may start at the extremes.
:- use_module('../../../logic/rules/room/solution').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/linear').
:- use_module('../../../logic/rules/room/records').
:- use_module('../../../logic/rules/room/room').
:- use_module('../../../logic/rules/room/stretch').
:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(stretch).

%   starts(+Layout, +Name, -Ranges): of the blocks of a stretch, in whole millimetres, in a cell with this layout.

starts(Layout, Name, Ranges) :-
    layout_room(cell, Layout, Room),
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    solution:system(Room, Items, Constraints, System),
    posted(System),
    room_stretches(Room, Stretches), memberchk(stretch(Name,_,Blocks), Stretches),
    findall(Low-High, ( member(block(S,_,_,_), Blocks), range(S, Low, High) ), Ranges).

range(X, Low, High) :-
    ( number(X) -> L = X, H = X ; inf(X, L), sup(X, H) ),
    Low is round(L*1000), High is round(H*1000).

of(Name, Layout, Stretch) :- layout_room(cell, Layout, Room), room_stretches(Room, All), Stretch = stretch(Name,_,_), memberchk(Stretch, All).

test(an_open_gap_is_a_passage, Ranges == [400-1600]) :-          % 3 m deep, a passage at both ends
    starts([on(crate,1,left,1),busy(left),last(left,1)], left, Ranges).
test(a_joined_piece_stands_at_the_end, Ranges == [0-0]) :-
    starts([on(crate,1,left,1),joined(crate,1),busy(left),last(left,1)], left, Ranges).
test(a_stretch_may_end_at_its_far_end, Ranges == [2000-2000]) :-
    starts([on(crate,1,left,1),end(left),busy(left),last(left,1)], left, Ranges).
test(a_turned_piece_takes_its_depth_of_the_wall, Ranges == [400-2100]) :-     % 3 m - 0.4 - 0.5
    starts([on(crate,1,left,1),turned(crate,1,near),busy(left),last(left,1)], left, Ranges).
test(a_companion_takes_its_place_beside_it, Ranges == [400-1200]) :-   % 3 m - 0.4 - 1.0 - 0.4
    starts([on(crate,1,left,1),with(crate,1,stool,far),busy(left),last(left,1)], left, Ranges).
test(pieces_joined_to_each_other_are_one_block, Ranges == [400-600]) :-
    starts([on(crate,1,left,1),on(crate,2,left,2),joined(crate,2),busy(left),last(left,2)], left, Ranges).
test(pieces_apart_are_blocks_with_a_passage_between_them, Ranges == [400-1600,1800-3000]) :-   % at a wall of up to 4.4 m
    starts([on(crate,1,back,1),on(crate,2,back,2),busy(back),last(back,2)], back, [A-_,B-_]),
    Ranges = [A-1600,B-3000].
test(the_front_stretch_ends_before_the_door, High == 1700) :-          % door at 3.2 at most, clearance 0.5, 1 m long
    starts([on(crate,1,front_left,1),joined(crate,1),end(front_left),busy(front_left),last(front_left,1)], front_left, [_-_]),
    High = 1700.
test(behind_the_owner_of_a_corner_stands_the_other, Ranges == [500-500]) :-
    starts([on(crate,1,left,1),end(left),on(crate,2,back,1),joined(crate,2),corner(left,back,left),
            busy(left),busy(back),last(left,1),last(back,1)], back, Ranges).
test(the_owner_of_the_corner_stands_in_it, Ranges == [0-0]) :-
    starts([on(crate,1,left,1),end(left),on(crate,2,back,1),joined(crate,2),corner(left,back,back),
            busy(left),busy(back),last(left,1),last(back,1)], back, Ranges).
test(a_joined_block_names_the_atoms_that_put_it_there,
     Why == [not(corner(front_left,left,front_left)),joined(crate,1),on(crate,1,left,1)]) :-
    of(left, [on(crate,1,left,1),joined(crate,1),last(left,1)], stretch(_,_,[block(_,_,[at(_)-Found|_],_)])), msort(Found, Why).
test(the_last_bound_says_why_the_stretch_ends, true(( memberchk(last(left,1), Why), memberchk(not(end(left)), Why), memberchk(length(passage), Why) ))) :-
    of(left, [on(crate,1,left,1),last(left,1)], stretch(_,_,[block(_,_,Bounds,_)])), last(Bounds, at_most(_)-Why).
test(a_joint_beside_a_busy_corner_keeps_a_passage, true(( X =:= 0.4, Y =:= 0 ))) :-
    Ons = [on(crate,1,left,1),joined(crate,1),on(crate,2,left,2),joined(crate,2),last(left,2)],
    of(left, [on(crate,3,front_left,1),last(front_left,1)|Ons], stretch(_,_,[block(_,_,[_,at_least(_+X-_)-_|_],_)])),
    of(left, Ons, stretch(_,_,[block(_,_,[_,at_least(_+Y-_)-_|_],_)])).
test(the_core_begins_behind_a_seat, true(memberchk(with(crate,1,stool,front), Why))) :-
    of(left, [on(crate,1,left,1),with(crate,1,stool,front),busy(left),last(left,1)], Stretch), Stretch = stretch(_,[Link],_),
    make_room([core(core(X1,_,_,_)),width(4.0),depth(3.0)], Room), link_out(Link, Out), link_seat(Link, _-item(_,_,Own,_)),
    phrase(stretch_constraints(Stretch, Room), [(Sum =< Before)-Why|_]), Sum == Out+Own, Before == X1.
test(an_empty_stretch_has_no_constraint, Constraints == []) :- phrase(stretch_constraints(stretch(left,[],[]), _), Constraints).
test(a_stretch_joined_at_both_ends_is_filled_by_sizes_alone, Kinds == [filling,free]) :-
    of(back, [on(beam,1,back,1),joined(beam,1),end(back),last(back,1)], Full), stretch_items(Full, [Kind-_]), functor(Kind, A, _),
    of(back, [on(beam,1,back,1),joined(beam,1),last(back,1)], Part), stretch_items(Part, [B-_]), Kinds = [A,B].
test(the_deepest_link_counts, Out == 0.5) :- deepest([link(_,_,_,_,0.2,_,none,_),link(_,_,_,_,0.5,_,none,_)], Out).

:- end_tests(stretch).
