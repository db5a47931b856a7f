% What the lengths of a tiny room could have been, and which of its constraints bind.
:- use_module('../../../logic/rules/why/bounds').
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/linear/grid').
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(bounds).

two([on(crate,1,back,1),on(crate,2,back,2),busy(back),last(back,2)]).

row([on(crate,1,left,1),joined(crate,1),busy(left),last(left,1)]).

seats([on(stand,1,middle,1),with(stand,1,stool,left),with(stand,1,stool,inwards)]).

%   bounds(+Layout, +Target, +What, -Low, -High): in whole millimetres.

bounds(Layout, Target, What, Low, High, LowWhy, HighWhy) :-
    room_bounds(cell, Layout, any, any, 1, Target, Lengths, _),
    memberchk(length(What,Value,L-LowWhy,H-HighWhy), Lengths),
    Value >= L - 1.0e-6, Value =< H + 1.0e-6,
    Low is round(L*1000), High is round(H*1000).

test(a_room_is_bound_by_its_clause, [Low,High,Why1,Why2] == [3000,4000,[size(cell)],[size(cell)]]) :-
    bounds([], room, width, Low, High, Why1, Why2).
test(a_room_is_bound_by_what_stands_in_it,
     true(( Low == 3300, memberchk(busy(right), Why), memberchk(length(door_width), Why) ))) :-
    Layout = [on(crate,1,left,1),turned(crate,1,near),busy(left),last(left,1),
              on(crate,2,right,1),busy(right),last(right,1)],
    bounds(Layout, room, width, Low, _, Why, _).                      % 1.0 + 0.5 + 0.8 + 0.5 + 0.5
test(a_size_of_one_value_has_no_other, Low-High == 1000-1000) :-
    two(L), bounds(L, on(crate,1,back,1), length, Low, High, _, _).
test(a_place_is_bound_by_what_stands_beside_it, true(( Low == 400, memberchk(length(passage), Why) ))) :-
    two(L), bounds(L, on(crate,1,back,1), along, Low, _, Why, _).
test(the_next_one_leaves_room_for_both, Low == 1800) :-               % 0.4 + 1.0 + 0.4
    two(L), bounds(L, on(crate,2,back,2), along, Low, _, _, _).
test(what_is_joined_has_one_place, [Low,High] == [0,0]) :-
    row(L), bounds(L, on(crate,1,left,1), along, Low, High, Why, _), memberchk(joined(crate,1), Why).
test(a_door_keeps_clear_of_what_stands_at_the_side, true(( Low == 1000, memberchk(length(door_clearance), Why) ))) :-
    row(L), bounds(L, door, left, Low, _, Why, _).
test(a_piece_is_bound_in_a_room_of_its_size, true(( abs(L - 0.5*W) < 1.0e-6, abs(H - (W-0.8)) < 1.0e-6 ))) :-
    Layout = [on(shelf,1,back,1),busy(back),last(back,1)],                  % a passage at both ends
    room_bounds(cell, Layout, any, any, 1, room, Sizes, _), memberchk(length(width,W,_,_), Sizes),
    room_bounds(cell, Layout, any, any, 1, on(shelf,1,back,1), Lengths, _), memberchk(length(length,_,L-_,H-_), Lengths).
test(what_is_joined_binds, true(memberchk(binds([1*(on(crate,1,left,1)-along)],"=",_,_), Binding))) :-
    row(L), room_bounds(cell, L, any, any, 1, on(crate,1,left,1), _, Binding).
test(the_deepest_piece_bounds_the_free_floor,
     true(memberchk(binds([1*(on(crate,1,left,1)-depth),-1*(floor-left)],"=<",_,_), Binding))) :-
    row(L), room_bounds(cell, L, any, any, 1, on(crate,1,left,1), _, Binding).
test(what_is_loose_does_not_bind,
     true(\+ ( member(binds(Sum,_,_,_), Binding), memberchk(_*(on(crate,2,back,2)-along), Sum) ))) :-
    two(L), room_bounds(cell, L, any, any, 1, on(crate,2,back,2), _, Binding).
test(parts_come_as_in_a_house_file, Types == [stand,stool,stool]) :-
    seats(L), room_parts(cell, L, any, Parts), findall(T, member(T-_, Parts), Types).
test(what_stands_in_the_middle_alone_is_bound_both_ways, true(( number(Across), number(Inwards) ))) :-
    Alone = [on(stand,1,middle,1)],
    bounds(Alone, on(stand,1,middle,1), across, Across, _, _, _), bounds(Alone, on(stand,1,middle,1), inwards, Inwards, _, _, _).
test(companions_come_after_their_piece, Atoms == [on(crate,1,back,1),with(crate,1,stool,near),with(crate,1,stool,far),
                                                  on(crate,2,back,2)]) :-
    two(L), room_parts(cell, [with(crate,1,stool,near),with(crate,1,stool,far)|L], any, Parts),
    findall(A, member(_-A, Parts), Atoms).
test(on_a_grid_lengths_are_whole_cells,
     [setup(set_cell(0.5)), cleanup(set_cell(0)), true(( integer(Low), integer(High) ))]) :-
    room_bounds(cell, [], any, any, 1, room, Lengths, _), memberchk(length(width,_,Low-_,High-_), Lengths).

:- end_tests(bounds).
