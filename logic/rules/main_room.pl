:- module(main_room, [around//4]).

/** <module> The main room and where the rooms stand around it

The rooms are finished, so each is rigid here: r(Side,Width,Depth,Door). The rooms on one side form a chain,
counted clockwise along the main room's wall; the main room is Width by Height.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(yall)).
:- use_module(chain).
:- use_module(draw).
:- use_module(grammar).
:- use_module(linear).

%!  around(+Rooms, +Corners, -Main, -Starts)// is det.
%
%   Main is main(Width,Height), drawn so that there is room for all, and Starts are where the rooms start, in clockwise
%   order: each door on the main room's wall, a gap between rooms, and at each corner one side at most standing out
%   past the main room, as Corners, the corner/3 atoms of stage 1, say.

around(Rooms, Corners, main(W,H), Starts) -->
    { gap(Gap),
      maplist(side_chain(Rooms, Corners, Gap), [north-W,east-H,south-W,west-H], Chains),
      nowhere(Before),
      phrase(all_packed(Chains, Gap, Before), Constraints),
      findall(W0-H0, ( {W >= 0, H >= 0}, posted(Constraints), inf(W, W0), inf(H, H0) ), [LeastW-LeastH]) },
    draw_main_room(Rooms, LeastW, LeastH, W, H),
    draw_chains(Chains, Gap),
    { findall(S, ( member(Chain, Chains), member(block(S,_,_,_), Chain) ), Starts) }.

all_packed([], _, _)                  --> [].
all_packed([Chain|Chains], Gap, Before) --> packed_constraints(Chain, Gap, Before), all_packed(Chains, Gap, Before).

side_chain(Rooms, Corners, Gap, Side-Wall, Blocks) :-
    findall(Width-Door, member(r(Side,Width,_,Door), Rooms), Standing),
    neighbours(Side, Before, After),
    ( memberchk(corner(Before,Side,Before), Corners) -> Near = [at_least(Gap)-[]] ; Near = [] ),
    ( memberchk(corner(Side,After,After), Corners)   -> Far = inside ; Far = free ),
    blocks(Standing, Near, Far, Gap, Wall, Blocks).

%   Nothing stands near a door, not even behind the walls of the next room.

gap(Gap) :- length_of(room_gap, Apart), length_of(door_clearance, Clear), Gap is max(Apart, Clear).

neighbours(north, west, east).
neighbours(east, north, south).
neighbours(south, east, west).
neighbours(west, south, north).

blocks([], _, _, _, _, []).
blocks([Width-Door|Rooms], Near, Far, Gap, Wall, [block(_,Width,Bounds,[])|Blocks]) :-
    length_of(door_width, DoorWidth),
    First is -Door,
    ( Rooms == [], Far == inside -> End = [at_most(Wall-Gap-Width)-[]] ; End = [] ),
    append([[at_least(First)-[], at_most(Wall-Door-DoorWidth)-[]], Near, End], Bounds),
    blocks(Rooms, [], Far, Gap, Wall, Blocks).

%   draw_main_room(+Rooms, +LeastWidth, +LeastHeight, -W, -H)// is det: no smaller than any room, at most twice as long
%   as wide and at most twice as large as it must be. Area is the one bilinear law: the width is drawn where a height
%   remains for it, and then the height.

draw_main_room(Rooms, W0, H0, W, H) -->
    { maplist([r(_,Width,Depth,_),Area]>>(Area is Width*Depth), Rooms, Areas),
      max_list(Areas, Largest),
      Least is max(Largest, max(W0, H0/2) * max(H0, W0/2)),
      WLow is max(W0, max(H0/2, sqrt(Largest/2))),
      WHigh is min(2*sqrt(Least), 2*Least/max(H0, 1.0e-9)) },
    between_ends(WLow, WHigh, 1, W),
    { HLow is max(H0, max(W/2, Largest/W)),
      HHigh is min(2*W, 2*Least/W) },
    between_ends(HLow, HHigh, 1, H).

draw_chains([], _)               --> [].
draw_chains([Chain|Chains], Gap) --> draw_chain(Chain, Gap), draw_chains(Chains, Gap).
