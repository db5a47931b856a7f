:- module(opposite, [wishes/4]).

/** <module> Pieces that stand opposite others, as far as the rest of the room lets them

Where all sizes are known, the block of such a piece has a wish(Start) among its bounds: no constraint, but the place that is taken
where the gaps between the pieces of its stretch allow it (chain.pl).
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(record_access).
:- use_module(records).
:- use_module(shape).

%!  wishes(+Layout, +Room, +Stretches, -Wishing) is det.
%
%   Wishing are the Stretches of a Room, with the wishes that the opposite/4 atoms of Layout make.

wishes(Layout, Room, Stretches, Wishing) :-
    findall(opposite(F,K,G,J), member(opposite(F,K,G,J), Layout), Atoms),
    foldl(wish(Room, Stretches), Atoms, Stretches, Wishing).

wish(Room, Stretches, opposite(F,K,G,J), Stretches0, Wishing) :-
    (   member(stretch(Name,_,_), Stretches0),
        stretch_wall(Name, Wall), axis(Wall, Axis),
        middle_of(G-J, Axis, Room, Stretches, Middle),
        append(Before, [stretch(Name,Links,Blocks)|After], Stretches0),
        in_block(Links, Blocks, none, 0, F-K, Block, Along)
    ->  wall_size(Wall, Room, Size),
        ( counted(Name, along) -> Start = Middle - Along ; Start = Size - Middle - Along ),
        maplist(with_wish(Block, Start), Blocks, Blocks1),
        append(Before, [stretch(Name,Links,Blocks1)|After], Wishing)
    ;   Wishing = Stretches0 ).

with_wish(Block, Start, Block0, Block1) :-
    (   Block0 == Block
    ->  Block = block(S,L,Bounds,Why), append(Bounds, [wish(Start)-[]], Bounds1), Block1 = block(S,L,Bounds1,Why)
    ;   Block1 = Block0 ).

axis(front, x).  axis(back, x).  axis(left, y).  axis(right, y).

%   middle_of(+Piece, +Axis, +Room, +Stretches, -Middle) is semidet: the middle of a piece that stands along this axis or in the middle of
%   the room, from the left or from the front.

middle_of(Piece, Axis, Room, Stretches, Middle) :-
    member(stretch(Name,Links,Blocks), Stretches),
    in_block(Links, Blocks, none, 0, Piece, block(S,_,_,_), Along), !,
    stretch_wall(Name, Wall), axis(Wall, Axis), wall_size(Wall, Room, Size),
    ( counted(Name, along) -> Middle = S + Along ; Middle = Size - S - Along ).
middle_of(F-K, Axis, Room, _, Start + Before + Size/2) :-
    room_islands(Room, Islands),
    member(Island, Islands),
    island_xblock(Island, block(X,_,[_-[on(F,K,_,_)|_]|_],_)), !,
    island_yblock(Island, block(Y,_,_,_)), island_across(Island, Across), island_inwards(Island, Inwards), island_seats(Island, Seats),
    (   Axis == x
    ->  Start = X, Size = Across, Side = left
    ;   Start = Y, Size = Inwards, Side = outwards ),
    ( space_at(Side, Seats, Before) -> true ; Before = 0 ).

%   in_block(+Links, +Blocks, +Current, +Offset, +Piece, -Block, -Along) is semidet: the middle of the piece lies Along from the start of
%   its Block.

in_block([Link|Links], Blocks0, Current, Offset0, F-K, Block, Middle) :-
    link_gap(Link, Gap), link_along(Link, Along), link_role(Link, Role), link_item(Link, item(G,_,_,_)),
    (   ( Gap = apart-_ ; Current == none )
    ->  Blocks0 = [Own|Blocks], Offset = 0
    ;   Own = Current, Blocks = Blocks0, Offset = Offset0 ),
    (   Role-G == piece(K)-F
    ->  Block = Own, Middle = Offset + Along/2
    ;   in_block(Links, Blocks, Own, Offset + Along, F-K, Block, Middle) ).
