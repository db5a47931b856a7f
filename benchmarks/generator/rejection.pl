:- module(rejection, [tries_until_valid/3]).

/** <module> The original's method, rewritten: sample every number of a plan, test it, and begin again

De Gasperis, Migliarini and others place the rooms of a house so: sizes and places of all rooms and of the main room
are sampled, all constraints are tested, and `repeat` samples all again if one fails. Rooms only, without
furniture; metres; the sizes of grammars/paper. It is spared what slows the original down: a test leaves no choice
point, and compares numbers instead of posting constraints.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(random)).
:- use_module(library(time)).

%!  tries_until_valid(+Count, +Seconds, -Tries) is det.
%
%   Tries plans of Count rooms were sampled until one was valid; 0 if none was within Seconds.

tries_until_valid(Count, Seconds, Tries) :-
    nb_setval(tries, 0),
    catch(call_with_time_limit(Seconds, until_valid(Count)), time_limit_exceeded, nb_setval(tries, 0)),
    nb_getval(tries, Tries).

until_valid(Count) :-
    repeat,
    nb_getval(tries, N0), N is N0 + 1, nb_setval(tries, N),
    sampled(Count, Main, Rooms),
    once(valid(Rooms, Main)),
    !.

%   sampled(+Count, -Main, -Rooms): rectangles box(X,Y,W,H); a room overlaps the main room, as in the original's files,
%   and its door, at a random place of a random wall, must lie in the main room. The main room is sampled in a range that
%   takes about as many tries as the original, which needs 7, 1,500, 4,350 and 54,000 for 2, 4, 5 and 6 rooms.

sampled(Count, box(0,0,W,H), Rooms) :-
    Least is 2.0 + 2*Count, Most is 4.0 + 3*Count,
    random(Least, Most, W), random(Least, Most, H),
    length(Rooms, Count),
    maplist(sampled_room(W, H), Rooms).

sampled_room(W, H, room(box(X,Y,RW,RH),Wall,Door)) :-
    random_member(Low-High, [3.66-5.18,2.44-3.66,3.05-4.57,4.57-6.1]),
    random(Low, High, RW), random(Low, High, RH),
    West is -RW, random(West, W, X), North is -RH, random(North, H, Y),
    random_member(Wall, [north,east,south,west]),
    random(0.0, 1.0, Door).

valid([], _).
valid([Room|Rooms], Main) :-
    Room = room(Box,_,_),
    astride(Box, Main),
    door_inside(Room, Main),
    no_larger(Box, Main),
    maplist(apart(Room), Rooms),
    valid(Rooms, Main).

astride(box(X,Y,W,H), box(_,_,MW,MH)) :-
    X + W > 0, Y + H > 0, X < MW, Y < MH,
    once(( X < 0 ; Y < 0 ; X + W > MW ; Y + H > MH )).

door_inside(room(box(X,Y,W,H),Wall,Share), box(_,_,MW,MH)) :-
    door(Wall, X, Y, W, H, Share, X1, Y1, X2, Y2),
    X1 >= 0, Y1 >= 0, X2 =< MW, Y2 =< MH.

door(north, X, Y, W, _, S, X1, Y, X2, Y)  :- X1 is X + S*(W-0.762), X2 is X1 + 0.762.
door(south, X, Y, W, H, S, X1, Y1, X2, Y1) :- X1 is X + S*(W-0.762), X2 is X1 + 0.762, Y1 is Y + H.
door(west,  X, Y, _, H, S, X, Y1, X, Y2)  :- Y1 is Y + S*(H-0.762), Y2 is Y1 + 0.762.
door(east,  X, Y, W, H, S, X1, Y1, X1, Y2) :- X1 is X + W, Y1 is Y + S*(H-0.762), Y2 is Y1 + 0.762.

no_larger(box(_,_,W,H), box(_,_,MW,MH)) :- W*H =< MW*MH.

apart(room(box(X1,Y1,W1,H1),_,_), room(box(X2,Y2,W2,H2),_,_)) :-
    once(( X1 + W1 + 0.762 =< X2 ; X2 + W2 + 0.762 =< X1 ; Y1 + H1 + 0.762 =< Y2 ; Y2 + H2 + 0.762 =< Y1 )).
