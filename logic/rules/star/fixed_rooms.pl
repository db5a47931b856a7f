:- module(fixed_rooms, [main_room_between//5, areas_between/3, infeasible_between/2]).

/** <module> The main room between rooms of another house that stay where they are */

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module('../linear/chain').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module(main_room).
:- use_module('../linear/sample').

%!  main_room_between(+Rooms, +Corners, -Main, -Corner, -Starts)// is semidet.
%
%   As main_room_around//4, with fixed rooms: Corner is at(West,North), where the main room's north-west corner is. Fails
%   where the rooms, of just these sizes, do not fit between the fixed ones. The main room is as small as that allows, and the
%   area of the whole house.

main_room_between(Rooms, Corners, main(W,H), at(West,North), Starts) -->
    { rooms_gap(Gap),
      outline_system(Rooms, Corners, box(West,North,W,H), Chains, Constraints) },
    own_box_sample(Constraints, Rooms, box(West,North,W,H)),
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

%!  areas_between(+Rooms, +Corners, -Areas) is semidet.
%
%   Areas are Low-High: no main room between these rooms has another one. Fails where there is none.

areas_between(Rooms, Corners, Low-High) :-
    outline_system(Rooms, Corners, box(_,_,W,H), _, Constraints),
    largest(Rooms, Largest),
    findall(W0-H0-Most,
            ( within_a_half(W, H), posted(Constraints), inf(W, W0), inf(H, H0),
              ( sup(W, W1), sup(H, H1) -> Most is W1*H1 ; Most is 1.0e15 ) ),
            [LeastW-LeastH-High]),
    least_area(Largest, LeastW-LeastH, Low).

within_a_half(W, H) :- {W >= 0, H >= 0, W =< 2*H, H =< 2*W}.

%   own_box_sample(+Constraints, +Rooms, -Box)//: the store ends with it; Box is numbers.

own_box_sample(Constraints, Rooms, Box, S0, S) :-
    findall(Box-S1, box_sample(Constraints, Rooms, Box, S0, S1), [Box-S|_]).

box_sample(Constraints, Rooms, box(West,North,W,H)) -->
    { largest(Rooms, Largest),
      area_left(Rooms, From-To),
      Area is max(Largest, From), Area - 1.0e-9 =< To,
      within_a_half(W, H), posted(Constraints),
      inf(W, W0), inf(H, H0),
      Least is max(Area, W0*H0), Side is sqrt(2*Least), Narrow is sqrt(Area/2),
      {W >= Narrow, H >= Narrow}, at_most(To, W*H0), at_most(To, H*W0) },
    size_sample(W, Side),
    { Low is Area/W, {H >= Low}, at_most(To, H*W), High is 2*Least/W },
    size_sample(H, High),
    place_sample(West), place_sample(North).

at_most(Most, _)       :- Most =:= inf, !.
at_most(Most, Product) :- {Product =< Most}.

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
    \+ ( within_a_half(W, H), posted(All) ).

narrowed(Room, Room, []) :- Room = outline(_,_,_,_,fixed(_,_)), !.
narrowed(outline(Side,Least,_,_,free), outline(Side,W,1,Door,free),
         [(Least =< W)-[], (0 =< Door)-[], (Door+DoorWidth =< W)-[]]) :-
    length_of(door_width, DoorWidth).
