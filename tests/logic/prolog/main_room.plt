% The rooms around the main room.
:- use_module('../../../logic/rules/grammar').
:- use_module('../../../logic/rules/main_room').
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(main_room).

drawn(Rooms, Corners, W, H, Starts) :-
    between(1, 200, Seed),
    call(around(Rooms, Corners, main(W,H), Starts), Seed, _).

least(Rooms, Corners, Least) :-
    findall(W, drawn(Rooms, Corners, W, _, _), Ws), min_list(Ws, Least).

test(a_room_may_stand_out_up_to_its_door, true(( Least >= -1.0, Least < -0.9 ))) :-
    findall(S, drawn([r(north,3.0,3.0,1.0,free)], [], _, _, [S]), Ss), min_list(Ss, Least).
test(its_door_stays_on_the_wall) :-
    forall(drawn([r(north,3.0,3.0,1.0,free)], [], W, _, [S]), S + 1.0 + 0.8 =< W + 1.0e-9).
test(at_the_other_side_s_corner_it_stays_inside) :-                     % the gap is 0.5: a door's clearance
    forall(drawn([r(north,3.0,3.0,1.0,free),r(west,3.0,3.0,1.0,free)], [corner(west,north,west)], _, _, [S|_]), S >= 0.5 - 1.0e-9).
test(the_wall_is_long_enough_for_it, true(( Least >= 2.3, Least < 2.6 ))) :-  % gap 0.5 + door at 1.0 + 0.8
    least([r(north,3.0,1.0,1.0,free),r(west,3.0,1.0,1.0,free)], [corner(west,north,west)], Least).
test(neighbours_keep_their_gap) :-
    forall(drawn([r(north,3.0,3.0,1.0,free),r(north,3.0,3.0,1.0,free)], [], _, _, [A,B]), B - A >= 3.5 - 1.0e-9).
test(the_main_room_is_no_smaller_than_a_room_nor_twice_as_large_as_needed) :-
    forall(drawn([r(north,3.0,3.0,1.0,free)], [], W, H, _), ( W*H >= 9.0 - 1.0e-9, W*H =< 18.0 + 1.0e-9 )).
test(nor_more_than_twice_as_long_as_wide) :-
    forall(drawn([r(north,3.0,3.0,1.0,free)], [], W, H, _), max(W/H, H/W) =< 2.0 + 1.0e-9).

% - around rooms that stay ----------------------------------------------------

stays(S, Along, Wall) :- S = r(north,3.0,3.0,1.0,stays(Along,Wall)).

test(what_stays_stands_where_it_was) :-
    stays(Room, 5.0, 2.0),
    forall(( between(1, 50, Seed),
             call(around_kept([Room,r(west,3.0,3.0,1.0,free)], [corner(west,north,west)], main(W,_), at(West,North), [S|_]), Seed, _) ),
           ( abs(West + S - 5.0) < 1.0e-6, abs(North - 2.0) < 1.0e-6, S + 1.8 =< W + 1.0e-6 )).
test(two_on_one_side_whose_walls_are_apart_are_hopeless) :-
    stays(A, 0.0, 0.0), stays(B, 20.0, 0.5), hopeless([A,B], []).
test(two_that_overlap_are_hopeless) :- stays(A, 0.0, 0.0), stays(B, 2.0, 0.0), hopeless([A,B], []).
test(two_side_by_side_are_not, fail) :- stays(A, 0.0, 0.0), stays(B, 9.0, 0.0), hopeless([A,B], []).
test(nothing_fits_in_a_gap_too_narrow) :-
    stays(A, 0.0, 0.0), stays(B, 6.0, 0.0), hopeless([A,r(north,3.0,3.0,1.0,free),B], []).

:- end_tests(main_room).
