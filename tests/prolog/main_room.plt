% The rooms around the main room.
:- use_module('../../logic/rules/grammar').
:- use_module('../../logic/rules/main_room').
:- use_module(library(clpr)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(main_room).

least(X, Low) :- inf(X, L), Low is round(L*1000).

test(a_room_may_stand_out_up_to_its_door, [W,Start] == [800,-1000]) :-
    around([r(north,3.0,3.0,1.0)], [], main(Width,_), [[S]|_]), least(Width, W), least(S, Start).
test(at_the_other_side_s_corner_it_stays_inside, W == 2300) :-          % gap 0.5 + door at 1.0 + 0.8
    around([r(north,3.0,3.0,1.0),r(west,3.0,3.0,1.0)], [corner(west,north,west)], main(Width,_), _),
    least(Width, W).
test(neighbours_keep_their_gap, S == 2500) :-                           % -1.0 + 3.0 + 0.5, the door's clearance
    around([r(north,3.0,3.0,1.0),r(north,3.0,3.0,1.0)], [], _, [[_,Second]|_]), least(Second, S).
test(the_main_room_is_no_smaller_than_a_room) :-
    draw([0.0,0.0,0.5], Width, Height), Width*Height >= 9.0 - 1.0e-9.
test(nor_more_than_twice_as_large_as_needed) :-
    draw([0.99,0.99,0.5], Width, Height), Width*Height =< 18.0 + 1.0e-9.
test(nor_more_than_twice_as_long_as_wide) :-
    draw([0.999,0.0,0.5], Width, Height), max(Width/Height, Height/Width) =< 2.0 + 1.0e-9.

draw(Numbers, Width, Height) :-
    Rooms = [r(north,3.0,3.0,1.0)],
    around(Rooms, [], main(Width,Height), Chains),
    phrase(draw_main_room(Rooms, main(Width,Height), Chains), Numbers, _).

:- end_tests(main_room).
