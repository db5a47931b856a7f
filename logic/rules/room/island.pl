:- module(island, [island/4, strips/3, in_line/2, narrowest_strip/1, island_constraints//4, all_seats_constraints//1, island_chains/4,
                   even_chains/3, island_items/2]).

/** <module> What stands in the middle of a room: islands in one row, a passage from each other and from the core's edge

Several rows are parallel, a passage apart. Each is a strip, along whose edge its islands stand. Rows that are even have as
many islands each, in line from row to row, and equal distances both ways.
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(lists)).
:- use_module('../linear/chain').
:- use_module('../language/lengths').
:- use_module(reasons).
:- use_module(record_access).
:- use_module(records).
:- use_module(shape).

%!  island(+Layout, +Room, +On, -Island) is det.
%
%   Island is the piece of this on/4 atom with its seats.

island(Layout, Room, On, Island) :-
    On = on(F,_,Place,N),
    make_island([item(item(F,L,D,W-Depth)),across(Across),inwards(Inwards),xblock(block(_,FullAcross,XBounds,Apart)),
                 yblock(block(_,FullInwards,YBounds,Apart)),seats(Seats),front(Front)], Island),
    room_width(Room, W), room_depth(Room, Depth),
    phrase(island_reasons(On, Layout, Front, With), Why),
    ( memberchk(Front, [left,right]) -> Across = D, Inwards = L ; Across = L, Inwards = D ),
    maplist(seat_of(W-Depth), With, Seats),
    with_seats(Across, left, right, Seats, FullAcross),
    with_seats(Inwards, outwards, inwards, Seats, FullInwards),
    room_core(Room, core(X1,X2,Y1,Y2)),
    length_of(passage, P), length_of(door_clearance, C),
    room_doors(Room, doors(_,Left,Back,Right)),
    clear_of(Left, at_least(C)-[On,length(door_clearance)], XMore, XMore1),
    clear_of(Right, at_most(W-C-FullAcross)-[On,length(door_clearance)], XMore1, []),
    clear_of(Back, at_most(Depth-C-FullInwards)-[On,length(door_clearance)], YMore, []),
    XBounds = [at_least(X1+P)-Why, at_most(X2-P-FullAcross)-Why|XMore],
    YBounds = [at_least(Y1+P)-Why, at_least(C)-[On,length(door_clearance)], at_most(Y2-P-FullInwards)-Why|YMore],
    room_row(Room, Row),
    N0 is N - 1,
    phrase(after(Place, N0, Row, Layout), Apart, Why).

%   clear_of(+Doors, +Bound, -Bounds, -Others): the Bound is one of them where a wall has doors.

clear_of([], _, Bounds, Bounds).
clear_of([_|_], Bound, [Bound|Bounds], Bounds).

island_reasons(On, Layout, Front, With) -->
    { On = on(F,K,_,_),
      findall(with(F,K,G,Hand), member(with(F,K,G,Hand), Layout), With) },
    [On,length(passage)],
    ( holds(faces(F,K,Front), Layout) -> [] ; { Front = none } ),
    ( holds(even_row, Layout) -> [] ; [] ),
    because(With).

after(Place, N, Row, Layout) --> ( holds(on(_,_,Place,N), Layout) -> [row(Row)] ; [] ).

seat_of(Walls, with(_,_,G,Hand), seat(Hand,item(G,_,_,Walls))).

%   with_seats(+Size, +Low, +High, +Seats, -Full): Full is a size of the island with the seats at these two hands.

with_seats(Size, Low, High, Seats, Full) :-
    ( space_at(Low, Seats, A)  -> Full1 = A+Size ; Full1 = Size ),
    ( space_at(High, Seats, B) -> Full = Full1+B ; Full = Full1 ).

%!  strips(+Rows, +Way, -Strips) is det.
%
%   Rows are the islands of each row. Where there are several, they are Strips, whose islands start at the same place.

strips([], _, []).
strips([_], _, []) :- !.
strips([Row|Rows], Way, Strips) :- maplist(strip(Way), [Row|Rows], Strips).

strip(Way, Islands, strip(block(Start,_,Bounds,[row(Way)]),Islands,Depths)) :-
    maplist(across_row(Way), Islands, Blocks),
    maplist(at_edge(Start), Blocks, All, Depths),
    append(All, Bounds).

across_row(across, Island, Block)  :- island_yblock(Island, Block).
across_row(inwards, Island, Block) :- island_xblock(Island, Block).

at_edge(Start, block(Start,Depth,Bounds,_), Bounds, Depth-Why) :- Bounds = [_-Why|_].

%!  in_line(?Strips, +Way) is det.
%
%   The islands that have the same number in their rows start at the same place.

in_line([], _).
in_line([strip(_,Islands,_)|Strips], Way) :-
    maplist(along_row(Way), Islands, Blocks),
    maplist(block_start, Blocks, Starts),
    maplist(starts_along(Way, Starts), Strips).

starts_along(Way, Starts, strip(_,Islands,_)) :-
    maplist(along_row(Way), Islands, Blocks),
    maplist(block_start, Blocks, Starts).

block_start(block(Start,_,_,_), Start).

%!  narrowest_strip(?Strip) is det: where the sizes are known, it is as deep as the deepest of its islands.

narrowest_strip(strip(block(_,Depth,_,_),_,Depths)) :- foldl(deeper, Depths, 0, Depth).

deeper(Own-_, Depth0, Depth) :- Depth is max(Depth0, Own).

%!  island_constraints(+Islands, +Strips, +Row, +Even)// describes the constraints of the islands, see linear.pl.

island_constraints(Islands, Strips, Row, Even) -->
    { length_of(passage, P), island_chains(Islands, Strips, Row, Chains) },
    all_chains_constraints(Chains, P),
    ( { Even == yes } -> all_even_constraints(Chains) ; [] ),
    within_strips(Strips),
    all_seats_constraints(Islands).

within_strips([]) --> [].
within_strips([strip(block(_,Strip,_,_),_,Depths)|Strips]) --> within_strip(Depths, Strip), within_strips(Strips).

within_strip([], _) --> [].
within_strip([Depth-Why|Depths], Strip) --> [(Depth =< Strip)-Why], within_strip(Depths, Strip).

%!  island_chains(+Islands, +Strips, +Row, -Chains) is det.
%
%   Chains are the row of islands one way, across or inwards, and each island alone the other way; or each of several rows one
%   way, and their strips the other way.

island_chains([], _, _, []) :- !.
island_chains(Islands, [], Row, [Chain|Singles]) :- !, row_chains(Row, Islands, Chain, Singles).
island_chains(_, Strips, Row, [Edges|Chains]) :-
    maplist(strip_edge, Strips, Edges),
    maplist(strip_chain(Row), Strips, Chains).

strip_edge(strip(Block,_,_), Block).

strip_chain(Row, strip(_,Islands,_), Chain) :- maplist(along_row(Row), Islands, Chain).

along_row(across, Island, Block)  :- island_xblock(Island, Block).
along_row(inwards, Island, Block) :- island_yblock(Island, Block).

%!  even_chains(+Even, +Chains, -Places) is det.
%
%   Places are the chains by which the places of the islands are sampled: where they are even, one each way, whose blocks are
%   as long as the longest of those in line.

even_chains(no, Chains, Chains).
even_chains(yes, [], []).
even_chains(yes, [Chain|Chains], Places) :-
    (   maplist(single, Chains)            % one row, and each of its islands the other way
    ->  Places = [even(Chain)|Chains]
    ;   foldl(longest, Chains, [], Columns),
        Places = [even(Chain),even(Columns)] ).

single([_]).

longest(Chain, [], Chain) :- !.
longest(Chain, Columns0, Columns) :- maplist(longer_block, Chain, Columns0, Columns).

longer_block(block(S,L1,Bounds1,Apart), block(S,L2,Bounds2,_), block(S,max(L1,L2),Bounds,Apart)) :- append(Bounds1, Bounds2, Bounds).

row_chains(across, Islands, Chain, Singles) :-
    maplist(island_xblock, Islands, Chain),
    maplist(single_yblock, Islands, Singles).
row_chains(inwards, Islands, Chain, Singles) :-
    maplist(island_yblock, Islands, Chain),
    maplist(single_xblock, Islands, Singles).

single_xblock(Island, [Block]) :- island_xblock(Island, Block).

single_yblock(Island, [Block]) :- island_yblock(Island, Block).

all_seats_constraints([]) --> [].
all_seats_constraints([Island|Islands]) -->
    { island_seats(Island, Seats), island_xblock(Island, block(_,_,[_-Why|_],_)) },
    seats_constraints(Seats, Island, Why),
    all_seats_constraints(Islands).

%   A seat is no longer than the side at which it stands.

seats_constraints([], _, _) --> [].
seats_constraints([seat(Hand,item(_,Length,_,_))|Seats], Island, Why) -->
    { hand(Hand, At, _), ( memberchk(At, [left,right]) -> island_inwards(Island, Side) ; island_across(Island, Side) ) },
    [(Length =< Side)-Why],
    seats_constraints(Seats, Island, Why).

%!  island_items(+Island, -Items) is det.
%
%   Items are free-Item, of the island and its seats.

island_items(Island, [free-Item|Items]) :-
    island_item(Island, Item), island_seats(Island, Seats),
    maplist(seat_item, Seats, Items).

seat_item(seat(_,Item), free-Item).
