:- module(filled, [filled_law/3]).

/** <module> How long the walls of a room can be where furniture fills them from end to end

Such a wall is as long as its pieces and what stands in its corners, so its length is sampled between the least and the
greatest of these. In a longer or shorter room every try would fail.
*/

:- use_module(library(apply)).
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module(record_access).
:- use_module(records).
:- use_module(room).
:- use_module(stretch).

%!  filled_law(+Room, +Law0, -Law) is semidet.
%
%   Law is that part of a box (laws.pl) of the room's sizes in which its filled walls can be filled; fails where there is
%   none. Other laws stay as they are, and all laws on a grid, where a room takes few sizes anyway. The front wall is never
%   filled: the door is there.

filled_law(Room, box(A1,A2,B1,B2), box(A3,A4,B3,B4)) :-
    lattice(real), !,
    room_width(Room, W), room_depth(Room, D), room_stretches(Room, [_,Left,Back,Right,_]),
    filled_range(Back, W, Room, A1-A2, A3-A4),
    filled_range(Left, D, Room, B1-B2, Range),
    filled_range(Right, D, Room, Range, B3-B4).
filled_law(_, Law, Law).

filled_range(Stretch, Wall, Room, Low0-High0, Low-High) :-
    filled_between(Stretch, Start, Last), !,
    filled_length(least, Wall, Last-Start, Room, Least),
    filled_length(greatest, Wall, Last-Start, Room, Greatest),
    Low is max(Low0, Least), High is min(High0, Greatest),
    Low =< High.
filled_range(_, _, _, Range, Range).

%   filled_length(+Extreme, +Wall, +Rest, +Room, -Metres): Rest is the Wall's length less all that fills it.

filled_length(Extreme, Wall, Rest, Room, Metres) :-
    room_type(Room, Type), room_items(Room, Items0),
    copy_term(Wall-Rest-Items0, 0-Less-Items),
    maplist(extreme_item(Extreme, Type), Items),
    Metres is -Less.

extreme_item(least, Type, _-item(F,L,D,_))    :- piece_extent(Type, F, L-_, D-_).
extreme_item(greatest, Type, _-item(F,L,D,_)) :- piece_extent(Type, F, _-L, _-D).
