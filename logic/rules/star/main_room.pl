:- module(main_room, [main_room_around//4, main_room_ranges/6, main_room_between//5, infeasible_between/2]).

/** <module> The main room and where the rooms stand around it

The rooms are finished, so each is rigid here: outline(Side,Width,Depth,Door,Place). The rooms on one side form a chain,
counted clockwise along the main room's wall; the main room is Width by Height. Place is free, or fixed(Along,Wall)
for a room of another house that stays where it is: where it starts and where its wall with the door is, in metres
from that house's origin.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module('../linear/chain').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module('../linear/sample').

%!  main_room_around(+Rooms, +Corners, -Main, -Starts)// is det.
%
%   Main is main(Width,Height), sampled so that there is room for all, and Starts are where the rooms start, in clockwise
%   order: each door on the main room's wall, a gap between rooms, and at each corner one side at most standing out
%   past the main room, as Corners, the corner/3 atoms of stage 1, say.

main_room_around(Rooms, Corners, main(W,H), Starts) -->
    { rooms_gap(Gap),
      side_chains(Rooms, Corners, no_origin, W-H, Chains),
      before_all(Before),
      phrase(all_packed(Chains, Gap, Before), Constraints),
      findall(W0-H0, ( {W >= 0, H >= 0}, posted(Constraints), inf(W, W0), inf(H, H0) ), [LeastW-LeastH]) },
    main_room_sample(Rooms, LeastW-LeastH, W-H),
    all_chains_sample(Chains, Gap),
    { chain_starts(Chains, Starts) }.

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

%   main_room_sample(+Rooms, +Least, -Size)// is det: no smaller than any room, at most twice as long as wide and at most
%   twice as large as it must be. Area is the one bilinear law: the width is sampled where a height remains for it, and
%   then the height.

main_room_sample(Rooms, Least, W-H) -->
    { width_range(Rooms, Least, WLow-WHigh) },
    interval_sample(WLow, WHigh, 1, Wide),
    { width_with_height(Rooms, Least, WLow, Wide, W, HLow-HHigh) },
    interval_sample(HLow, HHigh, 1, H).

%   On a grid there may be no whole height between the bounds: then the room is narrower by some cells.

width_with_height(Rooms, Least, WLow, Wide, W, Heights) :-
    height_range(Rooms, Least, Wide, HLow-HHigh),
    (   on_grid, ceiling(HLow-1.0e-6) > floor(HHigh+1.0e-6), Wide-1 >= WLow
    ->  Narrower is Wide-1,
        width_with_height(Rooms, Least, WLow, Narrower, W, Heights)
    ;   W = Wide, Heights = HLow-HHigh ).

width_range(Rooms, W0-H0, WLow-WHigh) :-
    largest(Rooms, Largest),
    least_area(Largest, W0-H0, Least),
    WLow is max(W0, max(H0/2, sqrt(Largest/2))),
    WHigh is min(2*sqrt(Least), 2*Least/max(H0, 1.0e-9)).

height_range(Rooms, W0-H0, W, HLow-HHigh) :-
    largest(Rooms, Largest),
    least_area(Largest, W0-H0, Least),
    HLow is max(H0, max(W/2, Largest/W)),
    HHigh is min(2*W, 2*Least/W).

least_area(Largest, W0-H0, Least) :- Least is max(Largest, max(W0, H0/2) * max(H0, W0/2)).

largest(Rooms, Largest) :-
    maplist(area, Rooms, Areas),
    max_list(Areas, Largest).

area(outline(_,Width,Depth,_,_), Area) :- Area is Width*Depth.

%!  main_room_ranges(+Rooms, +Corners, +Width, -Walls, -Widths, -Heights) is det.
%
%   Walls are how long the north, east, south and west wall must be for the rooms there; Widths and Heights are Low-High,
%   in which the main room's width is sampled, and its height where it has this Width.

main_room_ranges(Rooms, Corners, Width, [North,East,South,West], Widths, Heights) :-
    rooms_gap(Gap),
    side_chains(Rooms, Corners, no_origin, W-H, Chains),
    maplist(least_wall(Gap), [W,H,W,H], Chains, [North,East,South,West]),
    Least = W0-H0, W0 is max(North, South), H0 is max(East, West),
    width_range(Rooms, Least, Widths),
    height_range(Rooms, Least, Width, Heights).

least_wall(Gap, Wall, Chain, Least) :-
    before_all(Before),
    phrase(packed_constraints(Chain, Gap, Before), Constraints),
    findall(Low, ( {Wall >= 0}, posted(Constraints), inf(Wall, Low) ), [Least]).

% - between fixed rooms --------------------------------------------------------------------------------------

%!  main_room_between(+Rooms, +Corners, -Main, -Corner, -Starts)// is semidet.
%
%   As main_room_around//4, with fixed rooms: Corner is at(West,North), where the main room's north-west corner is. Fails
%   where the rooms, of just these sizes, do not fit between the fixed ones. The main room is as small as that allows.

main_room_between(Rooms, Corners, main(W,H), at(West,North), Starts) -->
    { rooms_gap(Gap),
      outline_system(Rooms, Corners, box(West,North,W,H), Chains, Constraints),
      largest(Rooms, Largest) },
    own_box_sample(Constraints, Largest, box(West,North,W,H)),
    all_chains_sample(Chains, Gap),
    { chain_starts(Chains, Starts) }.

%   outline_system(+Rooms, +Corners, ?Box, -Chains, -Constraints): of a main room in this Box with the fixed rooms.

outline_system(Rooms, Corners, Box, Chains, Constraints) :-
    Box = box(West,North,W,H),
    rooms_gap(Gap),
    side_chains(Rooms, Corners, origin(West,North,West+W,North+H), W-H, Chains),
    findall(Side-Wall, member(outline(Side,_,_,_,fixed(_,Wall)), Rooms), Walls),
    phrase(( on_walls(Walls, Box), all_chains_constraints(Chains, Gap) ), Constraints).

on_walls([], _) --> [].
on_walls([Side-Wall|Walls], Box) -->
    { side_place(Side, Box, At) },
    [(At =< Wall)-[], (Wall =< At)-[]],
    on_walls(Walls, Box).

side_place(north, box(_,North,_,_), North).
side_place(east,  box(West,_,W,_),  West+W).
side_place(south, box(_,North,_,H), North+H).
side_place(west,  box(West,_,_,_),  West).

%   own_box_sample(+Constraints, +Largest, -Box)//: the store ends with it; Box is numbers.

own_box_sample(Constraints, Largest, Box, S0, S) :-
    findall(Box-S1, box_sample(Constraints, Largest, Box, S0, S1), [Box-S|_]).

box_sample(Constraints, Largest, box(West,North,W,H)) -->
    { {W >= 0, H >= 0, W =< 2*H, H =< 2*W}, posted(Constraints),
      inf(W, W0), inf(H, H0),
      Least is max(Largest, W0*H0), Side is sqrt(2*Least), Narrow is sqrt(Largest/2),
      {W >= Narrow, H >= Narrow} },
    size_sample(W, Side),
    { Low is Largest/W, {H >= Low}, High is 2*Least/W },
    size_sample(H, High),
    place_sample(West), place_sample(North).

%   size_sample(?X, +Most)// and place_sample: within its projection, up to Most if that is in it.

size_sample(X, _)    --> { number(X) }, !.
size_sample(X, Most) -->
    { inf(X, Low), ( sup(X, Sup) -> High is max(Low, min(Sup, Most)) ; High is max(Low, Most) ) },
    interval_sample(Low, High, 1, V),
    { {X = V} }.

place_sample(X) --> { number(X) }, !.
place_sample(X) --> { inf(X, Low), sup(X, High) }, !, interval_sample(Low, High, 1, V), { {X = V} }.
place_sample(X) --> { ( inf(X, V) -> true ; sup(X, V) -> true ; V = 0.0 ), {X = V} }.

%!  infeasible_between(+Rooms, +Corners) is semidet.
%
%   No sizes at all fit between the fixed rooms, on these sides and in this order: the other rooms may be as narrow as
%   any room can be, their doors anywhere, and the main room of any area.

infeasible_between(Rooms, Corners) :-
    maplist(narrowed, Rooms, Narrowed, Constraints),
    append(Constraints, Sizes),
    outline_system(Narrowed, Corners, box(_,_,W,H), _, Between),
    append(Sizes, Between, All),
    \+ ( {W >= 0, H >= 0, W =< 2*H, H =< 2*W}, posted(All) ).

narrowed(Room, Room, []) :- Room = outline(_,_,_,_,fixed(_,_)), !.
narrowed(outline(Side,Least,_,_,free), outline(Side,W,1,Door,free),
         [(Least =< W)-[], (0 =< Door)-[], (Door+DoorWidth =< W)-[]]) :-
    length_of(door_width, DoorWidth).
