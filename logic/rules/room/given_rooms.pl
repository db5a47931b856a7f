:- module(given_rooms, [rooms_furnished/4, given_room_system/2, given_shape/2, loose_room_conflict/3, loose_room_starts/3]).

/** <module> Furniture for rooms that stand in a plan: their sizes, doors and places are given */

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module('../answers').
:- use_module('../linear/exact').
:- use_module(furnish).
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module(plan).
:- use_module(shape).
:- use_module(solution).

%!  rooms_furnished(+Rooms, +Proof, +Limit, -Json) is det.
%
%   Rooms are room(R,Type,Atoms,Seed,Size,Doors,Frame): Atoms of stage 1, Size is Width-Depth, Doors are
%   doors(Front,Left,Back,Right) with Start-Width of each, and Frame is as in plan.pl, all in metres. Json is one of these:
%
%       {"rooms":.., "infeasible":[[R,Reasons]..], "inferences":..}     the pieces of each room, as in a house file; null
%                                   where no sizes and places satisfy it, for reasons as in placed/3 of core.pl
%       {"limit": true}             that takes more inferences than Limit

rooms_furnished(Rooms, Proof, Limit, Json) :-
    answer_within(Limit, maplist(room_pieces(Proof), Rooms, Pieces, Conflicts), Pieces-Conflicts, rooms_record, Json).

rooms_record(Pieces-Conflicts, _{rooms:Pieces, infeasible:Infeasible}) :- append(Conflicts, Infeasible).

room_pieces(Proof, room(R,Type,Layout,Seed,Size,Doors,frame(Side,X0,Y0)), Pieces, Conflicts) :-
    given_shape(Size, Doors, Shape),
    call(furnished(Type, Layout, Shape, Proof, Answer), Seed, _),
    (   Answer = infeasible(Why)
    ->  maplist(reason_record, Why, Reasons), Pieces = null, Conflicts = [[R,Reasons]]
    ;   maplist(rounded_up, [X0,Y0], [X,Y]),
        furniture_plan(frame(Side,X,Y), Answer, Pieces), Conflicts = [] ).

%!  given_shape(+Given, -Shape) is det.
%
%   Shape is that of a room (solution.pl) of which Given is `any`, given(Size,Doors), as above, or size(Width,Depth).

given_shape(any, any).
given_shape(size(W0,D0), sized(W,D)) :- maplist(rounded_up, [W0,D0], [W,D]).
given_shape(given(Size,Doors), Shape) :- given_shape(Size, Doors, Shape).

given_shape(W0-D0, doors(F,L,B,K), shape(W,D,doors(Front,Left,Back,Right))) :-
    maplist(rounded_up, [W0,D0], [W,D]),
    maplist(maplist(given_door), [F,L,B,K], [Front,Left,Back,Right]).

given_door(Start0-Width0, door(Start,Width,[])) :- rounded_up(Start0, Start), rounded_up(Width0, Width).

%!  given_room_system(+Room, -Json) is det.
%
%   Json is the linear system of such a room, and whether it has a solution: see solver_verdicts/2.

given_room_system(room(_,Type,Layout,_,Size,Doors,_), Json) :-
    given_shape(Size, Doors, Shape),
    whole_system(Type, Layout, Shape, _, System),
    solver_verdicts(System, Record),
    as_json(Record, Json).

% - doors that may stand elsewhere -----------------------------------------------------------------------------

%!  loose_room_conflict(+Room, +Without, -Json) is det.
%
%   Json lists the reasons, as in placed/3, of a minimal conflict of such a room, where the clauses Without are left out; or is
%   null where there is none. A door of it may be span(Start,End)-Width: it stands anywhere in this part of its wall. Where the
%   doors are `any`, it has one, anywhere in its front wall.

loose_room_conflict(Given, Without, Json) :-
    loose_system(Given, Room, _, System),
    (   system_conflict(Room, System, Without, Why)
    ->  maplist(reason_record, Why, Reasons)
    ;   Reasons = null ),
    as_json(Reasons, Json).

%!  loose_room_starts(+Room, +Seed, -Json) is det.
%
%   Json lists, wall by wall, where the doors of such a room start that has no conflict: sampled one after the other.

loose_room_starts(Given, Seed, Json) :-
    loose_system(Given, _, doors(Front,Left,Back,Right), System),
    maplist(maplist(door_start), [Front,Left,Back,Right], Starts),
    append(Starts, Unknowns),
    call(system_sample(System, Unknowns), Seed, _),
    as_json(Starts, Json).

door_start(door(Start,_,_), Start).

loose_system(room(_,Type,Layout,_,W-D,any,_), Room, Doors, System) :-
    one_door(_, Doors),
    whole_system(Type, Layout, shape(W,D,Doors), Room, System).
loose_system(room(_,Type,Layout,_,W-D,doors(F,L,B,K),_), Room, Doors, System) :-
    foldl(loose_doors, [F,L,B,K], [Front,Left,Back,Right], [], Ranges),
    Doors = doors(Front,Left,Back,Right),
    whole_system(Type, Layout, shape(W,D,Doors), Room, Furnished),
    append(Ranges, Furnished, System).

loose_doors(Given, Doors, Ranges0, Ranges) :- foldl(loose_door, Given, Doors, Ranges0, Ranges).

loose_door(span(A,B)-Width, door(Start,Width,[length(door_width)]), Ranges, [(Low =< Start)-Why,(Start =< High)-Why|Ranges]) :- !,
    length_of(door_margin, Margin),
    Low is A + Margin, High is max(Low, B - Width - Margin),
    Why = [length(door_width),length(door_margin)].
loose_door(Start-Width, door(Start,Width,[]), Ranges, Ranges).
