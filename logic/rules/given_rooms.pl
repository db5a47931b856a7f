:- module(given_rooms, [rooms_furnished/4]).

/** <module> Furniture for rooms that stand in a plan: their sizes, doors and places are given */

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(answers).
:- use_module(furnish).
:- use_module(grid).
:- use_module(plan).

%!  rooms_furnished(+Rooms, +Proof, +Limit, -Json) is det.
%
%   Rooms are room(R,Type,Atoms,Seed,Size,Doors,Frame): Atoms of stage 1, Size is Width-Depth, Doors are
%   doors(Front,Left,Back,Right) with Start-Width of each, and Frame is as in plan.pl, all in metres. Json is one of these:
%
%       {"rooms":.., "infeasible":[[R,Reasons]..], "inferences":..}     the pieces of each room, as in a house file; null
%                                   where no sizes and places satisfy it, for reasons as in placed/3 of core.pl
%       {"limit": true}             that takes more inferences than Limit

rooms_furnished(Rooms, Proof, Limit, Json) :-
    statistics(inferences, Before),
    call_with_inference_limit(maplist(room_pieces(Proof), Rooms, Pieces, Conflicts), Limit, Result),
    statistics(inferences, After),
    Inferences is After - Before,
    (   Result == inference_limit_exceeded
    ->  Answer = _{limit:true}
    ;   append(Conflicts, Infeasible),
        Answer = _{rooms:Pieces, infeasible:Infeasible, inferences:Inferences} ),
    as_json(Answer, Json).

room_pieces(Proof, room(R,Type,Layout,Seed,W0-D0,doors(F,L,B,K),frame(Side,X0,Y0)), Pieces, Conflicts) :-
    maplist(rounded_up, [W0,D0,X0,Y0], [W,D,X,Y]),
    maplist(maplist(given_door), [F,L,B,K], [Front,Left,Back,Right]),
    call(furnished(Type, Layout, shape(W,D,doors(Front,Left,Back,Right)), Proof, Answer), Seed, _),
    (   Answer = infeasible(Why)
    ->  maplist(reason_record, Why, Reasons), Pieces = null, Conflicts = [[R,Reasons]]
    ;   furniture_plan(frame(Side,X,Y), Answer, Pieces), Conflicts = [] ).

given_door(Start0-Width0, door(Start,Width,[])) :- rounded_up(Start0, Start), rounded_up(Width0, Width).
