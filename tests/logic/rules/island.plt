% Islands: their sizes as they face, their seats, their rows.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/room/island').
:- use_module('../../../logic/rules/room/records').
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(island).

room(Room) :- make_room([width(_),depth(_),core(core(_,_,_,_)),row(across),doors(doors([],[],[],[]))], Room).

of(On, Layout, Island) :- room(Room), island([On|Layout], Room, On, Island).

test(an_island_lies_along_the_front_wall, true(( Across == L, Inwards == D ))) :-
    of(on(crate,1,middle,1), [], Island),
    island_item(Island, item(crate,L,D,_)), island_across(Island, Across), island_inwards(Island, Inwards).
test(one_that_faces_sideways_is_turned, true(( Across == D, Inwards == L ))) :-
    of(on(crate,1,middle,1), [faces(crate,1,left)], Island),
    island_item(Island, item(crate,L,D,_)), island_across(Island, Across), island_inwards(Island, Inwards).
test(without_faces_it_has_no_front, Front == none) :- of(on(crate,1,middle,1), [], Island), island_front(Island, Front).
test(its_walls_are_the_width_and_the_depth_of_the_room, W-D == Walls) :-
    room(Room), On = on(crate,1,middle,1), island([On], Room, On, Island),
    room_width(Room, W), room_depth(Room, D), island_item(Island, item(_,_,_,Walls)).
test(seats_make_the_block_larger_than_the_island, Full == A+Across+B) :-
    of(on(crate,1,middle,1), [with(crate,1,stool,left),with(crate,1,stool,right)], Island),
    island_across(Island, Across), island_xblock(Island, block(_,Full,_,_)), island_yblock(Island, block(_,D,_,_)),
    island_inwards(Island, D0), D == D0,
    island_seats(Island, [seat(left,item(stool,_,A,_)),seat(right,item(stool,_,B,_))]).
test(only_its_own_seats_count, Seats == []) :- of(on(crate,1,middle,1), [with(crate,2,stool,left)], Island), island_seats(Island, Seats).
test(all_that_makes_it_is_a_reason, Why == [length(passage),faces(crate,1,left),on(crate,1,middle,1),with(crate,1,stool,left)]) :-
    of(on(crate,1,middle,1), [faces(crate,1,left),with(crate,1,stool,left)], Island),
    island_xblock(Island, block(_,_,[_-Found|_],_)), msort(Found, Why).
test(after_another_island_the_row_is_a_reason, Reasons == [row(across),on(crate,1,middle,1)]) :-
    of(on(crate,2,middle,2), [on(crate,1,middle,1)], Island),
    island_xblock(Island, block(_,_,[_-Why|_],Apart)), subtract(Apart, Why, Found), msort(Found, Reasons).
test(a_seat_is_no_longer_than_its_side, true(( memberchk((A =< B)-_, Constraints), A == Length, B == Inwards ))) :-
    of(on(crate,1,middle,1), [with(crate,1,stool,left)], Island),
    phrase(island_constraints([Island], [], across, no), Constraints0), last(Constraints0, Last), Constraints = [Last],
    island_inwards(Island, Inwards), island_seats(Island, [seat(_,item(_,Length,_,_))]).
test(no_islands_have_no_chains, Chains == []) :- island_chains([], [], across, Chains).
test(a_row_is_one_chain_and_each_island_one_the_other_way, true(( Row == [A,B], Singles == [[C],[D]] ))) :-
    of(on(crate,1,middle,1), [], One), of(on(crate,2,middle,2), [], Two),
    island_chains([One,Two], [], inwards, [Row|Singles]),
    island_yblock(One, A), island_yblock(Two, B), island_xblock(One, C), island_xblock(Two, D).
test(items_are_the_island_and_its_seats, Types == [crate,stool]) :-
    of(on(crate,1,middle,1), [with(crate,1,stool,left)], Island),
    island_items(Island, Items), findall(T, member(free-item(T,_,_,_), Items), Types).

:- end_tests(island).
