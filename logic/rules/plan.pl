:- module(plan, [plan/4]).

/** <module> From the rooms' own frames to the house's plan

The main room's north-west corner is (0,0); x grows east, y grows south.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(draw).
:- use_module(grammar).

%!  plan(+Main, +Starts, +Rooms, -Plan) is det.
%
%   Plan is a dict as in a house file, in metres, its rooms in a list. Rooms are Side-Room, each with where it starts.

plan(Main, Starts, Rooms, _{floor:Floor, rooms:Plans}) :-
    Main = main(W,H),
    rectangle(frame(north,Main,0.0), box(0,-H,W,H), Floor),
    maplist(room_plan(Main), Rooms, Starts, Plans).

room_plan(_, _-kept(_,_,_,_), _, null) :- !.
room_plan(Main, Side-room(Type,W,D,Door,_,Stretches,islands(_,Islands)), Start, Plan) :-
    length_of(door_width, DoorWidth),
    Frame = frame(Side,Main,Start),
    rectangle(Frame, box(0,0,W,D), Outline),
    rectangle(Frame, box(Door,0,DoorWidth,0), DoorPlan),
    maplist(stretch_plan(Frame, W, D), Stretches, OnWalls),
    maplist(island_plan(Frame), Islands, Free),
    append([Free|OnWalls], Pieces),
    Plan = Outline.put(_{type:Type, door:DoorPlan, children:Pieces}).

% - along the walls -----------------------------------------------------------------------------------

stretch_plan(Frame, W, D, stretch(Name,Links,Blocks), Pieces) :-
    block_starts(Blocks, Starts),
    link_plans(Links, Starts, 0, stands(Frame,W,D,Name), Plans),
    findall(Piece, nested(Plans, Piece), Pieces).

block_starts(Blocks, Starts) :- findall(S, member(block(S,_,_,_), Blocks), Starts).

%   link_plans(+Links, +Starts, +At, +Stands, -Plans): a link stands At the end of the one that it is joined to, or at
%   the next start. The first link of a stretch has a block of its own too.

link_plans([], _, _, _, []).
link_plans([link(Gap,Role,item(F,_,_,_),Along,Out,Front,_)|Links], Starts, At, Stands, [Role-Plan|Plans]) :-
    ( Starts = [S|Later], ( Gap = apart-_ ; At == 0 ) -> true ; S = At, Later = Starts ),
    Stands = stands(Frame,W,D,Name),
    on_wall(Name, W, D, S, Along, Out, Box),
    rectangle(Frame, Box, Outline),
    front(Name, Front, Way),
    facing(Frame, Way, Orientation),
    Plan = Outline.put(_{type:F, orientation:Orientation, children:[]}),
    End is S + Along,
    link_plans(Links, Later, End, Stands, Plans).

nested(Plans, Piece) :-
    member(piece(K)-Plan, Plans),
    findall(Child, member(with(Plan.type-K)-Child, Plans), Children),
    Piece = Plan.put(children, Children).

%   on_wall(+Stretch, +W, +D, +Start, +Length, +Depth, -Box): in the room's frame.

on_wall(front_left,  _, _, S, L, Depth, box(S,0,L,Depth)).
on_wall(front_right, W, _, S, L, Depth, box(X,0,L,Depth))  :- X is W - S - L.
on_wall(back,        _, D, S, L, Depth, box(S,Y,L,Depth))  :- Y is D - Depth.
on_wall(left,        _, _, S, L, Depth, box(0,S,Depth,L)).
on_wall(right,       W, _, S, L, Depth, box(X,S,Depth,L))  :- X is W - Depth.

%   front(+Stretch, +Front, -Way): where the front of what stands on a stretch faces, in the room's frame.

front(front_left,  out, inwards).    front(front_left,  far, right).      front(front_left,  near, left).
front(front_right, out, inwards).    front(front_right, far, left).       front(front_right, near, right).
front(back,        out, outwards).   front(back,        far, right).      front(back,        near, left).
front(left,        out, right).      front(left,        far, inwards).    front(left,        near, outwards).
front(right,       out, left).       front(right,       far, inwards).    front(right,       near, outwards).

% - in the middle -----------------------------------------------------------------------------------------

island_plan(Frame, island(item(F,_,_,_),Across,Inwards,block(X0,_,_,_),block(Y0,_,_,_),Seats,Front), Plan) :-
    ( memberchk(seat(left,item(_,_,Left,_)), Seats)         -> X is X0 + Left ; X = X0 ),
    ( memberchk(seat(outwards,item(_,_,Outer,_)), Seats)    -> Y is Y0 + Outer ; Y = Y0 ),
    rectangle(Frame, box(X,Y,Across,Inwards), Outline),
    facing(Frame, Front, Orientation),
    maplist(seat_plan(Frame, box(X,Y,Across,Inwards)), Seats, Children),
    Plan = Outline.put(_{type:F, orientation:Orientation, children:Children}).

seat_plan(Frame, Box, seat(Hand,item(G,L,D,_)), Plan) :-
    seat_box(Hand, Box, L, D, Seat, Front),
    rectangle(Frame, Seat, Outline),
    facing(Frame, Front, Orientation),
    Plan = Outline.put(_{type:G, orientation:Orientation, children:[]}).

%   seat_box(+Hand, +Box, +Length, +Depth, -Seat, -Front): at the middle of a side, facing it.

seat_box(left,     box(X,Y,_,H), L, D, box(SX,SY,D,L), right)    :- SX is X - D, middle(Y, H, L, SY).
seat_box(right,    box(X,Y,W,H), L, D, box(SX,SY,D,L), left)     :- SX is X + W, middle(Y, H, L, SY).
seat_box(outwards, box(X,Y,W,_), L, D, box(SX,SY,L,D), inwards)  :- SY is Y - D, middle(X, W, L, SX).
seat_box(inwards,  box(X,Y,W,H), L, D, box(SX,SY,L,D), outwards) :- SY is Y + H, middle(X, W, L, SX).

middle(Start, Size, Length, Middle) :-
    ( lattice(whole) -> Middle is Start + floor((Size-Length)/2) ; Middle is Start + (Size-Length)/2 ).

% - from a room's frame to the house's -----------------------------------------------------------------------

%   rectangle(+Frame, +Box, -Dict): the frame of a room on one side of the main room, whose rooms start so far
%   clockwise along it, turned and moved to its place.

rectangle(frame(Side,Main,S), Box, _{x:MX, y:MY, width:MW, height:MH}) :-
    turned(Side, Main, S, Box, X, Y, W, H),
    maplist(metres, [X,Y,W,H], [MX,MY,MW,MH]).

turned(north, _,          S, box(X,Y,W,H), PX, PY, W, H) :- PX is S + X, PY is -Y - H.
turned(east,  main(MW,_), S, box(X,Y,W,H), PX, PY, H, W) :- PX is MW + Y, PY is S + X.
turned(south, main(MW,MH), S, box(X,Y,W,H), PX, PY, W, H) :- PX is MW - S - X - W, PY is MH + Y.
turned(west,  main(_,MH), S, box(X,Y,W,H), PX, PY, H, W) :- PX is -Y - H, PY is MH - S - X - W.

facing(_, none, "") :- !.
facing(frame(Side,_,_), Front, Orientation) :-
    nth0(I, [north,east,south,west], Side),
    nth0(J, [inwards,right,outwards,left], Front),
    K is (I + J) mod 4,
    nth0(K, ["N","E","S","W"], Orientation).
