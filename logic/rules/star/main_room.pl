:- module(main_room, [main_room_around//4, main_room_ranges/7, main_areas/3, area_left/2, least_area/3, largest/2, side_chains/5,
                      chain_starts/2, rooms_gap/1, neighbours/3]).

/** <module> The main room and where the rooms stand around it

The rooms are finished, so each is rigid here: outline(Side,Width,Depth,Door,Place). The rooms on one side form a chain,
counted clockwise along the main room's wall; the main room is Width by Height. Place is free, or fixed(Along,Wall)
for a room of another house that stays where it is: where it starts and where its wall with the door is, in metres
from that house's origin. Where the grammar states the area of the whole house, the rooms leave the rest to the main room.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module('../linear/chain').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module('../linear/sample').
:- use_module('../shared_walls/totals').

%!  main_room_around(+Rooms, +Corners, -Main, -Starts)// is semidet.
%
%   Main is main(Width,Height), sampled so that there is room for all, and Starts are where the rooms start, in clockwise
%   order: each door on the main room's wall, a gap between rooms, and at each corner one side at most standing out
%   past the main room, as Corners, the corner/3 atoms of stage 1, say. Fails where rooms of these sizes leave no main room
%   the area that the grammar states of the house.

main_room_around(Rooms, Corners, main(W,H), Starts) -->
    { rooms_gap(Gap),
      side_chains(Rooms, Corners, no_origin, W-H, Chains),
      least_walls(Chains, Gap, W-H, Least) },
    main_room_sample(Rooms, Least, W-H),
    all_chains_sample(Chains, Gap),
    { chain_starts(Chains, Starts) }.

%!  main_areas(+Rooms, +Corners, -Areas) is det.
%
%   Areas are Low-High, those that a main room around these rooms may have by its own law, of which none is fixed.

main_areas(Rooms, Corners, Low-High) :-
    rooms_gap(Gap),
    side_chains(Rooms, Corners, no_origin, W-H, Chains),
    least_walls(Chains, Gap, W-H, Least),
    largest(Rooms, Largest),
    least_area(Largest, Least, Low), High is 2*Low.

%   least_walls(+Chains, +Gap, ?Size, -Least): how wide and high a main room of this Size is at least.

least_walls(Chains, Gap, W-H, W0-H0) :-
    before_all(Before),
    phrase(all_packed(Chains, Gap, Before), Constraints),
    findall(Low-Lowest, ( {W >= 0, H >= 0}, posted(Constraints), inf(W, Low), inf(H, Lowest) ), [W0-H0]).

all_packed([], _, _)                    --> [].
all_packed([Chain|Chains], Gap, Before) --> packed_constraints(Chain, Gap, Before), all_packed(Chains, Gap, Before).

chain_starts(Chains, Starts) :- findall(S, ( member(Chain, Chains), member(block(S,_,_,_), Chain) ), Starts).

%   side_chains(+Rooms, +Corners, +Origin, ?Size, -Chains): those of the four sides, clockwise; Origin as in fixed_start/4,
%   or no_origin where no room is fixed.

side_chains(Rooms, Corners, Origin, W-H, Chains) :-
    maplist(side_chain(Rooms, Corners, Origin), [north-W,east-H,south-W,west-H], Chains).

side_chain(Rooms, Corners, Origin, Side-Wall, Blocks) :-
    rooms_gap(Gap),
    on_side(Rooms, Side, Standing),
    neighbours(Side, Before, After),
    ( memberchk(corner(Before,Side,Before), Corners) -> Near = [at_least(Gap)-[]] ; Near = [] ),
    ( memberchk(corner(Side,After,After), Corners)   -> Far = inside(Gap) ; Far = free ),
    room_blocks(Standing, Near, Far, wall(Side,Wall,Origin), Blocks).

%   on_side(+Rooms, +Side, -Standing): not by findall/3, which would copy what is unknown.

on_side([], _, []).
on_side([Room|Rooms], Side, Standing) :-
    ( Room = outline(Side,_,_,_,_) -> Standing = [Room|Others] ; Standing = Others ),
    on_side(Rooms, Side, Others).

%   Nothing stands near a door, not even behind the walls of the next room.

rooms_gap(Gap) :- length_of(room_gap, Apart), length_of(door_clearance, Clear), Gap is max(Apart, Clear).

neighbours(north, west, east).
neighbours(east, north, south).
neighbours(south, east, west).
neighbours(west, south, north).

%   room_blocks(+Rooms, +Near, +Far, +Wall, -Blocks): Near bounds the first room; where Far is inside(Gap), the last one
%   ends that far before the corner.

room_blocks([], _, _, _, []).
room_blocks([outline(_,Width,_,Door,Place)|Rooms], Near, Far, Wall, [block(_,Width,Bounds,[])|Blocks]) :-
    Wall = wall(Side,Length,Origin),
    length_of(door_width, DoorWidth),
    First = -Door,
    ( Rooms == [], Far = inside(Gap) -> End = [at_most(Length-Gap-Width)-[]] ; End = [] ),
    ( Place = fixed(Along,_) -> fixed_start(Side, Along, Origin, At), Fixed = [at(At)-[]] ; Fixed = [] ),
    append([Fixed, [at_least(First)-[], at_most(Length-Door-DoorWidth)-[]], Near, End], Bounds),
    room_blocks(Rooms, [], Far, Wall, Blocks).

%   fixed_start(+Side, +Along, +Origin, -Start): where a room that starts Along starts on a side of the main room, whose
%   corners lie at origin(West,North,East,South).

fixed_start(north, Along, origin(West,_,_,_),  Along-West).
fixed_start(east,  Along, origin(_,North,_,_), Along-North).
fixed_start(south, Along, origin(_,_,East,_),  East-Along).
fixed_start(west,  Along, origin(_,_,_,South), South-Along).

%   main_room_sample(+Rooms, +Least, -Size)// is semidet: no smaller than any room, at most twice as long as wide and at most
%   twice as large as it must be. Area is the one bilinear law: the width is sampled where a height remains for it, and
%   then the height.

main_room_sample(Rooms, Least, W-H) -->
    { area_left(Rooms, Left),
      areas(Rooms, Least, Left, Areas),
      width_range(Least, Areas, WLow-WHigh) },
    interval_sample(WLow, WHigh, 1, Wide),
    { width_with_height(Least, Areas, WLow, Wide, W, HLow-HHigh) },
    interval_sample(HLow, HHigh, 1, H),
    { total_area(_) -> within(W*H, Areas) ; true }.

within(Area, Low-High) :- Area >= Low - 1.0e-6, Area =< High + 1.0e-6.

%   areas(+Rooms, +Least, +Left, -Areas) is semidet: the least and the greatest area of a main room at least as wide and high as Least,
%   of those that are Left to it.

areas(Rooms, Least, From-To, Low-High) :-
    largest(Rooms, Largest),
    least_area(Largest, Least, Area),
    Low is max(Largest, From), High is min(2*Area, To),
    Low =< High + 1.0e-9, Area =< High + 1.0e-9.

%!  area_left(+Rooms, -Areas) is det.
%
%   Areas are what the area of the whole house leaves to the main room: any, where the grammar states none.

area_left(Rooms, Areas) :-
    (   total_area(Least-Most)
    ->  maplist(area, Rooms, Each), sum_list(Each, Taken),
        Low is Least - Taken, High is Most - Taken, Areas = Low-High
    ;   any_area(Areas) ).

any_area(0-High) :- High is inf.

%   On a grid there may be no whole height between the bounds: then the room is narrower by some cells.

width_with_height(Least, Areas, WLow, Wide, W, Heights) :-
    height_range(Least, Areas, Wide, HLow-HHigh),
    (   on_grid, ceiling(HLow-1.0e-6) > floor(HHigh+1.0e-6), Wide-1 >= WLow
    ->  Narrower is Wide-1,
        width_with_height(Least, Areas, WLow, Narrower, W, Heights)
    ;   W = Wide, Heights = HLow-HHigh ).

width_range(W0-H0, Low-High, WLow-WHigh) :-
    WLow is max(W0, max(H0/2, sqrt(Low/2))),
    WHigh is min(sqrt(2*High), High/max(H0, 1.0e-9)).

height_range(_-H0, Low-High, W, HLow-HHigh) :-
    HLow is max(H0, max(W/2, Low/W)),
    HHigh is min(2*W, High/W).

%!  least_area(+Largest, +Least, -Area) is det.
%
%   Area is that of a rectangle at least as wide and high as Least, at most twice as long as wide, and no smaller than Largest.

least_area(Largest, W0-H0, Least) :- Least is max(Largest, max(W0, H0/2) * max(H0, W0/2)).

%!  largest(+Rooms, -Area) is det.

largest(Rooms, Largest) :-
    maplist(area, Rooms, Areas),
    max_list(Areas, Largest).

area(outline(_,Width,Depth,_,_), Area) :- Area is Width*Depth.

%!  main_room_ranges(+Rooms, +Corners, +Width, +Areas, -Walls, -Widths, -Heights) is det.
%
%   Walls are how long the north, east, south and west wall must be for the rooms there; Widths and Heights are Low-High,
%   in which the main room's width is sampled, and its height where it has this Width. Areas are `any`, or `left` where the main room
%   has what the rooms leave of the house's area.

main_room_ranges(Rooms, Corners, Width, Areas, [North,East,South,West], Widths, Heights) :-
    rooms_gap(Gap),
    side_chains(Rooms, Corners, no_origin, W-H, Chains),
    maplist(least_wall(Gap), [W,H,W,H], Chains, [North,East,South,West]),
    Least = W0-H0, W0 is max(North, South), H0 is max(East, West),
    ( Areas == left -> area_left(Rooms, Left) ; any_area(Left) ),
    areas(Rooms, Least, Left, Range),
    width_range(Least, Range, Widths),
    height_range(Least, Range, Width, Heights).

least_wall(Gap, Wall, Chain, Least) :-
    before_all(Before),
    phrase(packed_constraints(Chain, Gap, Before), Constraints),
    findall(Low, ( {Wall >= 0}, posted(Constraints), inf(Wall, Low) ), [Least]).
