:- module(own_plan, [own_plan_faults/7, own_openings/5]).

/** <module> A user's own plan: what the grammar's lengths forbid in it, and its doors and windows

A wall is wall(Room,Side,Behind,At,Start,End), metres: a part of a side of a room, before another room or `outside`.
*/

:- use_module(library(apply)).
:- use_module(library(aggregate)).
:- use_module(library(lists)).
:- use_module('../answers').
:- use_module(areas).
:- use_module('../language/grammar_files').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module('../linear/grid').
:- use_module(opening_sizes).
:- use_module(openings).
:- use_module(plans).
:- use_module(swings).
:- use_module('../linear/sample').
:- use_module('../language/sizes').
:- use_module(totals).

%!  own_plan_faults(+Outline, +Rooms, +Walls, +Doors, +Types, +Openings, -Json) is det.
%
%   Outline is size(Width,Depth), Rooms are room(R,Width,Depth), Doors are door(R,Q,Length) with a room or side Q, Openings are
%   opening(Type,Other). Json lists [Fact,Clauses], facts of own.lp.

own_plan_faults(Outline, Rooms, Walls, Doors, Types, Openings, Json) :-
    findall([Text,Texts],
            ( ( fault(Outline, Rooms, Walls, Types, Fact, Clauses) ; closed(Openings, Walls, Fact, Clauses) ; thin(Doors, Fact, Clauses) ),
              term_string(Fact, Text), maplist(term_string, Clauses, Texts) ),
            Faults),
    as_json(Faults, Json).

fault(size(W,D), _, _, _, misfit(house), [house_size]) :- house_system(W, D, System), \+ posted(System).
fault(_, Rooms, _, _, misfit(house), [house_area]) :-
    total_area(Least-Most),
    findall(Area, ( member(room(_,W,D), Rooms), Area is W*D ), Areas), sum_list(Areas, Whole),
    ( Whole < Least - 1.0e-6 ; Whole > Most + 1.0e-6 ).
fault(_, _, _, Types, whole(T,(L,M)), [whole_area(T)]) :-
    clause(grammar:whole_area(_,_,_), _),
    member(T, Types), once(grammar:whole_area(T, Least, Most)), maplist(square_millimetres, [Least,Most], [L,M]).
fault(_, Rooms, _, _, covers(at(R),A), []) :-
    clause(grammar:whole_area(_,_,_), _),
    member(room(R,W,D), Rooms), Area is W*D, square_millimetres(Area, A).
fault(_, Rooms, _, Types, misfit(at(R),T,Axis), [Clause|Walls]) :-
    member(room(R,X,Y), Rooms),
    member(T, Types),
    member(Axis-W-D, [x-Y-X,y-X-Y]),
    unfit(T, W, D, Clause),
    length_of(inner_wall, Thick),
    ( Thick =\= 0, W1 is W+Thick, D1 is D+Thick, \+ unfit(T, W1, D1, _) -> Walls = [length(inner_wall)] ; Walls = [] ).
fault(_, Rooms, _, _, squat(at(R),Axis), []) :-
    member(room(R,X,Y), Rooms),
    member(Axis-W-D, [x-Y-X,y-X-Y]),
    D < W - 1.0e-6.
fault(_, Rooms, _, _, measured(at(R),A,B), []) :-
    findall(Size, ( member(room(_,X,Y), Rooms), ( Size = X ; Size = Y ) ), Sizes0), msort(Sizes0, Sizes),
    member(room(R,X,Y), Rooms), maplist(size_class(Sizes), [X,Y], [A,B]).
fault(_, _, Walls, _, narrow(at(R),at(Q)), [length(door_width),length(door_margin)]) :-
    member(wall(R,_,Q,_,A,B), Walls), Q \== outside,
    doorway(Least), \+ reaches(A-B, Least).
fault(_, _, Walls, _, shut(at(R),S), [length(door_width),length(door_margin)]) :-
    outer_side(Walls, R, S, A-B), entry(Least), \+ reaches(A-B, Least).
fault(_, _, Walls, Types, dark(at(R),S,T), [window_size(T),length(window_margin)]) :-
    outer_side(Walls, R, S, A-B), member(T, Types), window_walls(T, Least, Most),
    \+ ( reaches(A-B, Least), ( Most == any -> true ; B - A =< Most + 1.0e-6 ) ).

fault(_, _, Walls, Types, dim(at(R),at(Q),T), [window_size(T),length(window_margin)]) :-
    clause(grammar:window_size(_,_,_), _),
    member(wall(R,_,Q,_,A,B), Walls), Q \== outside, member(T, Types), window_walls(T, Least, Most),
    \+ ( reaches(A-B, Least), ( Most == any -> true ; B - A =< Most + 1.0e-6 ) ).

%   size_class(+Sizes, +Size, -Class): sizes that are the same are of one Class, a whole number; Sizes are in order.

