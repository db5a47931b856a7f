:- module(plan, [house_plan/4, furniture_plan/3]).

/** <module> From the rooms' own frames to the house's plan

The main room's north-west corner is (0,0); x grows east, y grows south. A box is box(X,Y,Width,Height). A frame is
frame(Side,X,Y): that of a room on this side of its front wall, whose front left corner is (X,Y) in the house.
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(lists)).
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module(record_access).
:- use_module(records).
:- use_module(shape).

%!  house_plan(+Main, +Starts, +Rooms, -Plan) is det.
%
%   Plan is a dict as in a house file, in metres, its rooms in a list. Rooms are Side-Room, each with its start; the plan
%   of a fixed room is null.

house_plan(Main, Starts, Rooms, _{floor:Floor, rooms:Plans}) :-
    Main = main(W,H),
    rectangle(frame(north,0,0), box(0,-H,W,H), Floor),
    maplist(room_plan(Main), Rooms, Starts, Plans).

room_plan(_, _-fixed(_,_), _, null) :- !.
room_plan(Main, Side-Room, Start, Plan) :-
    room_type(Room, Type), room_width(Room, W), room_depth(Room, D), room_door(Room, Door),
    length_of(door_width, DoorWidth),
    side_frame(Side, Main, Start, Frame),
    rectangle(Frame, box(0,0,W,D), Outline),
    rectangle(Frame, box(Door,0,DoorWidth,0), DoorPlan),
    furniture_plan(Frame, Room, Pieces),
    Plan = Outline.put(_{type:Type, door:DoorPlan, children:Pieces}).

%   side_frame(+Side, +Main, +Start, -Frame): that of a room which starts there clockwise along a side of the main room.

side_frame(north, _,           S, frame(north,S,0)).
side_frame(east,  main(MW,_),  S, frame(east,MW,S)).
side_frame(south, main(MW,MH), S, frame(south,X,MH)) :- X is MW - S.
side_frame(west,  main(_,MH),  S, frame(west,0,Y))   :- Y is MH - S.

%!  furniture_plan(+Frame, +Room, -Pieces) is det.
%
%   Pieces are those of a room, as in a house file.

furniture_plan(Frame, Room, Pieces) :-
    room_stretches(Room, Stretches), room_islands(Room, Islands),
    maplist(stretch_plan(Frame, Room), Stretches, OnWalls),
    maplist(island_plan(Frame), Islands, Free),
    append([Free|OnWalls], Pieces).

% - along the walls -----------------------------------------------------------------------------------

stretch_plan(_, _, stretch(_,[],_), []) :- !.
stretch_plan(Frame, Room, stretch(Name,Links,Blocks), Pieces) :-
    maplist(block_start, Blocks, Starts),
    link_plans(Links, Starts, 0, stands(Frame,Room,Name), Plans),
    findall(Piece, nested(Plans, Piece), Pieces).

block_start(block(Start,_,_,_), Start).

%   link_plans(+Links, +Starts, +At, +Stands, -Plans): Plans are Role-Plan. A link stands At the end of the one that it is
%   joined to, or at the next start. The first link of a stretch starts a block too.

link_plans([], _, _, _, []).
link_plans([Link|Links], Starts, At, Stands, [Role-Plan|Plans]) :-
    link_gap(Link, Gap), link_role(Link, Role), link_item(Link, item(F,_,_,_)), link_seat(Link, Seat),
    link_along(Link, Along), link_out(Link, Out), link_front(Link, Front),
    ( Starts = [Start|Later], ( Gap = apart-_ ; At == 0 ) -> true ; Start = At, Later = Starts ),
    Stands = stands(Frame,Room,Name),
    wall_box(Name, Room, Start, Along-Out, Box),
    rectangle(Frame, Box, Outline),
    front(Name, Front, Way),
    orientation(Frame, Way, Orientation),
    Plan = Outline.put(_{type:F, orientation:Orientation, children:[]}),
    ( Seat = with(_,K,_,Hand)-Item -> seated(Hand, Way, There), seat_plan(Frame, Box, seat(There,Item), Child), Plans = [with(F-K)-Child|Plans1] ; Plans = Plans1 ),
    End is Start + Along,
    link_plans(Links, Later, End, Stands, Plans1).

seated(front, Way, Way).
seated(away(front), Way, away(Way)).

nested(Plans, Piece) :-
    member(piece(K)-Plan, Plans),
    findall(Child, member(with(Plan.type-K)-Child, Plans), Children),
    Piece = Plan.put(children, Children).

%   wall_box(+Name, +Room, +Start, +Sizes, -Box): in the room's frame; Sizes are along the stretch and out from it.

wall_box(Name, Room, S, L-D, Box) :-
    stretch_wall(Name, Wall),
    ( counted(Name, along) -> Start = S ; wall_size(Wall, Room, Size), Start is Size - S - L ),
    box_at(Wall, Room, Start, L-D, Box).

box_at(front, _, S, L-D, box(S,0,L,D)).
box_at(back,  Room, S, L-D, box(S,Y,L,D)) :- room_depth(Room, Depth), Y is Depth - D.
box_at(left,  _, S, L-D, box(0,S,D,L)).
box_at(right, Room, S, L-D, box(X,S,D,L)) :- room_width(Room, W), X is W - D.

%   front(+Name, +Front, -Way): where the front of what stands on a stretch faces, in the room's frame.

front(Name, Front, Way) :-
    stretch_wall(Name, Wall), counted(Name, Count),
    ways(Wall, Ways),
    way(Front, Count, Ways, Way).

ways(front, ways(inwards,right,left)).
ways(back,  ways(outwards,right,left)).
ways(left,  ways(right,inwards,outwards)).
ways(right, ways(left,inwards,outwards)).

way(out,  _,       ways(Way,_,_), Way).
way(far,  along,   ways(_,Way,_), Way).
way(far,  against, ways(_,_,Way), Way).
way(near, along,   ways(_,_,Way), Way).
way(near, against, ways(_,Way,_), Way).

% - in the middle -----------------------------------------------------------------------------------------

island_plan(Frame, Island, Plan) :-
    island_item(Island, item(F,_,_,_)), island_across(Island, Across), island_inwards(Island, Inwards),
    island_xblock(Island, block(X0,_,_,_)), island_yblock(Island, block(Y0,_,_,_)),
    island_seats(Island, Seats), island_front(Island, Front),
    ( space_at(left, Seats, Left)      -> X is X0 + Left ; X = X0 ),
    ( space_at(outwards, Seats, Outer) -> Y is Y0 + Outer ; Y = Y0 ),
    rectangle(Frame, box(X,Y,Across,Inwards), Outline),
    orientation(Frame, Front, Orientation),
    maplist(seat_plan(Frame, box(X,Y,Across,Inwards)), Seats, Children),
    Plan = Outline.put(_{type:F, orientation:Orientation, children:Children}).

seat_plan(Frame, Box, seat(Hand,item(G,L,D,_)), Plan) :-
    hand(Hand, Side, Gap),
    widened(Gap, Box, Wide),
    seat_box(Side, Wide, L-D, Seat, Front),
    rectangle(Frame, Seat, Outline),
    orientation(Frame, Front, Orientation),
    Plan = Outline.put(_{type:G, orientation:Orientation, children:[]}).

widened(0, Box, Box) :- !.
widened(Gap, box(X,Y,W,H), box(X1,Y1,W1,H1)) :- X1 is X-Gap, Y1 is Y-Gap, W1 is W+2*Gap, H1 is H+2*Gap.

%   seat_box(+Side, +Box, +Sizes, -Seat, -Front): at the middle of a side, facing it.

seat_box(left,     box(X,Y,_,H), L-D, box(SX,SY,D,L), right)    :- SX is X - D, middle(Y, H, L, SY).
seat_box(right,    box(X,Y,W,H), L-D, box(SX,SY,D,L), left)     :- SX is X + W, middle(Y, H, L, SY).
seat_box(outwards, box(X,Y,W,_), L-D, box(SX,SY,L,D), inwards)  :- SY is Y - D, middle(X, W, L, SX).
seat_box(inwards,  box(X,Y,W,H), L-D, box(SX,SY,L,D), outwards) :- SY is Y + H, middle(X, W, L, SX).

middle(Start, Size, Length, Middle) :-
    ( lattice(whole) -> Middle is Start + floor((Size-Length)/2) ; Middle is Start + (Size-Length)/2 ).

% - from a room's frame to the house's --------------------------------------------------------------------

%   rectangle(+Frame, +Box, -Dict): a box of a room's frame, turned and moved to its place in the house, in metres.

rectangle(Frame, Box, _{x:MX, y:MY, width:MW, height:MH}) :-
    house_box(Frame, Box, box(X,Y,W,H)),
    metres(X, MX), metres(Y, MY), metres(W, MW), metres(H, MH).

house_box(frame(north,OX,OY), box(X,Y,W,H), box(PX,PY,W,H)) :- PX is OX + X,     PY is OY - Y - H.
house_box(frame(east,OX,OY),  box(X,Y,W,H), box(PX,PY,H,W)) :- PX is OX + Y,     PY is OY + X.
house_box(frame(south,OX,OY), box(X,Y,W,H), box(PX,PY,W,H)) :- PX is OX - X - W, PY is OY + Y.
house_box(frame(west,OX,OY),  box(X,Y,W,H), box(PX,PY,H,W)) :- PX is OX - Y - H, PY is OY - X - W.

%   orientation(+Frame, +Front, -Orientation): the point of the compass that a front faces, "" for none.

orientation(_, none, "") :- !.
orientation(frame(Side,_,_), Front, Orientation) :-
    side_quarters(Side, I),
    front_quarters(Front, J),
    K is (I + J) mod 4,
    nth0(K, ["N","E","S","W"], Orientation).

%   side_quarters(?Side, -Quarters), front_quarters(?Front, -Quarters): clockwise from north and from inwards.

side_quarters(north, 0).
side_quarters(east,  1).
side_quarters(south, 2).
side_quarters(west,  3).

front_quarters(inwards,  0).
front_quarters(right,    1).
front_quarters(outwards, 2).
front_quarters(left,     3).
