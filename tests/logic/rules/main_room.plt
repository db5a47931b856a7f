% The rooms around the main room.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/star/fixed_rooms').
:- use_module('../../../logic/rules/star/main_room').
:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(main_room).

sampled(Rooms, Corners, W-H, Starts) :-
    between(1, 200, Seed),
    call(main_room_around(Rooms, Corners, main(W,H), Starts), Seed, _).

least_width(Rooms, Corners, Least) :-
    findall(W, sampled(Rooms, Corners, W-_, _), Ws), min_list(Ws, Least).

test(a_room_may_stand_out_up_to_its_door, true(( Least >= -1.0, Least < -0.9 ))) :-
    findall(S, sampled([outline(north,3.0,3.0,1.0,free)], [], _, [S]), Ss), min_list(Ss, Least).
test(its_door_stays_on_the_wall) :-
    forall(sampled([outline(north,3.0,3.0,1.0,free)], [], W-_, [S]), S + 1.0 + 0.8 =< W + 1.0e-9).
test(at_a_corner_of_the_other_side_it_stays_inside) :-                     % the gap is 0.5: a door's clearance
    forall(sampled([outline(north,3.0,3.0,1.0,free),outline(west,3.0,3.0,1.0,free)], [corner(west,north,west)], _, [S|_]),
           S >= 0.5 - 1.0e-9).
test(at_the_far_end_too) :-
    forall(sampled([outline(north,3.0,3.0,1.0,free),outline(east,3.0,3.0,1.0,free)], [corner(north,east,east)], W-_, [S|_]),
           S + 3.0 =< W - 0.5 + 1.0e-9).
test(the_wall_is_long_enough_for_it, true(( Least >= 2.3, Least < 2.6 ))) :-  % gap 0.5 + door at 1.0 + 0.8
    least_width([outline(north,3.0,1.0,1.0,free),outline(west,3.0,1.0,1.0,free)], [corner(west,north,west)], Least).
test(neighbours_keep_their_gap) :-
    forall(sampled([outline(north,3.0,3.0,1.0,free),outline(north,3.0,3.0,1.0,free)], [], _, [A,B]), B - A >= 3.5 - 1.0e-9).
test(starts_are_those_of_the_rooms_in_clockwise_order, Count == 4) :-
    findall(outline(Side,3.0,3.0,1.0,free), member(Side, [north,east,south,west]), Rooms),
    once(sampled(Rooms, [], _, Starts)), length(Starts, Count).
test(the_main_room_is_no_smaller_than_a_room_nor_twice_as_large_as_needed) :-
    forall(sampled([outline(north,3.0,3.0,1.0,free)], [], W-H, _), ( W*H >= 9.0 - 1.0e-9, W*H =< 18.0 + 1.0e-9 )).
test(the_main_room_is_at_most_twice_as_long_as_wide) :-
    forall(sampled([outline(north,3.0,3.0,1.0,free)], [], W-H, _), max(W/H, H/W) =< 2.0 + 1.0e-9).

% - between fixed rooms -------------------------------------------------------

fixed(Along, Wall, outline(north,3.0,3.0,1.0,fixed(Along,Wall))).

test(a_fixed_room_stands_where_it_was) :-
    fixed(5.0, 2.0, Room),
    forall(( between(1, 50, Seed),
             call(main_room_between([Room,outline(west,3.0,3.0,1.0,free)], [corner(west,north,west)], main(W,_), at(West,North), [S|_]),
                  Seed, _) ),
           ( abs(West + S - 5.0) < 1.0e-6, abs(North - 2.0) < 1.0e-6, S + 1.8 =< W + 1.0e-6 )).
test(fixed_rooms_on_four_sides_give_the_main_rooms_walls, true(( near(West, 0), near(North, 0), near(W, 5), near(H, 4) ))) :-
    Rooms = [outline(north,3.0,3.0,1.0,fixed(1.0,0.0)),outline(east,3.0,3.0,1.0,fixed(0.5,5.0)),
             outline(south,3.0,3.0,1.0,fixed(4.0,4.0)),outline(west,3.0,3.0,1.0,fixed(3.5,0.0))],
    call(main_room_between(Rooms, [], main(W,H), at(West,North), _), 1, _).
test(rooms_of_these_sizes_may_not_fit, fail) :-
    fixed(0.0, 0.0, A), fixed(6.5, 0.0, B), call(main_room_between([A,outline(north,3.0,3.0,1.0,free),B], [], _, _, _), 1, _).
test(two_on_one_side_whose_walls_are_apart_are_infeasible) :-
    fixed(0.0, 0.0, A), fixed(20.0, 0.5, B), infeasible_between([A,B], []).
test(two_that_overlap_are_infeasible) :- fixed(0.0, 0.0, A), fixed(2.0, 0.0, B), infeasible_between([A,B], []).
test(two_side_by_side_are_feasible, fail) :- fixed(0.0, 0.0, A), fixed(9.0, 0.0, B), infeasible_between([A,B], []).
test(no_room_fits_in_a_gap_too_narrow) :-
    fixed(0.0, 0.0, A), fixed(6.0, 0.0, B), infeasible_between([A,outline(north,3.0,3.0,1.0,free),B], []).

near(X, Y) :- abs(X - Y) < 1.0e-6.

:- end_tests(main_room).
