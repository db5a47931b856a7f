:- module(plan_bounds, [plan_room_lengths/5, opening_lengths/5, open_lengths/4]).

/** <module> Why the lengths of a plan are as they are: what else they could have been, and which constraints bind

What bounds.pl says of furniture, for walls that rooms share, and for the doors and windows in them.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module('../answers').
:- use_module(bounds).
:- use_module('../brief/brief').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../shared_walls/opening_sizes').
:- use_module('../shared_walls/openings').
:- use_module('../shared_walls/walls').

%!  plan_room_lengths(+Atoms, +Given, +Boxes, +Room, -Json) is det.
%
%   Json is what bounds_json/3 says of the width, from west to east, and the height of a room of the plan of these Atoms,
%   whose rooms have the Boxes box(R,West,East,North,South), in metres from the plan's north-west corner. What is named
%   in a bound is a line of the topology and its `x` or `y`. Given are lines that stay where they are, as in walls.pl.

plan_room_lengths(Atoms, Given, Boxes, Number, Json) :-
    bounded_system(Atoms, Given, plan(Lines,Rooms), System),
    maplist(line_name(Rooms), Lines, Names),
    copy_term(k(Rooms,Names), k(SolvedRooms,Solved)),
    maplist(solved_room(Boxes), SolvedRooms),
    memberchk(room(Number,_,sides(X1,X2,Y1,Y2),_), Rooms),
    memberchk(room(Number,_,sides(A1,A2,B1,B2),_), SolvedRooms),
    Width is A2-A1, Height is B2-B1,
    length_bounds(System, []-[], width-(X2-X1), Width, W),
    length_bounds(System, []-[], height-(Y2-Y1), Height, H),
    term_variables([X1,X2,Y1,Y2], Variables),
    tight(System, Names-Solved, Variables, Binding),
    bounds_json([W,H], Binding, Json).

bounded_system(Atoms, _, Plan, System) :- of_brief(Atoms), !, brief_system(Atoms, Plan, Lines, Items), areas_bounded(Lines, Items, System).
bounded_system(Atoms, Given, Plan, System) :- whole_system(Atoms, Given, Plan, System).

line_name(Rooms, Line-Place, Place-(Line-Axis)) :-
    (   member(room(_,_,_,edges(edge(_,_,West),edge(_,_,East),_,_)), Rooms), memberchk(Line, [West,East])
    ->  Axis = x
    ;   Axis = y ).

solved_room(Boxes, room(R,_,sides(X1,X2,Y1,Y2),_)) :-
    memberchk(box(R,West,East,North,South), Boxes),
    maplist(solved, [West,East,North,South], [X1,X2,Y1,Y2]).

% Rooms on a line agree on its place but for a rounding error.
solved(Metres, Place) :-
    (   var(Place)
    ->  rounded_up(Metres, Place)
    ;   compound(Place), Place = Line+T
    ->  length_of(inner_wall, T), ( var(Line) -> rounded_up(Metres, Face), Line is Face - T ; true )
    ;   true ).

%!  open_lengths(+Type, +Other, +Wall, -Json) is det.
%
%   Json is [Least,Greatest,Clauses]: how wide an opening between rooms of these types may be in this part of a wall, metres.

open_lengths(Type, Other, Metres, Json) :-
    in_unit(Metres, Wall),
    opening_wall(Type, Other, _, Clauses),
    ( opening_range(Type, Other, Wall, Low-High) -> true ; Low = Wall, High = Wall ),
    maplist(metres, [Low,High], [Least,Greatest]), maplist(term_string, Clauses, Texts),
    as_json([Least,Greatest,Texts], Json).

%!  opening_lengths(+Type, +Other, +Start, +End, -Json) is det.
%
%   Json has, in metres, the "door" between rooms of these types, for which "clause", and its "margin", and of a "window" in the wall from Start to End of a room of this Type
%   the least and greatest length, and its "frame", the margin.

opening_lengths(Type, Other, Start, End, Json) :-
    door_width_of(Type, Other, Width, Clause), term_string(Clause, Text), length_of(door_margin, Margin), outer_margin(window_margin, Frame),
    maplist(rounded_up, [Start,End], [A,B]),
    Most is B - A - 2*Frame,
    window_range(Type, A-B, Most, Low-High),
    maplist(metres, [Width,Margin,Frame,Low,High], [W,M,F,L,H]),
    as_json(_{door:W, clause:Text, margin:M, frame:F, window:[L,H]}, Json).
