% The stretches of wall that a room's doors leave.
:- use_module('../../../logic/rules/room/shape').
:- use_module(library(lists)).
:- use_module(library(plunit)).

:- begin_tests(shape).

test(with_its_entrance_alone_a_room_has_five_stretches, Names == [front_left,left,back,right,front_right]) :-
    stretch_names(doors([d],[],[],[]), Names).
test(doors_part_each_wall, Names == [front_left,between(front,1),left_front,left_back,back,
                                     right_front,between(right,1),right_back,front_right]) :-
    stretch_names(doors([d,d],[d],[],[d,d]), Names).
test(each_stretch_belongs_to_a_wall, Walls == [front,left,left,back,right]) :-
    findall(W, ( member(S, [front_right,left_back,left,between(back,2),right_front]), stretch_wall(S, W) ), Walls).
test(a_half_of_a_wall_is_counted_from_its_corner, [A,B,C] == [along,against,along]) :-
    counted(left_front, A), counted(left_back, B), counted(between(left,1), C).
test(where_a_wall_is_parted_its_half_stands_in_the_corner, Other-Owned == (left_front-near)-corner(front_left,left_front,left_front)) :-
    meeting(front_left, near, [front_left-[],left_front-[],left_back-[]], Other, Owned, _).
test(whole_walls_meet_at_their_far_ends, Other-Open == (right-far)-open(back,right)) :-
    meeting(back, far, [front_left-[],left-[],back-[],right-[],front_right-[]], Other, _, Open).
test(what_is_between_doors_meets_nothing, fail) :- meeting(between(back,1), near, [left-[]], _, _, _).
test(at_each_corner_the_ends_name_each_other) :-
    Names = [front_left-[],left_front-[],left_back-[],back-[],right-[],front_right-[]],
    forall(( member(S-_, Names), member(H, [near,far]), meeting(S, H, Names, T-G, _, Open) ),
           meeting(T, G, Names, S-H, _, Open)).
test(a_corner_is_named_alike_from_both_walls, A == B) :- corner_atom(left, front, A), corner_atom(front, left, B).

:- end_tests(shape).
