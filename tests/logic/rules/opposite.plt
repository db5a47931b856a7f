% Pieces that stand opposite others.
:- use_module('../../../logic/rules/room/opposite').
:- use_module('../../../logic/rules/room/record_access').
:- use_module('../../../logic/rules/room/records').
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(opposite).

link(Type, Along, Gap, Link) :-
    make_link([gap(Gap-[]),role(piece(1)),item(item(Type,_,_,_)),along(Along),out(0.5),front(out),seat(none),why([])], Link).

%   wish(+Name, +Links, -Wish): of a keg, 1 m long, at this stretch of a room of 4 by 6 m with a rack 1.5 to 3.5 m along its left wall.

wish(Name, Links, Wish) :-
    make_room([width(4.0),depth(6.0),islands([])], Room), link(rack, 2.0, apart, Rack),
    wishes([opposite(keg,1,rack,1)], Room, [stretch(left,[Rack],[block(1.5,2.0,[],[])]),stretch(Name,Links,[block(_,_,[],[])])], Stretches),
    last(Stretches, stretch(_,_,[block(_,_,Bounds,_)])),
    ( memberchk(wish(E)-_, Bounds) -> Wish is E ; Wish = none ).

test(it_wishes_to_have_its_middle_across_from_the_others, Wish =:= 2.0) :- link(keg, 1.0, apart, Keg), wish(right, [Keg], Wish).
test(from_the_back_it_is_as_far_from_there, Wish =:= 3.0) :- link(keg, 1.0, apart, Keg), wish(right_back, [Keg], Wish).
test(what_is_joined_before_it_counts, Wish =:= 1.5) :-
    link(crate, 0.5, apart, Crate), link(keg, 1.0, joined, Keg), wish(right, [Crate,Keg], Wish).
test(at_a_wall_round_the_corner_it_has_no_wish, Wish == none) :- link(keg, 1.0, apart, Keg), wish(back, [Keg], Wish).

:- end_tests(opposite).
