:- module(room, [layout_room/3, room_constraints//1, door_constraints//1, room_items/2, widest_core/1, room_chains/2]).

/** <module> One room as a linear system

Stage 1 has made every choice, so the constraints here are a conjunction of linear ones, as data (linear.pl). A free
rectangle, the core, is kept empty: it holds the door's span and is at least a passage wide each way. Furniture stands
along the stretches of wall outside it (links.pl, stretch.pl) and in its middle (island.pl).
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(chain).
:- use_module(island).
:- use_module(lengths).
:- use_module(links).
:- use_module(reasons).
:- use_module(record_access).
:- use_module(records).
:- use_module(stretch).

%!  layout_room(+Type, +Layout, -Room) is det.
%
%   Room, a record (records.pl), has the furniture of Layout, the atoms of stage 1; what is to be solved for is unbound.

layout_room(Type, Layout, Room) :-
    make_room([type(Type),width(W),depth(D),core(Core),stretches(Stretches),row(Row),islands(Islands)], Room),
    Core = core(X1,X2,Y1,Y2),
    pieces_by_place(Layout, Placed),
    maplist(stretch_links(Placed, Layout, Room), [front_left,left,back,right,front_right], Chains),
    Chains = [_-FrontLeft,_-Left,_-Back,_-Right,_-FrontRight],
    ( Left == []  -> X1 = 0.0 ; true ),
    ( Right == [] -> X2 = W   ; true ),
    ( FrontLeft == [], FrontRight == [] -> Y1 = 0.0 ; true ),
    ( Back == []  -> Y2 = D   ; true ),
    maplist(stretch(Chains, Layout, Room), Chains, Stretches),
    ( memberchk(row(R), Layout) -> Row = R ; Row = across ),
    ( memberchk(middle-Ons, Placed) -> maplist(island(Layout, Room), Ons, Islands) ; Islands = [] ).

%   pieces_by_place(+Layout, -Placed): Placed are Place-Ons, the on/4 atoms there in order.

pieces_by_place(Layout, Placed) :-
    findall((Place/N)-on(F,K,Place,N), member(on(F,K,Place,N), Layout), Found),
    keysort(Found, Sorted),
    maplist(at_place, Sorted, Ons),
    group_pairs_by_key(Ons, Placed).

at_place((Place/_)-On, Place-On).

%!  room_constraints(+Room)// describes all constraints of a room but those of its sizes, see linear.pl.

room_constraints(Room) -->
    { room_stretches(Room, Stretches), room_row(Room, Row), room_islands(Room, Islands) },
    core_constraints(Room, Stretches),
    all_stretches_constraints(Stretches, Room),
    island_constraints(Islands, Row).

all_stretches_constraints([], _) --> [].
all_stretches_constraints([Stretch|Stretches], Room) -->
    stretch_constraints(Stretch, Room),
    all_stretches_constraints(Stretches, Room).

%!  door_constraints(+Room)// describes what is left of them where only the door's place is unknown.
%
%   The core is the widest, and no furniture stands at the front wall: so no row depends on the door, and of its starts
%   only the earliest count, see packed_constraints//3.

door_constraints(Room) -->
    { room_stretches(Room, Stretches), room_islands(Room, Islands), room_chains(Room, Chains), length_of(passage, P) },
    core_constraints(Room, Stretches),
    all_packed_constraints(Chains, P),
    all_seats_constraints(Islands).

all_packed_constraints([], _) --> [].
all_packed_constraints([Chain|Chains], P) -->
    { before_all(Before) },
    packed_constraints(Chain, P, Before),
    all_packed_constraints(Chains, P).

core_constraints(Room, Stretches) -->
    { room_width(Room, W), room_depth(Room, D), room_door(Room, Door), room_core(Room, core(X1,X2,Y1,Y2)),
      length_of(passage, P), length_of(door_clearance, C), length_of(door_width, DoorWidth),
      Door2 = Door+DoorWidth },
    [(0 =< Door)-[], (Door2 =< W)-[length(door_width)], (X1+P =< X2)-[length(passage)], (Y1+P =< Y2)-[length(passage)]],
    beside(left,  Stretches, X1+C =< Door,  [length(door_clearance)]),
    beside(right, Stretches, Door2+C =< X2, [length(door_clearance),length(door_width)]),
    beside(back,  Stretches, C =< Y2,       [length(door_clearance)]),
    [(0 =< X1)-[], (X2 =< W)-[], (0 =< Y1)-[], (Y2 =< D)-[]].

%   beside(+Name, +Stretches, +Constraint, +Why)//: furniture on this stretch keeps clear of the door.

beside(Name, Stretches, Constraint, Why) -->
    ( { memberchk(stretch(Name,[],_), Stretches) } -> [] ; [Constraint-[busy(Name)|Why]] ).

% - what is to be sampled ----------------------------------------------------------------------------------

%!  room_items(+Room, -Items) is det.
%
%   Items are Kind-Item, as in stretch_items/2: all that has a size in the room.

room_items(Room, Items) :-
    room_stretches(Room, Stretches), room_islands(Room, Islands),
    maplist(stretch_items, Stretches, OnWalls),
    maplist(island_items, Islands, Free),
    append(OnWalls, A), append(Free, B), append(A, B, Items).

%!  widest_core(?Room) is det.
%
%   Where the sizes are known: the core reaches as near to each wall as the deepest piece there leaves it.

widest_core(Room) :-
    room_width(Room, W), room_depth(Room, D), room_core(Room, core(X1,X2,Y1,Y2)), room_stretches(Room, Stretches),
    Stretches = [stretch(_,FrontLeft,_),stretch(_,Left,_),stretch(_,Back,_),stretch(_,Right,_),stretch(_,FrontRight,_)],
    append(FrontLeft, FrontRight, Front),
    ( Left == []  -> true ; deepest(Left, X1) ),
    ( Front == [] -> true ; deepest(Front, Y1) ),
    ( Right == [] -> true ; deepest(Right, R), X2 is W - R ),
    ( Back == []  -> true ; deepest(Back, B), Y2 is D - B ).

%!  room_chains(+Room, -Chains) is det.
%
%   All chains of a room, to be sampled where everything else is known.

room_chains(Room, Chains) :-
    room_stretches(Room, Stretches), room_row(Room, Row), room_islands(Room, Islands),
    maplist(stretch_blocks, Stretches, OnWalls),
    island_chains(Islands, Row, Free),
    append(OnWalls, Free, Chains).

stretch_blocks(stretch(_,_,Blocks), Blocks).
