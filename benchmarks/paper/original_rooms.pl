:- module(original_rooms, [tries_until_placed/3]).

/** <module> The original's placing of rooms: sample all, test all, begin again

Goal for goal what the original's program writes as a clause and calls (environments/example1.pl there), for any number
of rooms, in feet: every number is sampled before CLP(R) sees it, so `{}` only tests, and each alternative of a test that
is true leaves a choice point. Main room, doors and furniture come after it there, and are no part of this.
*/

:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(random)).

%!  tries_until_placed(+Types, +Inferences, -Tries) is det.
%
%   Tries samples of rooms of these Types were made until one was valid; 0 if none was within so many Inferences.

tries_until_placed(Types, Inferences, Tries) :-
    nb_setval(tries, 0),
    call_with_inference_limit(once(environment(Types)), Inferences, Result),
    ( Result == inference_limit_exceeded -> Tries = 0 ; nb_getval(tries, Tries) ).

environment(Types) :-
    length(Types, Count),
    Environment is 15 + 8*Count,
    repeat,
    nb_getval(tries, N0), N is N0 + 1, nb_setval(tries, N),
    all_sampled(Types, Environment, Rooms),
    all_apart(Rooms),
    near_their_middle(Rooms, Count),
    !.

all_sampled([], _, []).
all_sampled([Type|Types], Environment, [room(X,Y,W,H)|Rooms]) :-
    side(Type, Least, Most),
    random(Least, Most, W),
    random(Least, Most, H),
    Across is Environment - W, random(0.0, Across, X),
    Down is Environment - H, random(0.0, Down, Y),
    all_sampled(Types, Environment, Rooms).

side(bedroom,  12.0, 17.0).
side(bathroom,  8.0, 12.0).
side(kitchen,  10.0, 15.0).
side(hall,     15.0, 20.0).

all_apart([]).
all_apart([Room|Rooms]) :- each_apart(Rooms, Room), all_apart(Rooms).

each_apart([], _).
each_apart([room(X2,Y2,W2,H2)|Rooms], room(X1,Y1,W1,H1)) :-
    { (X1 + W1 + 2.5 =< X2 ; X2 + W2 + 2.5 =< X1) ; (Y1 + H1 + 2.5 =< Y2 ; Y2 + H2 + 2.5 =< Y1) },
    each_apart(Rooms, room(X1,Y1,W1,H1)).

%   near_their_middle(+Rooms, +Count): the middle is the mean of the rooms' corners, as in the original; one room has none.

near_their_middle(_, 1) :- !.
near_their_middle(Rooms, Count) :-
    findall(X, member(room(X,_,_,_), Rooms), Xs), sum_list(Xs, SumX), MiddleX is SumX/Count,
    findall(Y, member(room(_,Y,_,_), Rooms), Ys), sum_list(Ys, SumY), MiddleY is SumY/Count,
    Most is 10.0 + 3*Count,
    all_near(Rooms, MiddleX-MiddleY, Most).

all_near([], _, _).
all_near([room(X,Y,W,H)|Rooms], MiddleX-MiddleY, Most) :-
    Distance is sqrt((X + W/2 - MiddleX)^2 + (Y + H/2 - MiddleY)^2),
    { Distance =< Most },
    all_near(Rooms, MiddleX-MiddleY, Most).