size_class(Sizes, Size, Class) :-
    aggregate_all(count, ( nextto(A, B, Sizes), B > A + 1.0e-6, B =< Size ), Class).

%   square_millimetres(+Area, -Whole): of square metres, as far as a number of clingo's reaches.

square_millimetres(Area, Whole) :- Whole is min(1000000000, round(1.0e6*Area)).

closed(Openings, Walls, closed(at(R),at(Q),T,U), Clauses) :-
    member(opening(A,B), Openings), member(T-U, [A-B,B-A]),
    opening_wall(A, B, Least, Clauses), metres(Least, M),
    member(wall(R,_,Q,_,Start,End), Walls), Q \== outside,
    \+ reaches(Start-End, M).

thin(Doors, thin(at(R),Q), [length(door_width)]) :- member(door(R,Q,L), Doors), length_of(door_width, W), L < W - 1.0e-6.

unfit(T, W, D, size(T)) :- room_size_system(T, W, D, System), \+ posted(System), !.
unfit(T, W, D, room_area(T)) :- grammar:room_area(T, Least, Most), Area is W*D, ( Area < Least - 1.0e-6 ; Area > Most + 1.0e-6 ), !.

entry(Least) :- length_of(door_width, Width), outer_margin(door_margin, Margin), Least is Width + 2*Margin.

doorway(Least) :- length_of(door_width, Width), length_of(door_margin, Margin), Least is Width + 2*Margin.

reaches(A-B, Least) :- B - A >= Least - 1.0e-6.

%   outer_side(+Walls, ?Room, ?Side, -Span) is nondet: the longest part of the side that is an outer wall.

outer_side(Walls, R, S, Span) :- outer_wall(Walls, R, S, _, Span).

outer_wall(Walls, R, S, At, A-B) :-
    setof(R-S, At0^A0^B0^member(wall(R,S,outside,At0,A0,B0), Walls), Sides),
    member(R-S, Sides),
    findall(L-wall(At1,A1,B1), ( member(wall(R,S,outside,At1,A1,B1), Walls), L is B1-A1 ), Parts),
    max_member(_-wall(At,A,B), Parts).

%!  own_openings(+Atoms, +Types, +Walls, +Seed, -Json) is det.
%
%   Types are R-Type. Json is {"doors": [..], "windows": [..]}, as in plan_placed/3: each somewhere in its wall.

own_openings(Atoms, Types, Walls, Seed, Json) :-
    joins(Atoms, Joins), findall(window(R,S), member(window(R,S), Atoms), Panes),
    clear_doors(openings_sample(Joins, Atoms-Types, Walls, []), Doors, Seed, Seed1),
    openings_sample(Panes, Atoms-Types, Walls, [], Windows, Seed1, _),
    answer_record(plan([],Doors,Windows), Record),
    as_json(Record, Json).

%   openings_sample(+Openings, +Known, +Walls, +Before, -Boxes)//: the openings Before are already placed.

openings_sample([], _, _, _, []) --> [].
openings_sample([A|As], Known, Walls, Before, [Opening|Openings]) -->
    opening_sample(A, Known, Walls, Before, Opening),
    openings_sample(As, Known, Walls, [Opening|Before], Openings).

opening_sample(door(R,Q,_), Atoms-Types, Walls, Before, Door) -->
    { memberchk(wall(R,Side,Q,At,A,B), Walls), side_axis(Side, Axis), memberchk(R-T, Types), memberchk(Q-U, Types) },
    joint_sample(R-Q, Atoms, T-U, Axis-At, A-B, Before, Door).
opening_sample(Way, _, Walls, Before, door(Box,R,outside)) -->
    { outer_way(Way, R, Side), once(outer_wall(Walls, R, Side, At, Span)), length_of(door_width, Width), outer_margin(door_margin, Margin) },
    { side_axis(Side, Axis), start_range(Span, Width, Margin, Range) },
    start_sample(Axis-At, Width, Range, Before, Start),
    { segment(Axis, At, Start, Width, Box) }.
opening_sample(window(R,Side), Atoms-Types, Walls, _, window(Box,R)) -->
    { window_wall(Atoms, Walls, R, Side, At, A-B), memberchk(R-Type, Types), outer_margin(window_margin, Margin),
      Most is B - A - 2*Margin,
      window_range(Type, A-B, Most, Low-High) },
    interval_sample(Low, High, 1, Length),
    { side_axis(Side, Axis), start_range(A-B, Length, Margin, First-Last) },
    interval_sample(First, Last, 1, Start),
    { segment(Axis, At, Start, Length, Box) }.

window_wall(Atoms, Walls, R, Side, At, A-B) :- memberchk(toward(R,Side,Q), Atoms), !, memberchk(wall(R,Side,Q,At,A,B), Walls).
window_wall(_, Walls, R, Side, At, Span) :- once(outer_wall(Walls, R, Side, At, Span)).
