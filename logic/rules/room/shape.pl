:- module(shape, [one_door/2, door_entrance/2, stretch_names/2, stretch_wall/2, counted/2, walls_with_doors/2, wall_doors/3,
                  wall_size/3, wall_span/4, meeting/6, neighbour/4, corner_atom/3, hand/3, space_at/3]).

/** <module> The stretches of wall that a room's doors leave

Doors are doors(Front,Left,Back,Right), as in records.pl. A wall without doors is one stretch. Doors part the front wall
into front_left, between(front,I) and front_right, and the others alike. Each is counted from its corner.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module('../language/lengths').
:- use_module(reasons).
:- use_module(record_access).
:- use_module(records).

%!  one_door(?Entrance, -Doors) is det.
%
%   Doors are those of a room that has its entrance alone, as wide as the grammar's doors.

one_door(Entrance, doors([door(Entrance,Width,[length(door_width)])],[],[],[])) :- phrase(required(door_width, Width), _).

%!  door_entrance(+Doors, -Start) is det.
%
%   Start is that of the first door in the front wall.

door_entrance(doors([door(Start,_,_)|_],_,_,_), Start).

%!  stretch_names(+Doors, -Names) is det.

stretch_names(doors([_],[],[],[]), [front_left,left,back,right,front_right]) :- !.
stretch_names(doors([_|Front],Left,Back,Right), Names) :-
    phrase(( [front_left], between_doors(Front, front, 1),
             wall_names(Left, left, left_front, left_back),
             wall_names(Back, back, back_left, back_right),
             wall_names(Right, right, right_front, right_back), [front_right] ), Names).

wall_names([], Wall, _, _)            --> [Wall].
wall_names([_|Ds], Wall, First, Last) --> [First], between_doors(Ds, Wall, 1), [Last].

between_doors([], _, _)        --> [].
between_doors([_|Ds], Wall, I) --> [between(Wall,I)], { I1 is I + 1 }, between_doors(Ds, Wall, I1).

%!  stretch_wall(+Name, -Wall) is det.

stretch_wall(front_left,  front).
stretch_wall(front_right, front).
stretch_wall(left,        left).
stretch_wall(left_front,  left).
stretch_wall(left_back,   left).
stretch_wall(back,        back).
stretch_wall(back_left,   back).
stretch_wall(back_right,  back).
stretch_wall(right,       right).
stretch_wall(right_front, right).
stretch_wall(right_back,  right).
stretch_wall(between(Wall,_), Wall).

%!  counted(+Name, -Way) is det.
%
%   Way is along, or against where a stretch is counted from the right or from the back.

counted(Name, Way) :- ( backwards(Name) -> Way = against ; Way = along ).

backwards(front_right).
backwards(left_back).
backwards(back_right).
backwards(right_back).

%!  wall_doors(+Wall, +Doors, -List) is det.

wall_doors(front, doors(List,_,_,_), List).
wall_doors(left,  doors(_,List,_,_), List).
wall_doors(back,  doors(_,_,List,_), List).
wall_doors(right, doors(_,_,_,List), List).

%!  walls_with_doors(+Doors, -Pairs) is det.
%
%   Pairs are Wall-List of the walls that have doors.

walls_with_doors(doors(Front,[],[],[]), [front-Front]) :- !.
walls_with_doors(doors(Front,Left,Back,Right), Pairs) :-
    exclude(without_doors, [front-Front,left-Left,back-Back,right-Right], Pairs).

without_doors(_-[]).

%!  wall_size(+Wall, +Room, -Size) is det.

wall_size(front, Room, W) :- room_width(Room, W).
wall_size(left,  Room, D) :- room_depth(Room, D).
wall_size(back,  Room, W) :- room_width(Room, W).
wall_size(right, Room, D) :- room_depth(Room, D).

%!  wall_span(+Wall, +Room, -Low, -High) is det.
%
%   Along the wall the core lies Low..High.

wall_span(front, Room, X1, X2) :- room_core(Room, core(X1,X2,_,_)).
wall_span(left,  Room, Y1, Y2) :- room_core(Room, core(_,_,Y1,Y2)).
wall_span(back,  Room, X1, X2) :- room_core(Room, core(X1,X2,_,_)).
wall_span(right, Room, Y1, Y2) :- room_core(Room, core(_,_,Y1,Y2)).

%!  meeting(+Name, +Hand, +Chains, -Other, -Owned, -Open) is semidet.
%
%   This end of the stretch meets that of the Other, a Name-Hand, where Chains are the room's stretches, Name-Links. Owned
%   and Open are the atoms of stage 1 that say that the corner is the other's, or that nothing stands in it.

meeting(Name, Hand, Chains, Other-OtherHand, Owned, Open) :-
    corner_end(Name, Hand, Order, Open, Others),
    member(Other-OtherHand, Others),
    memberchk(Other-_, Chains), !,
    owned(Order, Name, Other, Owned).

owned(first,  Name, Other, corner(Name,Other,Other)).
owned(second, Name, Other, corner(Other,Name,Other)).

%   corner_end(?Name, ?Hand, -Order, -Open, -Others): this end of the stretch is the first or second at the corner, where one
%   of the Others may end.

corner_end(front_left,  near, first,  open(front,left),  [left-near,left_front-near]).
corner_end(left,        near, second, open(front,left),  [front_left-near]).
corner_end(left,        far,  first,  open(left,back),   [back-near,back_left-near]).
corner_end(left_front,  near, second, open(front,left),  [front_left-near]).
corner_end(left_back,   near, first,  open(left,back),   [back-near,back_left-near]).
corner_end(back,        near, second, open(left,back),   [left-far,left_back-near]).
corner_end(back,        far,  first,  open(back,right),  [right-far,right_back-near]).
corner_end(back_left,   near, second, open(left,back),   [left-far,left_back-near]).
corner_end(back_right,  near, first,  open(back,right),  [right-far,right_back-near]).
corner_end(right,       near, first,  open(right,front), [front_right-near]).
corner_end(right,       far,  second, open(back,right),  [back-far,back_right-near]).
corner_end(right_front, near, first,  open(right,front), [front_right-near]).
corner_end(right_back,  near, second, open(back,right),  [back-far,back_right-near]).
corner_end(front_right, near, second, open(right,front), [right-near,right_front-near]).

%!  neighbour(+Wall, -First, -Last, -Opposite) is det.
%
%   The walls where this one begins and ends, and the one across the room.

neighbour(front, left,  right, back).
neighbour(left,  front, back,  right).
neighbour(back,  left,  right, front).
neighbour(right, front, back,  left).

%!  corner_atom(+Wall, +Next, -Open) is det.
%
%   Open is the atom of stage 1 that says that nothing stands in the corner of these walls.

corner_atom(V, W, Open) :- ( next_wall(V, W) -> Open = open(V,W) ; Open = open(W,V) ).

next_wall(front, left).
next_wall(left,  back).
next_wall(back,  right).
next_wall(right, front).

%!  hand(+Hand, -Side, -Gap) is det.
%
%   A companion at this Hand of a piece stands at this Side of it, a Gap away.

hand(away(Side), Side, Gap) :- !, length_of(passage, Gap).
hand(Side, Side, 0).

%!  space_at(+Side, +Seats, -Space) is semidet.
%
%   A seat of an island takes Space, an expression, at this Side.

space_at(Side, Seats, Space) :-
    (   memberchk(seat(Side,item(_,_,Space,_)), Seats)
    ->  true
    ;   memberchk(seat(away(Side),item(_,_,Depth,_)), Seats), length_of(passage, P), Space = Depth+P ).
