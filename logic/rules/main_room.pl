:- module(main_room, [around/4, draw_main_room//3]).

/** <module> The main room and where the rooms stand around it

The rooms are finished, so each is rigid here: r(Side,Width,Depth,Door). The rooms on one side form a chain,
counted clockwise along the main room's wall; the main room is Width by Height.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(draw).
:- use_module(grammar).

%!  around(+Rooms, +Corners, -Main, -Chains) is semidet.
%
%   Main is main(Width,Height), and Chains list for each side, clockwise from north, where its rooms start:
%   each door on the main room's wall, a gap between rooms, and at each corner one side at most standing out
%   past the main room, as Corners, the corner/3 atoms of stage 1, say.

around(Rooms, Corners, main(W,H), Chains) :-
    { W >= 0, H >= 0 },
    maplist(side_chain(Rooms, Corners), [north-W,east-H,south-W,west-H], Chains).

side_chain(Rooms, Corners, Side-Wall, Starts) :-
    findall(room(Width,Door), member(r(Side,Width,_,Door), Rooms), Standing),
    neighbours(Side, Before, After),
    ( memberchk(corner(Before,Side,Before), Corners) -> Near = inside ; Near = free ),
    ( memberchk(corner(Side,After,After), Corners)   -> Far = inside ; Far = free ),
    starts(Standing, Near, Far, Wall, Starts).

%   Nothing stands near a door, not even behind the walls of the next room.

gap(Gap) :- metres(room_gap, Apart), metres(door_clearance, Clear), Gap is max(Apart, Clear).

neighbours(north, west, east).
neighbours(east, north, south).
neighbours(south, east, west).
neighbours(west, south, north).

starts([], _, _, _, []).
starts([room(Width,Door)|Rooms], Near, Far, Wall, [S|Starts]) :-
    gap(Gap),
    ( Near == inside -> { S >= Gap } ; true ),
    door_on(Wall, S, Door),
    following(Rooms, S, Width, Far, Wall, Starts).

following([], S, Width, Far, Wall, []) :-
    gap(Gap),
    ( Far == inside -> { S + Width + Gap =< Wall } ; true ).
following([room(Width,Door)|Rooms], S0, Width0, Far, Wall, [S|Starts]) :-
    gap(Gap),
    { S >= S0 + Width0 + Gap },
    door_on(Wall, S, Door),
    following(Rooms, S, Width, Far, Wall, Starts).

door_on(Wall, S, Door) :-
    metres(door_width, DoorWidth),
    { S + Door >= 0, S + Door + DoorWidth =< Wall }.

%!  draw_main_room(+Rooms, ?Main, ?Chains)// is det.
%
%   Fixes the main room, then the rooms along it. It is no smaller than any room, at most twice as long as wide
%   and at most twice as large as it must be. Area is the one bilinear law: the width is drawn where a height
%   remains for it, and then the height's bounds are linear.

draw_main_room(Rooms, main(W,H), Chains) -->
    { maplist([r(_,Width,Depth,_),Area]>>(Area is Width*Depth), Rooms, Areas),
      max_list(Areas, Largest),
      inf(W, W0), inf(H, H0),
      Least is max(Largest, max(W0, H0/2) * max(H0, W0/2)),
      WLow is max(W0, max(H0/2, sqrt(Largest/2))),
      WHigh is min(2*sqrt(Least), 2*Least/max(H0, 1.0e-9)),
      {W >= WLow, W =< WHigh} },
    uniform(W),
    { HLow is max(H0, max(W/2, Largest/W)),
      HHigh is min(2*W, 2*Least/W),
      {H >= HLow, H =< HHigh} },
    uniform(H),
    draw_chains(Chains).

draw_chains([])             --> [].
draw_chains([Starts|Chains]) --> { length(Starts, N) }, draw_starts(Starts, N), draw_chains(Chains).

draw_starts([], _)         --> [].
draw_starts([S|Starts], N) --> start(S, N), { N1 is N-1 }, draw_starts(Starts, N1).
