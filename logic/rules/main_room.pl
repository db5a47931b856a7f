:- module(main_room, [around//4, around_kept//5, hopeless/2]).

/** <module> The main room and where the rooms stand around it

The rooms are finished, so each is rigid here: r(Side,Width,Depth,Door,Place). The rooms on one side form a chain,
counted clockwise along the main room's wall; the main room is Width by Height. Place is free, or stays(Along,Wall)
for a room of another house that stays where it is: where it starts and where its wall with the door is, in metres
from an origin of its own.
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
      maplist(side_chain(Rooms, Corners, Gap, none), [north-W,east-H,south-W,west-H], Chains),
      nowhere(Before),
      phrase(all_packed(Chains, Gap, Before), Constraints),
      findall(W0-H0, ( {W >= 0, H >= 0}, posted(Constraints), inf(W, W0), inf(H, H0) ), [LeastW-LeastH]) },
    draw_main_room(Rooms, LeastW, LeastH, W, H),
    draw_chains(Chains, Gap),
    { findall(S, ( member(Chain, Chains), member(block(S,_,_,_), Chain) ), Starts) }.

all_packed([], _, _)                  --> [].
all_packed([Chain|Chains], Gap, Before) --> packed_constraints(Chain, Gap, Before), all_packed(Chains, Gap, Before).

side_chain(Rooms, Corners, Gap, Origin, Side-Wall, Blocks) :-
    standing(Rooms, Side, Standing),
    neighbours(Side, Before, After),
    ( memberchk(corner(Before,Side,Before), Corners) -> Near = [at_least(Gap)-[]] ; Near = [] ),
    ( memberchk(corner(Side,After,After), Corners)   -> Far = inside ; Far = free ),
    blocks(Standing, Near, Far, Gap, Wall, Side, Origin, Blocks).

%   standing(+Rooms, +Side, -Standing): not by findall/3, which would copy what is unknown.

standing([], _, []).
standing([r(Side,Width,_,Door,Place)|Rooms], Side, [s(Width,Door,Place)|Standing]) :- !,
    standing(Rooms, Side, Standing).
standing([_|Rooms], Side, Standing) :- standing(Rooms, Side, Standing).

%   Nothing stands near a door, not even behind the walls of the next room.

gap(Gap) :- length_of(room_gap, Apart), length_of(door_clearance, Clear), Gap is max(Apart, Clear).

neighbours(north, west, east).
neighbours(east, north, south).
neighbours(south, east, west).
neighbours(west, south, north).

blocks([], _, _, _, _, _, _, []).
blocks([s(Width,Door,Place)|Rooms], Near, Far, Gap, Wall, Side, Origin, [block(_,Width,Bounds,[])|Blocks]) :-
    length_of(door_width, DoorWidth),
    First = -Door,
    ( Rooms == [], Far == inside -> End = [at_most(Wall-Gap-Width)-[]] ; End = [] ),
    ( Place = stays(Along,_) -> stays(Side, Along, Origin, At), Stays = [at(At)-[]] ; Stays = [] ),
    append([Stays, [at_least(First)-[], at_most(Wall-Door-DoorWidth)-[]], Near, End], Bounds),
    blocks(Rooms, [], Far, Gap, Wall, Side, Origin, Blocks).

%   stays(+Side, +Along, +Origin, -Start): where a room that starts Along starts on a side of the main room, whose
%   corners lie at origin(West,North,East,South).

stays(north, Along, origin(West,_,_,_),  Along-West).
stays(east,  Along, origin(_,North,_,_), Along-North).
stays(south, Along, origin(_,_,East,_),  East-Along).
stays(west,  Along, origin(_,_,_,South), South-Along).

%   draw_main_room(+Rooms, +LeastWidth, +LeastHeight, -W, -H)// is det: no smaller than any room, at most twice as long
%   as wide and at most twice as large as it must be. Area is the one bilinear law: the width is drawn where a height
%   remains for it, and then the height.

draw_main_room(Rooms, W0, H0, W, H) -->
    { largest(Rooms, Largest),
      Least is max(Largest, max(W0, H0/2) * max(H0, W0/2)),
      WLow is max(W0, max(H0/2, sqrt(Largest/2))),
      WHigh is min(2*sqrt(Least), 2*Least/max(H0, 1.0e-9)) },
    between_ends(WLow, WHigh, 1, W),
    { HLow is max(H0, max(W/2, Largest/W)),
      HHigh is min(2*W, 2*Least/W) },
    between_ends(HLow, HHigh, 1, H).

draw_chains([], _)               --> [].
draw_chains([Chain|Chains], Gap) --> draw_chain(Chain, Gap), draw_chains(Chains, Gap).

largest(Rooms, Largest) :-
    maplist([r(_,Width,Depth,_,_),Area]>>(Area is Width*Depth), Rooms, Areas),
    max_list(Areas, Largest).

% - around rooms that stay -------------------------------------------------------------------------------

%!  around_kept(+Rooms, +Corners, -Main, -Corner, -Starts)// is semidet.
%
%   As around//4, with rooms that stay: Corner is at(West,North), where the main room's north-west corner is. Fails where
%   the rooms, of just these sizes, do not fit between those that stay. The main room is as small as that allows.

around_kept(Rooms, Corners, main(W,H), at(West,North), Starts) -->
    { gap(Gap),
      chains_between(Rooms, Corners, Gap, W, H, West, North, Chains, Constraints),
      largest(Rooms, Largest) },
    drawn_between(Constraints, Largest, W, H, West, North),
    draw_chains(Chains, Gap),
    { findall(S, ( member(Chain, Chains), member(block(S,_,_,_), Chain) ), Starts) }.

chains_between(Rooms, Corners, Gap, W, H, West, North, Chains, Constraints) :-
    Origin = origin(West,North,West+W,North+H),
    maplist(side_chain(Rooms, Corners, Gap, Origin), [north-W,east-H,south-W,west-H], Chains),
    findall(Side-Wall, member(r(Side,_,_,_,stays(_,Wall)), Rooms), Walls),
    phrase(( on_walls(Walls, W, H, West, North), unpacked(Chains, Gap) ), Constraints).

unpacked([], _)               --> [].
unpacked([Chain|Chains], Gap) --> chain_constraints(Chain, Gap), unpacked(Chains, Gap).

on_walls([], _, _, _, _) --> [].
on_walls([Side-Wall|Walls], W, H, West, North) -->
    { wall_at(Side, W, H, West, North, At) },
    [(At =< Wall)-[], (Wall =< At)-[]],
    on_walls(Walls, W, H, West, North).

wall_at(north, _, _, _, North, North).
wall_at(east,  W, _, West, _,  West+W).
wall_at(south, _, H, _, North, North+H).
wall_at(west,  _, _, West, _,  West).

drawn_between(Constraints, Largest, W, H, West, North, S0, S) :-
    findall(v(W,H,West,North,S1), drawn_outline(Constraints, Largest, W, H, West, North, S0, S1), [v(W,H,West,North,S)|_]).

drawn_outline(Constraints, Largest, W, H, West, North) -->
    { {W >= 0, H >= 0, W =< 2*H, H =< 2*W}, posted(Constraints),
      inf(W, W0), inf(H, H0),
      Least is max(Largest, W0*H0), Side is sqrt(2*Least), Narrow is sqrt(Largest/2),
      {W >= Narrow, H >= Narrow} },
    spacious(W, Side),
    { Low is Largest/W, {H >= Low}, High is 2*Least/W },
    spacious(H, High),
    anywhere(West), anywhere(North).

%   spacious(?X, +Most)// and anywhere: within its projection, up to Most if that is in it.

spacious(X, _)    --> { number(X) }, !.
spacious(X, Most) --> { inf(X, Low), ( sup(X, Sup) -> High is max(Low, min(Sup, Most)) ; High is max(Low, Most) ) },
    between_ends(Low, High, 1, V), { {X = V} }.

anywhere(X) --> { number(X) }, !.
anywhere(X) --> { inf(X, Low), sup(X, High) }, !, between_ends(Low, High, 1, V), { {X = V} }.
anywhere(X) --> { ( inf(X, V) -> true ; sup(X, V) -> true ; V = 0.0 ), {X = V} }.

%!  hopeless(+Rooms, +Corners) is semidet.
%
%   No sizes at all fit between those that stay, on these sides and in this order: the other rooms may be as narrow as
%   any room can be, their doors anywhere, and the main room of any area.

hopeless(Rooms, Corners) :-
    gap(Gap),
    maplist(shrunk, Rooms, Shrunk, Constraints),
    append(Constraints, Sizes),
    chains_between(Shrunk, Corners, Gap, W, H, _, _, _, Between),
    append(Sizes, Between, All),
    \+ ( {W >= 0, H >= 0, W =< 2*H, H =< 2*W}, posted(All) ).

shrunk(r(Side,W,D,Door,stays(A,B)), r(Side,W,D,Door,stays(A,B)), []) :- !.
shrunk(r(Side,Least,_,_,free), r(Side,W,1,Door,free), [(Least =< W)-[], (0 =< Door)-[], (Door+DoorWidth =< W)-[]]) :-
    length_of(door_width, DoorWidth).
