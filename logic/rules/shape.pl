:- module(shape, [one_door/2, door_entrance/2, stretch_names/2, stretch_wall/2, wall_doors/3, meeting/6, neighbour/4, corner_atom/3, counted/2]).

/** <module> The stretches of wall that a room's doors leave

Doors are doors(Front,Left,Back,Right), as in records.pl. A wall without doors is one stretch. Doors part the front wall
into front_left, between(front,I) and front_right, and the others alike. Each is counted from its corner.
*/

:- use_module(library(lists)).
:- use_module(reasons).

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
stretch_names(doors(Front,Left,Back,Right), Names) :-
    phrase(( [front_left], between_doors(Front, front, 1),
             wall_names(Left, left, left_front, left_back),
             wall_names(Back, back, back_left, back_right),
             wall_names(Right, right, right_front, right_back), [front_right] ), Names).

wall_names([], Wall, _, _)            --> [Wall].
wall_names([D|Ds], Wall, First, Last) --> [First], between_doors([D|Ds], Wall, 1), [Last].

between_doors([_], _, _)       --> [].
between_doors([_,D|Ds], Wall, I) --> [between(Wall,I)], { I1 is I + 1 }, between_doors([D|Ds], Wall, I1).

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

counted(Name, Way) :- ( memberchk(Name, [front_right,left_back,back_right,right_back]) -> Way = against ; Way = along ).

%!  wall_doors(+Wall, +Doors, -List) is det.

wall_doors(front, doors(List,_,_,_), List).
wall_doors(left,  doors(_,List,_,_), List).
wall_doors(back,  doors(_,_,List,_), List).
wall_doors(right, doors(_,_,_,List), List).

%!  meeting(+Name, +Hand, +Chains, -Other, -Owned, -Open) is semidet.
%
%   This end of the stretch meets that of the Other, a Name-Hand, where Chains are the room's stretches, Name-Links. Owned
%   and Open are the atoms of stage 1 that say that the corner is the other's, or that nothing stands in it.

meeting(Name, Hand, Chains, Other-OtherHand, Owned, open(V,W)) :-
    corner_end(Name, Hand, V-W, Order),
    ( Order = first -> Owned = corner(Name,Other,Other) ; Owned = corner(Other,Name,Other) ),
    other(Order, OtherOrder),
    corner_end(Other, OtherHand, V-W, OtherOrder),
    memberchk(Other-_, Chains), !.

other(first, second).
other(second, first).

corner_end(front_left,  near, front-left, first).
corner_end(left,        near, front-left, second).
corner_end(left_front,  near, front-left, second).
corner_end(left,        far,  left-back,  first).
corner_end(left_back,   near, left-back,  first).
corner_end(back,        near, left-back,  second).
corner_end(back_left,   near, left-back,  second).
corner_end(back,        far,  back-right, first).
corner_end(back_right,  near, back-right, first).
corner_end(right,       far,  back-right, second).
corner_end(right_back,  near, back-right, second).
corner_end(right,       near, right-front,first).
corner_end(right_front, near, right-front,first).
corner_end(front_right, near, right-front,second).

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
