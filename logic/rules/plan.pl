:- module(plan, [plan/4]).

/** <module> From the rooms' own frames to the house's plan

The main room's north-west corner is (0,0); x grows east, y grows south.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(grammar).

%!  plan(+Main, +Chains, +Rooms, -Plan) is det.
%
%   Plan is a dict as in a house file, its rooms in a list. Rooms are Side-Room, in the order of the chains.

plan(main(W,H), Chains, Rooms, _{floor: _{x:0.0, y:0.0, width:W, height:H}, rooms: Plans}) :-
    append(Chains, Starts),
    maplist(room_plan(main(W,H)), Rooms, Starts, Plans).

room_plan(Main, Side-room(Type,W,D,Door,_,Chains,Islands), Start, Plan) :-
    metres(door_width, DoorWidth),
    Frame = frame(Side,Main,Start),
    rectangle(Frame, box(0.0,0.0,W,D), Outline),
    rectangle(Frame, box(Door,0.0,DoorWidth,0.0), DoorPlan),
    maplist(chain_plan(Frame, W, D), Chains, OnWalls),
    maplist(island_plan(Frame), Islands, Free),
    append([Free|OnWalls], Pieces),
    Plan = Outline.put(_{type:Type, door:DoorPlan, children:Pieces}).

chain_plan(Frame, W, D, chain(Stretch,Pieces,_), Plans) :-
    maplist(piece_plan(Frame, W, D, Stretch), Pieces, Plans).

piece_plan(Frame, W, D, Stretch, piece(F,S,L,Depth,_), Plan) :-
    on_wall(Stretch, W, D, S, L, Depth, Box, Front),
    rectangle(Frame, Box, Outline),
    Frame = frame(Side,_,_),
    facing(Side, Front, Orientation),
    Plan = Outline.put(_{type:F, orientation:Orientation, children:[]}).

island_plan(Frame, island(F,X,Y,L,D), Plan) :-
    rectangle(Frame, box(X,Y,L,D), Outline),
    Plan = Outline.put(_{type:F, orientation:"", children:[]}).

%   on_wall(+Stretch, +W, +D, +Start, +Length, +Depth, -Box, -Front): in the room's frame, Front is where the
%   piece's front faces.

on_wall(front_left,  _, _, S, L, Depth, box(S,0.0,L,Depth), inwards).
on_wall(front_right, W, _, S, L, Depth, box(X,0.0,L,Depth), inwards)  :- X is W - S - L.
on_wall(back,        _, D, S, L, Depth, box(S,Y,L,Depth),   outwards) :- Y is D - Depth.
on_wall(left,        _, _, S, L, Depth, box(0.0,S,Depth,L), right).
on_wall(right,       W, _, S, L, Depth, box(X,S,Depth,L),   left)     :- X is W - Depth.

%   rectangle(+Frame, +Box, -Dict): the frame of a room on one side of the main room, whose rooms start so far
%   clockwise along it, turned and moved to its place.

rectangle(frame(north,_,S), box(X,Y,W,H), _{x:PX, y:PY, width:W, height:H}) :-
    PX is S + X, PY is 0.0 - Y - H.
rectangle(frame(east,main(MW,_),S), box(X,Y,W,H), _{x:PX, y:PY, width:H, height:W}) :-
    PX is MW + Y, PY is S + X.
rectangle(frame(south,main(MW,MH),S), box(X,Y,W,H), _{x:PX, y:PY, width:W, height:H}) :-
    PX is MW - S - X - W, PY is MH + Y.
rectangle(frame(west,main(_,MH),S), box(X,Y,W,H), _{x:PX, y:PY, width:H, height:W}) :-
    PX is 0.0 - Y - H, PY is MH - S - X - W.

facing(Side, Front, Orientation) :-
    nth0(I, [north,east,south,west], Side),
    nth0(J, [inwards,right,outwards,left], Front),
    K is (I + J) mod 4,
    nth0(K, ["N","E","S","W"], Orientation).
