% Doors whose leaves miss each other.
:- use_module('../../../logic/rules/language/grammar_files').
:- use_module('../../../logic/rules/shared_walls/swings').
:- use_module(library(lists)).
:- use_module(library(plunit)).
:- prolog_load_context(directory, Here), atom_concat(Here, '/grammar.pl', File), load_grammar([File], []).

:- begin_tests(swings).

%   starts(+Range, +Doors, -Least, -Most): 200 doors of 1 m in a Range of the wall y = 0 start between Least and Most.

starts(Range, Doors, Least, Most) :-
    findall(Start, ( between(1, 200, Seed), start_sample(x-0.0, 1.0, Range, Doors, Start, Seed, _) ), Starts),
    min_list(Starts, Least), max_list(Starts, Most).

% On the wall x = 3 the squares of this door reach from x = 2 to x = 4.
round_the_corner(door(box(3.0,0.5,0.0,1.0),a,b)).

test(a_door_starts_anywhere_without_others, true(( Least < 0.2, Most > 3.8 ))) :- starts(0.0-4.0, [], Least, Most).
test(it_keeps_out_of_the_squares_of_a_door_round_the_corner, true(( Most =< 1.0, Most > 0.9 ))) :-
    round_the_corner(Door), starts(0.0-3.0, [Door], _, Most).
test(on_both_sides_of_them_it_starts) :-
    round_the_corner(Door),
    forall(between(1, 50, Seed), ( start_sample(x-0.0, 1.0, 0.0-6.0, [Door], Start, Seed, _), ( Start =< 1.0 ; Start >= 4.0 ) )).
test(where_they_leave_no_place_it_starts_anywhere, true(( Least < 2.1, Most > 2.9 ))) :-
    round_the_corner(Door), starts(2.0-3.0, [Door], Least, Most).
test(a_door_farther_away_is_no_matter, true(Most > 2.8)) :- starts(0.0-3.0, [door(box(3.0,2.0,0.0,1.0),a,b)], _, Most).
test(an_opening_has_no_leaf, true(Most > 2.8)) :- starts(0.0-3.0, [opening(box(3.0,0.5,0.0,1.0),a,b)], _, Most).

% The second door has a place only where the first one stands far from it.
two([door(box(A,0.0,1.0,0.0),a,b),door(box(3.0,B,0.0,1.0),a,c)]) -->
    start_sample(x-0.0, 1.0, 0.0-2.0, [], A),
    start_sample(y-3.0, 1.0, 0.0-0.1, [door(box(A,0.0,1.0,0.0),a,b)], B).

test(doors_are_placed_again_where_one_finds_no_place) :-
    forall(between(1, 20, Seed), ( clear_doors(two, [door(box(A,_,_,_),_,_)|_], Seed, _), A =< 1.0 )).

:- end_tests(swings).
