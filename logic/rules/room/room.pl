:- module(room, [layout_room/3, layout_room/4, room_constraints//1, door_constraints//1, room_items/2, widest_core/1, room_chains/2]).

/** <module> One room as a linear system

Stage 1 has made every choice, so the constraints here are a conjunction of linear ones, as data (linear.pl). A free
rectangle, the core, is kept empty and is at least a passage wide each way. It holds the span of each door along its wall,
or of a door at an open corner at least a passage. Furniture stands along the stretches of wall outside it (links.pl,
stretch.pl) and in its middle (island.pl).
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module('../linear/chain').
:- use_module(island).
:- use_module('../language/lengths').
:- use_module('../linear/grid').
:- use_module(links).
:- use_module(opposite).
:- use_module(reasons).
:- use_module(record_access).
:- use_module(records).
:- use_module(shape).
:- use_module(stretch).

%!  layout_room(+Type, +Layout, -Room) is det.
%!  layout_room(+Type, +Layout, +Doors, -Room) is det.
%
%   Room, a record (records.pl), has the furniture of Layout, the atoms of stage 1; what is to be solved for is unbound.
%   Without Doors it has its entrance alone.

layout_room(Type, Layout, Room) :-
    one_door(_, Doors),
    room_open(Room, none),
    layout_room_(Type, Layout, Doors, Room).

layout_room(Type, Layout, Doors, Room) :-
    findall(Open, ( Open = open(_,_), member(Open, Layout) ), Opens),
    room_open(Room, Opens),
    layout_room_(Type, Layout, Doors, Room).

layout_room_(Type, Layout, Doors, Room) :-
    make_room([type(Type),width(W),depth(D),door(Entrance),doors(Doors),core(core(X1,X2,Y1,Y2)),stretches(Stretches),row(Row),even(Even),
               islands(Islands),strips(Strips),busy(Busy)], Room),
    door_entrance(Doors, Entrance),
    stretch_names(Doors, Names),
    pieces_by_place(Layout, Placed),
    maplist(stretch_links(Placed, Layout, Room), Names, Chains),
    busy_walls(Chains, Busy),
    Busy = busy(Front,Left,Back,Right),
    free_wall(Front, Y1, 0.0), free_wall(Left, X1, 0.0), free_wall(Back, Y2, D), free_wall(Right, X2, W),
    maplist(stretch(Chains, Layout, Room), Chains, OnWalls),
    ( memberchk(row(R), Layout) -> Row = R ; Row = across ),
    findall(Ons, ( member(Place-Ons, Placed), middle_place(Place) ), InRows),
    maplist(maplist(island(Layout, Room)), InRows, Rows),
    append(Rows, Islands),
    strips(Rows, Row, Strips),
    wishes(Layout, Room, OnWalls, Stretches),
    ( memberchk(even_row, Layout) -> Even = yes, in_line(Strips, Row) ; Even = no ).

middle_place(middle).
middle_place(middle(_)).

%   busy_walls(+Chains, ?Busy): the first stretch of each wall at which furniture stands, unbound for none.

busy_walls([], _).
busy_walls([_-[]|Chains], Busy) :- !, busy_walls(Chains, Busy).
busy_walls([Name-_|Chains], Busy) :-
    stretch_wall(Name, Wall),
    wall_busy(Wall, Busy, First),
    ( var(First) -> First = Name ; true ),
    busy_walls(Chains, Busy).

wall_busy(front, busy(Name,_,_,_), Name).
wall_busy(left,  busy(_,Name,_,_), Name).
wall_busy(back,  busy(_,_,Name,_), Name).
wall_busy(right, busy(_,_,_,Name), Name).

%   free_wall(?Busy, ?Edge, +Place): where no furniture stands along it, the core reaches the wall.

free_wall(Busy, Edge, Place) :- ( var(Busy) -> Busy = none, Edge = Place ; true ).

%   pieces_by_place(+Layout, -Placed): Placed are Place-Ons, the on/4 atoms there in order.

pieces_by_place(Layout, Placed) :-
    findall((Place/N)-on(F,K,Place,N), member(on(F,K,Place,N), Layout), Found),
    keysort(Found, Sorted),
    maplist(at_place, Sorted, Ons),
    group_pairs_by_key(Ons, Placed).

at_place((Place/_)-On, Place-On).

%!  room_constraints(+Room)// describes all constraints of a room but those of its sizes, see linear.pl.

room_constraints(Room) -->
    { room_stretches(Room, Stretches), room_row(Room, Row), room_even(Room, Even), room_islands(Room, Islands),
      room_strips(Room, Strips) },
    core_constraints(Room),
    all_stretches_constraints(Stretches, Room),
    fronts_constraints(Stretches),
    island_constraints(Islands, Strips, Row, Even).

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
    core_constraints(Room),
    all_packed_constraints(Chains, P),
    fronts_constraints(Stretches),
    all_seats_constraints(Islands).

all_packed_constraints([], _) --> [].
all_packed_constraints([Chain|Chains], P) -->
    { before_all(Before) },
    packed_constraints(Chain, P, Before),
    all_packed_constraints(Chains, P).

core_constraints(Room) -->
    { room_width(Room, W), room_depth(Room, D), room_doors(Room, Doors), room_core(Room, core(X1,X2,Y1,Y2)),
      length_of(passage, P), length_of(door_clearance, C),
      walls_with_doors(Doors, Walls) },
    all_doors_in_order(Walls, Room),
    [(X1+P =< X2)-[length(passage)], (Y1+P =< Y2)-[length(passage)]],
    turning_constraints(Room),
    all_doors_free(Walls, Room, P-C),
    [(0 =< X1)-[], (X2 =< W)-[], (0 =< Y1)-[], (Y2 =< D)-[]].

%   turning_constraints(+Room)//: a square that is free is in the core. No islands stand there (capacity.lp).

turning_constraints(Room) -->
    { room_type(Room, Type), turning_side(Type, M), !, rounded_up(M, Side), room_core(Room, core(X1,X2,Y1,Y2)) },
    [(X1+Side =< X2)-[turning(Type)], (Y1+Side =< Y2)-[turning(Type)]].
turning_constraints(_) --> [].

all_doors_in_order([], _) --> [].
all_doors_in_order([Wall-Doors|Walls], Room) -->
    { wall_size(Wall, Room, Size), Doors = [door(Start,_,_)|_] },
    [(0 =< Start)-[]],
    doors_in_order(Doors, Size),
    all_doors_in_order(Walls, Room).

doors_in_order([], _) --> [].
doors_in_order([door(Start,Width,Why)|Doors], Size) -->
    { Doors = [door(Next,_,_)|_] -> true ; Next = Size },
    [(Start+Width =< Next)-Why],
    doors_in_order(Doors, Size).

%   all_doors_free(+Walls, +Room, +Lengths)//: furniture keeps clear of the doors of these walls, and they open onto the core.
%   What stands at the neighbouring walls is less deep than the way to the door; or, at an open corner, the core is a
%   passage wide beside the door. Lengths are those of a passage and a door's clearance.

all_doors_free([], _, _) --> [].
all_doors_free([Wall-Doors|Walls], Room, P-C) -->
    { Doors = [door(Start,Width,Why)|_], last(Doors, door(Start2,Width2,Why2)),
      neighbour(Wall, Begin, End, Across),
      wall_span(Wall, Room, Low, High),
      room_busy(Room, Busy), wall_busy(Across, Busy, Name),
      Far = Start2+Width2 },
    beside(Begin, Wall, Room, (Low+C =< Start)-[],  (Low+P =< Start+Width+C)-Why),
    beside(End,   Wall, Room, (Far+C =< High)-Why2, (Start2-C+P =< High)-[]),
    (   { Name == none }
    ->  []
    ;   { room_before(Across, Room, Before) },
        [(C =< Before)-[busy(Name),length(door_clearance)]] ),
    all_doors_free(Walls, Room, P-C).

%   beside(+Neighbour, +Wall, +Room, +Closed, +Open)//: where furniture stands at the neighbouring wall, the constraint of a
%   closed or an open corner.

beside(Neighbour, Wall, Room, Closed-ClosedWhy, Open-OpenWhy) -->
    { room_busy(Room, Busy), wall_busy(Neighbour, Busy, Name), room_open(Room, Opens) },
    (   { Name == none }
    ->  []
    ;   { Opens == none }
    ->  [Closed-[busy(Name),length(door_clearance)|ClosedWhy]]
    ;   { corner_atom(Wall, Neighbour, Atom) },
        (   { \+ memberchk(Atom, Opens) }
        ->  [Closed-[not(Atom),busy(Name),length(door_clearance)|ClosedWhy]]
        ;   { wall_busy(Wall, Busy, Own), Own \== none }
        ->  [Open-[Atom,busy(Name),busy(Own),length(passage),length(door_clearance)|OpenWhy]]
        ;   [] ) ).

%   room_before(+Wall, +Room, -Depth): from the opposite wall to what stands at this one.

room_before(front, Room, D-Y1) :- room_depth(Room, D), room_core(Room, core(_,_,Y1,_)).
room_before(left,  Room, W-X1) :- room_width(Room, W), room_core(Room, core(X1,_,_,_)).
room_before(back,  Room, Y2)   :- room_core(Room, core(_,_,_,Y2)).
room_before(right, Room, X2)   :- room_core(Room, core(_,X2,_,_)).

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
%   Where the sizes are known: the core reaches as near to each wall as the deepest piece there leaves it, and strips are no
%   deeper than what stands there.

widest_core(Room) :-
    room_width(Room, W), room_depth(Room, D), room_core(Room, core(X1,X2,Y1,Y2)), room_stretches(Room, Stretches),
    foldl(wall_deepest, Stretches, deep(0,0,0,0), deep(Front,Left,Back,Right)),
    ( var(X1) -> X1 = Left ; true ),
    ( var(Y1) -> Y1 = Front ; true ),
    ( number(X2) -> true ; X2 is W - Right ),
    ( number(Y2) -> true ; Y2 is D - Back ),
    room_strips(Room, Strips),
    maplist(narrowest_strip, Strips).

wall_deepest(stretch(_,[],_), Deep, Deep) :- !.
wall_deepest(stretch(Name,Links,_), Deep0, Deep) :-
    stretch_wall(Name, Wall),
    deepest(Links, Out),
    deeper_wall(Wall, Out, Deep0, Deep).

deeper_wall(front, Out, deep(F0,L,B,R), deep(F,L,B,R)) :- F is max(F0, Out).
deeper_wall(left,  Out, deep(F,L0,B,R), deep(F,L,B,R)) :- L is max(L0, Out).
deeper_wall(back,  Out, deep(F,L,B0,R), deep(F,L,B,R)) :- B is max(B0, Out).
deeper_wall(right, Out, deep(F,L,B,R0), deep(F,L,B,R)) :- R is max(R0, Out).

%!  room_chains(+Room, -Chains) is det.
%
%   All chains of a room, to be sampled where everything else is known.

room_chains(Room, Chains) :-
    room_stretches(Room, Stretches), room_row(Room, Row), room_even(Room, Even), room_islands(Room, Islands),
    room_strips(Room, Strips),
    maplist(stretch_blocks, Stretches, OnWalls),
    island_chains(Islands, Strips, Row, Chains0),
    even_chains(Even, Chains0, Free),
    append(OnWalls, Free, Chains).

stretch_blocks(stretch(_,_,Blocks), Blocks).
