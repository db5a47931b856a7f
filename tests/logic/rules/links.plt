% What stands along a stretch, as links.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/room/links').
:- use_module('../../../logic/rules/room/records').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(links).

links_on(Name, Ons, Layout, Room, Links) :-
    make_room([width(_),depth(_)], Room),
    append(Ons, Layout, All),
    stretch_links([Name-Ons], All, Room, Name, Name-Links).

test(a_stretch_without_pieces_has_no_links, Links == []) :-
    make_room([], Room), stretch_links([back-[on(crate,1,back,1)]], [], Room, left, left-Links).
test(a_piece_takes_its_length_of_the_wall_and_faces_out, true(( Along == L, Out == D, Front == out ))) :-
    links_on(left, [on(crate,1,left,1)], [], _, [Link]),
    link_item(Link, item(crate,L,D,_)), link_along(Link, Along), link_out(Link, Out), link_front(Link, Front).
test(a_turned_piece_takes_its_depth_of_the_wall, true(( Along == D, Out == L, Front == far ))) :-
    links_on(left, [on(crate,1,left,1)], [turned(crate,1,near)], _, [Link]),
    link_item(Link, item(crate,L,D,_)), link_along(Link, Along), link_out(Link, Out), link_front(Link, Front).
test(its_reasons_say_how_it_stands, Why == [on(crate,1,left,1),turned(crate,1,far)]) :-
    links_on(left, [on(crate,1,left,1)], [turned(crate,1,far)], _, [Link]), link_why(Link, Why).
test(a_piece_is_apart_from_what_is_before_it_unless_it_is_joined, Kinds == [apart,joined]) :-
    links_on(left, [on(crate,1,left,1),on(crate,2,left,2)], [joined(crate,2)], _, Links),
    findall(Kind, ( member(Link, Links), link_gap(Link, Kind-_) ), Kinds).
test(that_it_is_not_joined_is_a_reason_too, Why == [not(joined(crate,1)),on(crate,1,left,1)]) :-
    links_on(left, [on(crate,1,left,1)], [], _, [Link]), link_gap(Link, _-Why).
test(companions_stand_at_its_hands, Roles == [with(crate-1),piece(1),with(crate-1)]) :-
    links_on(left, [on(crate,1,left,1)], [with(crate,1,stool,far),with(crate,1,stool,near)], _, Links),
    maplist(link_role, Links, Roles).
test(who_sits_in_front_of_a_piece_takes_nothing_of_the_wall, Roles-Seats == [piece(1)]-[with(crate,1,stool,front)]) :-
    links_on(left, [on(crate,1,left,1)], [with(crate,1,stool,front)], _, Links),
    maplist(link_role, Links, Roles),
    findall(With, ( member(Link, Links), link_seat(Link, With-item(stool,_,_,_)) ), Seats).
test(the_first_of_a_group_has_the_gap_and_the_others_are_joined, Kinds == [apart,joined,joined]) :-
    links_on(left, [on(crate,1,left,1)], [with(crate,1,stool,far),with(crate,1,stool,near)], _, Links),
    findall(Kind, ( member(Link, Links), link_gap(Link, Kind-_) ), Kinds).
test(at_a_side_wall_the_wall_is_the_depth_of_the_room) :-
    forall(member(Name, [left,right]),
           ( links_on(Name, [on(crate,1,Name,1)], [], Room, [Link]), link_item(Link, item(_,_,_,Walls)),
             room_depth(Room, D), room_width(Room, W), Walls == D-W )).
test(elsewhere_it_is_the_width) :-
    forall(member(Name, [front_left,back,front_right]),
           ( links_on(Name, [on(crate,1,Name,1)], [], Room, [Link]), link_item(Link, item(_,_,_,Walls)),
             room_width(Room, W), room_depth(Room, D), Walls == W-D )).

:- end_tests(links).
