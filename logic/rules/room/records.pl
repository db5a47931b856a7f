:- module(records, [make_room/2, room_type/2, room_width/2, room_depth/2, room_door/2, room_doors/2, room_open/2, room_busy/2, room_core/2, room_stretches/2,
                    room_row/2, room_even/2, room_islands/2, room_strips/2, is_room/1,
                    make_link/2, link_gap/2, link_role/2, link_item/2, link_along/2, link_out/2, link_front/2, link_seat/2, link_why/2,
                    make_island/2, island_item/2, island_across/2, island_inwards/2, island_xblock/2, island_yblock/2,
                    island_seats/2, island_front/2]).

/** <module> What a room consists of, in its own frame: the door on the front wall, x to the right and y inwards

Lengths are unbound until they are solved for. Beside the records:

    core(X1,X2,Y1,Y2)               the free rectangle of a room
    busy(Front,Left,Back,Right)     a stretch of each wall at which furniture stands, or none
    doors(Front,Left,Back,Right)    the doors of each wall: door(Start,Width,Why) from the left, or from the front
    stretch(Name,Links,Blocks)      a stretch of wall: Blocks are a chain (chain.pl) of the Links that are joined
    item(Type,Length,Depth,Walls)   what has a size by piece_size/4, in a room of these Walls (lengths.pl)
    strip(Block,Islands,Depths)     one of several rows of islands, which start at its edge: a Depth-Why of each
    seat(Hand,Item)                 at an island: left, right, outwards or inwards of it, or away(left) and so on
    Value-Why                       a value and its reasons, see reasons.pl
*/

:- use_module(library(record)).
:- use_module(record_access).

% A room with its furniture. Its entrance starts at `door`; nothing stands in its `open` corners, atoms of stage 1; its
% islands stand in one row, across or inwards, or in several, each in a strip; where they are `even`, yes or no, at equal
% distances, and in line from row to row.
:- record room(type, width, depth, door, core, stretches, row, even, islands, strips, doors, open, busy).

% A piece along a wall, or its companion. `gap` is joined-Why or apart-Why, to what is before it; `role` is piece(K) or
% with(Type-K). It takes `along` of the wall, stands `out` from it, and its front faces out, near or far. In front of it is a
% `seat`: with(Type,K,Companion,Hand)-Item, its Hand front or away(front), or none.
:- record link(gap, role, item, along, out, front, seat, why).

% A piece in the middle of the room, as large as `across` and `inwards`; with its seats it is a block each way.
:- record island(item, across, inwards, xblock, yblock, seats, front).
