:- module(openings, [all_openings//2, plan_openings//3, window_walls/3, window_range/4, segment/5, start_range/4, joint_sample//7, side_axis/2, span/6, joins/2, outer_way/3, beyond_outline/1, outer_margin/2]).

/** <module> Doors, windows and the entrance of a plan: room for them in its walls, and then their places

A door joins two rooms in the wall that they share, or a room and the outside. Each door and window takes a part of a wall
where no other room adjoins, so that no two overlap. Rooms are terms as in walls.pl. If walls have a thickness, a door or window lies
half the thickness of an inner wall away from the face of its room.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module('../language/grammar_files').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/sample').
:- use_module(opening_sizes).
:- use_module(swings).

:- table window_walls/3.

% - room for them ------------------------------------------------------------------------------------------------

%!  all_openings(+Atoms, +Rooms)// describes the constraints: both rooms reach past both ends of a door.

all_openings(Atoms, Rooms) -->
    { findall(A, ( member(A, Atoms), opening(A) ), Openings) },
    openings(Openings, Atoms, Rooms).

opening(door(_,_,_)).
opening(entrance(_,_)).
opening(garden(_,_)).
opening(window(_,_)).

openings([], _, _) --> [].
openings([Opening|Openings], Atoms, Rooms) -->
    opening_constraints(Opening, Atoms, Rooms),
    openings(Openings, Atoms, Rooms).

opening_constraints(door(R,Q,Line), Atoms, Rooms) -->
    { memberchk(room(R,T,SidesR,EdgesR), Rooms), memberchk(room(Q,U,SidesQ,EdgesQ), Rooms),
      line_axis(Line, EdgesR, Axis),
      span(Axis, SidesR, EdgesR, A1, A2, WhyR), span(Axis, SidesQ, EdgesQ, B1, B2, WhyQ),
      door_reasons(door(R,Q,Line), Atoms, EdgesR, EdgesQ, Door),
      door_width_of(T, U, Width, Clause), length_of(door_margin, Margin), W is Width + 2*Margin,
      ( Clause = length(_) -> Types = [] ; Types = [room(R,T),room(Q,U)] ),
      append([[Clause,length(door_margin)|Door],Types,WhyR,WhyQ], Why) },
    [(A1+W =< A2)-Why, (B1+W =< B2)-Why, (A1+W =< B2)-Why, (B1+W =< A2)-Why],
    (   { memberchk(open_to(R,Q), Atoms), \+ memberchk(part_of(R,Q), Atoms) }
    ->  { opening_wall(T, U, L, Clauses), append([[open_to(R,Q),room(R,T),room(Q,U)|Door],Clauses,WhyR,WhyQ], All) },
        [(A1+L =< A2)-All, (B1+L =< B2)-All, (A1+L =< B2)-All, (B1+L =< A2)-All]
    ;   [] ).
opening_constraints(Way, Atoms, Rooms) -->
    { outer_way(Way, R, Side), outer_wall(R, Side, Atoms, Rooms, Type, Starts, Ends),
      door_width_of(Type, outside, Width, Clause), outer_margin(door_margin, Margin), W is Width + 2*Margin,
      ( Clause = length(_) -> Types = [] ; Types = [room(R,Type)] ) },
    reaching(Starts, Ends, W, [Way,Clause,length(door_margin)|Types]).
opening_constraints(window(R,Side), Atoms, Rooms) -->
    { outer_wall(R, Side, Atoms, Rooms, Type, Starts, Ends), window_walls(Type, Least, Most),
      Why = [window(R,Side),room(R,Type),window_size(Type),length(window_margin)] },
    reaching(Starts, Ends, Least, Why),
    ( { Most == any }
    ->  []
    ;   { Starts = [A1-WhyA|_], Ends = [A2-_|_], append(Why, WhyA, All) },     % the whole side, so any part of it too
        [(A2 =< A1+Most)-All] ).

%   door_reasons(+Door, +Atoms, +EdgesR, +EdgesQ, -Reasons): with a brief, the direction of the door is not a reason, so that a
%   refutation of a layout holds for both directions.

door_reasons(Door, Atoms, _, _, [Door]) :- \+ memberchk(granted(_), Atoms), !.
door_reasons(door(R,Q,Line), _, EdgesR, EdgesQ, [linked(First,Second),R1,Q1]) :-
    First is min(R, Q), Second is max(R, Q),
    arg(_, EdgesR, R1), R1 = edge(_,_,Line0), Line0 == Line,
    arg(_, EdgesQ, Q1), Q1 = edge(_,_,Line1), Line1 == Line, !.

%   reaching(+Starts, +Ends, +W, +Why)//: between each of the Starts and each of the Ends is room for W.

reaching([], _, _, _) --> [].
reaching([Start|Starts], Ends, W, Why) --> reaching_from(Ends, Start, W, Why), reaching(Starts, Ends, W, Why).

reaching_from([], _, _, _) --> [].
reaching_from([B-WhyB|Ends], A-WhyA, W, Why) -->
    { append([Why,WhyA,WhyB], All) },
    [(A+W =< B)-All],
    reaching_from(Ends, A-WhyA, W, Why).

%   line_axis(+Line, +Edges, -Axis): a wall on this line of the room runs along the Axis.

line_axis(Line, edges(edge(_,_,West),edge(_,_,East),_,_), Axis) :- ( ( Line == West ; Line == East ) -> Axis = y ; Axis = x ).

span(x, sides(X1,X2,_,_), edges(West,East,_,_), X1, X2, [West,East]).
span(y, sides(_,_,Y1,Y2), edges(_,_,North,South), Y1, Y2, [North,South]).

%   outer_wall(+Room, +Side, +Atoms, +Rooms, -Type, -Starts, -Ends): an opening in this side of the room lies after all Starts and
%   before all Ends, each a Place-Why. They are the ends of the side, of the rooms beyond it (shared_walls/topology.lp), and of the
%   outdoor room that a window is towards.

outer_wall(R, Side, Atoms, Rooms, Type, [A1-Why|Starts], [A2-Why|Ends]) :-
    memberchk(room(R,Type,Sides,Edges), Rooms),
    side_axis(Side, Axis),
    span(Axis, Sides, Edges, A1, A2, Why),
    findall(beyond(R,Side,Q,How), member(beyond(R,Side,Q,How), Atoms), Beyond),
    foldl(room_beyond(Axis, Rooms), Beyond, []-[], Starts0-Ends0),
    (   memberchk(toward(R,Side,P), Atoms)
    ->  memberchk(room(P,_,SidesP,EdgesP), Rooms), span(Axis, SidesP, EdgesP, B1, B2, Lines), Toward = [toward(R,Side,P)|Lines],
        Starts = [B1-Toward|Starts0], Ends = [B2-Toward|Ends0]
    ;   Starts = Starts0, Ends = Ends0 ).

room_beyond(Axis, Rooms, beyond(R,Side,Q,How), Starts-Ends, More) :-
    memberchk(room(Q,_,Sides,Edges), Rooms),
    span(Axis, Sides, Edges, B1, B2, Lines),
    Why = [beyond(R,Side,Q,How)|Lines],
    length_of(outer_wall, Thick),
    (   Thick =:= 0
    ->  Start = B2, End = B1
    ;   Start = B2+Thick, End = B1-Thick ),
    ( How == before -> More = [Start-Why|Starts]-Ends ; More = Starts-[End-Why|Ends] ).

%!  outer_margin(+Name, -Margin) is det.
%
%   Margin is the least distance from a door or window in an outer wall to the ends of that wall. An outer wall of a neighbour may begin
%   at an end, and reach into this wall.

outer_margin(Name, Margin) :-
    length_of(Name, Stated), beyond_outline(Beyond),
    ( Beyond > Stated -> Margin = Beyond ; Margin = Stated ).

%!  beyond_outline(-Metres) is det.
%
%   Metres is the part of an outer wall's thickness that lies beyond the thickness of an inner wall.

beyond_outline(Beyond) :- maplist(length_of, [inner_wall,outer_wall], [Inner,Outer]), Beyond is Outer - Inner.

%   outer_part(+Room, +Side, +Atoms, +Rooms, -Type, -Start, -End): the part of the side that is left for the opening, after all
%   walls have places.

outer_part(R, Side, Atoms, Rooms, Type, Start, End) :-
    outer_wall(R, Side, Atoms, Rooms, Type, Starts, Ends),
    pairs_keys(Starts, As0), maplist(number_of, As0, As), max_list(As, Start),
    pairs_keys(Ends, Bs0), maplist(number_of, Bs0, Bs), min_list(Bs, End).

number_of(Expression, X) :- X is Expression.

side_axis(north, x).  side_axis(south, x).  side_axis(east, y).  side_axis(west, y).

%!  window_walls(+Type, -Least, -Most) is det.
%
%   An outer wall in which a room of this type has a window is Least to Most long. Most is `any` if the length has no upper bound. Without a
%   clause of window_size/3, Least is the sum of both margins.

window_walls(Type, Least, Most) :-
    outer_margin(window_margin, Margin),
    metres(Margin, M),
    (   \+ stated_for(window_size(Type,_,_))
    ->  Least is 2*Margin, Most = any
    ;   findall(L-H, ( grammar:window_size(Type, Length, Wall), {Length + 2*M =< Wall}, inf(Wall, L), most(Wall, H) ), [Low-High])
    ->  rounded_up(Low, First), least_wall(Type, Margin, First, Least),
        ( High == any -> Most = any ; in_unit(High, H1), inner_range(0-H1, _-Most) )
    ;   Least = 1, Most = 0 ).                      % no wall

most(X, High) :- ( sup(X, Sup) -> High = Sup ; High = any ).

%   On a grid, perhaps no window in the shortest wall is a whole number of cells long. Then Least is the shortest wall with such a window.

least_wall(Type, Margin, Wall, Least) :-
    on_grid,
    Most is Wall - 2*Margin,
    \+ ( window_lengths(Type, Wall, Most, Low-High), Low =< High ),
    room_extent(Type, _-W, _-D), Wall =< max(W, D), !,
    Longer is Wall + 1,
    least_wall(Type, Margin, Longer, Least).
least_wall(_, _, Least, Least).

% - their places -------------------------------------------------------------------------------------------------

%!  plan_openings(+Atoms, +Rooms, -Plan)// is det.
%
%   Plan is plan(Rooms,Doors,Windows) with room(R,Type,Box), door(Box,R,Q), where Q is a room or `outside`, or opening(Box,R,Q),
%   and window(Box,R).
%   A Box is box(X,Y,Width,Height); every wall is known.

plan_openings(Atoms, Rooms, plan(Boxes,Doors,Windows)) -->
    { thickness_known(Rooms), maplist(room_box, Rooms, Boxes),
      joins(Atoms, Joins), findall(window(R,S), member(window(R,S), Atoms), Panes) },
    clear_doors(doors_sample(Joins, Atoms, Rooms, []), Doors),
    windows_sample(Panes, Atoms, Rooms, Windows).

%   thickness_known(+Rooms): binds the thickness of inner walls, which was an unknown of the constraints.

thickness_known([room(_,_,sides(X,_,_,_),_)|_]) :- ( compound(X), X = _+T, var(T) -> length_of(inner_wall, T) ; true ).

room_box(room(R,T,sides(X1,X2,Y1,Y2),_), room(R,T,box(X,Y,W,H))) :- X is X1, Y is Y1, W is X2-X1, H is Y2-Y1.

%!  joins(+Atoms, -Doors) is det.
%
%   Doors has all doors of a layout, garden doors last. So the first door to the outside is the entrance.

joins(Atoms, Doors) :-
    findall(D, ( member(D, Atoms), ( D = door(_,_,_) ; D = entrance(_,_) ) ), Doors0),
    findall(garden(R,S), member(garden(R,S), Atoms), Gardens),
    append(Doors0, Gardens, Doors).

%!  outer_way(?Door, ?Room, ?Side) is semidet.
%
%   The Door leads outside by this side of the room.

outer_way(entrance(R,Side), R, Side).
outer_way(garden(R,Side),   R, Side).

%   doors_sample(+Joins, +Atoms, +Rooms, +Before, -Doors)//: the doors Before are already placed.

doors_sample([], _, _, _, []) --> [].
doors_sample([Join|Joins], Atoms, Rooms, Before, [Door|Doors]) -->
    door_sample(Join, Atoms, Rooms, Before, Door),
    doors_sample(Joins, Atoms, Rooms, [Door|Before], Doors).

door_sample(door(R,Q,Line), Atoms, Rooms, Before, Door) -->
    { memberchk(room(R,T,SidesR,EdgesR), Rooms), memberchk(room(Q,U,SidesQ,EdgesQ), Rooms),
      line_axis(Line, EdgesR, Axis),
      span(Axis, SidesR, EdgesR, A1, A2, _), span(Axis, SidesQ, EdgesQ, B1, B2, _),
      From is max(A1, B1), To is min(A2, B2),
      line_side(Line, EdgesR, Side), wall_place(Side, SidesR, At) },
    joint_sample(R-Q, Atoms, T-U, Axis-At, From-To, Before, Door).
door_sample(Way, Atoms, Rooms, Before, door(Box,R,outside)) -->
    { outer_way(Way, R, Side), outer_part(R, Side, Atoms, Rooms, Type, Start, End), door_width_of(Type, outside, Width, _), outer_margin(door_margin, Margin) },
    { wall_range(R, Side, Rooms, Start-End, Width, Margin, Axis-At, Range) },
    start_sample(Axis-At, Width, Range, Before, At0),
    { segment(Axis, At, At0, Width, Box) }.

%!  joint_sample(+Rooms, +Atoms, +Types, +Wall, +Part, +Before, -Door)// is det.
%
%   Door is the door between two rooms R-Q of these types, or opening(Box,R,Q) if they are open to each other. It lies in the Part From-To
%   of the Wall Axis-At that they share, and fills that Part if R is a part of Q. The doors Before are already placed.

joint_sample(R-Q, Atoms, _, Axis-At, From-To, _, opening(Box,R,Q)) -->
    { memberchk(part_of(R,Q), Atoms), !, Wall is To - From, segment(Axis, At, From, Wall, Box) }.
joint_sample(R-Q, Atoms, T-U, Axis-At, From-To, _, opening(Box,R,Q)) -->
    { memberchk(open_to(R,Q), Atoms), Wall is To - From, opening_range(T, U, Wall, Low-High), ! },
    interval_sample(Low, High, 1, Length),
    { Latest is To - Length },
    interval_sample(From, Latest, 1, Start),
    { segment(Axis, At, Start, Length, Box) }.
joint_sample(R-Q, _, T-U, Axis-At, From-To, Before, door(Box,R,Q)) -->
    { door_width_of(T, U, Width, _), length_of(door_margin, Margin), start_range(From-To, Width, Margin, Range) },
    start_sample(Axis-At, Width, Range, Before, Start),
    { segment(Axis, At, Start, Width, Box) }.

line_side(Line, edges(edge(_,_,W),edge(_,_,E),edge(_,_,N),_), Side) :-
    ( Line == W -> Side = west ; Line == E -> Side = east ; Line == N -> Side = north ; Side = south ).

%   wall_place(+Side, +Sides, -At): At is the centre line of an inner wall at this side.

wall_place(Side, Sides, At) :-
    side_place(Side, Sides, Way, Face), length_of(inner_wall, T),
    ( T =:= 0 -> At = Face ; At is Face + Way*T/2 ).

side_place(west,  sides(X,_,_,_), -1, X).
side_place(east,  sides(_,X,_,_),  1, X).
side_place(north, sides(_,_,Y,_), -1, Y).
side_place(south, sides(_,_,_,Y),  1, Y).

segment(x, Y, X, Length, box(X,Y,Length,0.0)).
segment(y, X, Y, Length, box(X,Y,0.0,Length)).

%   wall_range(+Room, +Side, +Rooms, +Part, +Length, +Margin, -Wall, -Range): where an opening of this Length starts along this Part of
%   the Wall Axis-At, at least Margin from its ends.

wall_range(R, Side, Rooms, Part, Length, Margin, Axis-At, Range) :-
    memberchk(room(R,_,Sides,_), Rooms), wall_place(Side, Sides, At), side_axis(Side, Axis),
    start_range(Part, Length, Margin, Range).

%!  start_range(+Part, +Length, +Margin, -Range) is det.
%
%   An opening of this Length may start within the Range, so that it is at least a Margin away from both ends of the Part of a wall.

start_range(From-To, Length, Margin, Low-High) :- Low is From + Margin, High is To - Length - Margin.

windows_sample([], _, _, []) --> [].
windows_sample([window(R,Side)|Panes], Atoms, Rooms, [window(Box,R)|Windows]) -->
    { outer_part(R, Side, Atoms, Rooms, Type, A1, A2),
      outer_margin(window_margin, Margin),
      Most is A2 - A1 - 2*Margin,
      window_range(Type, A1-A2, Most, Low-High) },
    interval_sample(Low, High, 1, Length),
    { wall_range(R, Side, Rooms, A1-A2, Length, Margin, Axis-At, First-Last) },
    interval_sample(First, Last, 1, Start),
    { segment(Axis, At, Start, Length, Box) },
    windows_sample(Panes, Atoms, Rooms, Windows).

%   window_range(+Type, +Wall, +Most, -Range): the lengths of a window in this wall, up to Most. Without a clause, the
%   length is Most.

window_range(Type, A1-A2, Most, Range) :- Wall is A2 - A1, window_lengths(Type, Wall, Most, Range), !.
window_range(_, _, Most, Most-Most).

window_lengths(Type, Wall, Most, Range) :-
    metres(Wall, WallMetres), metres(Most, MostMetres),
    findall(R, ( once(grammar:window_size(Type, Length, WallMetres)), {Length =< MostMetres + 1.0e-9}, extremes(Length, R) ), [L-H]),
    maplist(in_unit, [L,H], [Low,High]),
    inner_range(Low-High, Range).
