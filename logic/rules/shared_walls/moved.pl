:- module(moved, [own_plan_moved/5]).

/** <module> The least change of a user's plan with which its lengths are the grammar's

Each room keeps the lines that its sides lie on, its type, doors and windows; where the lines are is open. Least is the sum of
what they move, a linear programme: but for areas, which are linear near the sizes that a room has, so it is solved again from
where it led.
*/

:- use_module(library(apply)).
:- use_module(library(aggregate)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module('../answers').
:- use_module(areas).
:- use_module('../language/grammar_files').
:- use_module('../language/lengths').
:- use_module('../language/sizes').
:- use_module('../linear/linear').
:- use_module(contacts).
:- use_module(openings).
:- use_module(walls).

% So often is it solved: areas are then right to a millionth.
rounds(5).

%!  own_plan_moved(+Atoms, +Lines, +Rooms, +Walls, -Json) is det.
%
%   Atoms are those of stage 1. Lines is lines(Xs,Ys), metres, those of x and those of y by their numbers from 0. Rooms are
%   room(R,West,East,North,South), Walls wall(R,Side,Behind,From,To) with the room behind or `outside`, by numbers of lines. Json is
%   [Xs,Ys,DoorWidth], where the lines are; null where they can be nowhere.

own_plan_moved(Atoms, lines(Xs,Ys), Rooms, Walls, Json) :-
    rounds(Rounds),
    (   again(Rounds, plan(Atoms,Rooms,Walls,Xs,Ys), Xs-Ys, Xs1-Ys1)
    ->  length_of(door_width, Width), Moved = [Xs1,Ys1,Width]
    ;   Moved = null ),
    as_json(Moved, Json).

again(0, _, Places, Places) :- !.
again(Rounds, Plan, Near, Places) :-
    Fewer is Rounds - 1,
    moved(Plan, Near, Next),
    again(Fewer, Plan, Next, Places).

moved(plan(Atoms,Rooms,Walls,Xs0,Ys0), NearXs-NearYs, Xs-Ys) :-
    maplist(same_length, [Xs0,Ys0], [Xs1,Ys1]),
    maplist(indexed, [Xs1,Ys1,NearXs,NearYs], [X,Y,NearX,NearY]),
    phrase(( rooms(Rooms, Atoms, at(X,Y), at(NearX,NearY)), wholes(Atoms, Rooms, at(X,Y), at(NearX,NearY)),
             doors(Atoms, Rooms, at(X,Y)), outer(Atoms, Walls, at(X,Y)),
             touching(Walls, Rooms, at(X,Y)), all_same(Atoms, Rooms, at(X,Y)) ), Constraints),
    maplist(extent, [Xs1,Ys1], [Width,Depth]),
    house_system(Width, Depth, Whole),
    append(Xs1, Ys1, Places), append(Xs0, Ys0, Given),
    length(Xs0, Columns), length(Ys0, Rows),
    weights(x, Columns, Rooms, Across), weights(y, Rows, Rooms, Down), append(Across, Down, Weights),
    append(Whole, Constraints, All), fewest_unknowns_first(All, System),
    findall(Values, least(System, Places, Given, Weights, Values), [Values]),
    same_length(Xs0, Xs), append(Xs, Ys, Values).

least(System, Places, Given, Weights, Values) :-
    posted(System),
    foldl(off, Places, Given, Weights, 0, Sum),
    inf(Sum, _, Places, Values).

off(Place, Given, Weight, Sum, Sum + Weight*Off) :- {Off >= Place - Given, Off >= Given - Place}.

%   weights(+Axis, +Number, +Rooms, -Weights): of as little a change, lines move that fewer rooms lie on.

weights(Axis, Number, Rooms, Weights) :-
    Last is Number - 1,
    findall(Weight, ( between(0, Last, K), aggregate_all(count, on_line(Axis, K, Rooms), On), Weight is 1 + On/1000 ), Weights).

on_line(x, K, Rooms) :- member(room(_,W,E,_,_), Rooms), ( K =:= W ; K =:= E ).
on_line(y, K, Rooms) :- member(room(_,_,_,N,S), Rooms), ( K =:= N ; K =:= S ).

indexed(List, Term) :- Term =.. [line|List].

extent([First|Rest], Length) :- last(Rest, Last), within(Last-First, Length).

%   within(+Length, -Within): between the middles of two walls, and between their faces.

within(Length, Within) :- length_of(inner_wall, T), ( T =:= 0 -> Within = Length ; Within = Length-T ).

place(Number, Lines, X) :- Arg is Number + 1, arg(Arg, Lines, X).

sides(room(_,W,E,N,S), at(X,Y), X1, X2, Y1, Y2) :- place(W, X, X1), place(E, X, X2), place(N, Y, Y1), place(S, Y, Y2).

% - rooms ------------------------------------------------------------------------------------------------

rooms([], _, _, _) --> [].
rooms([Room|Rooms], Atoms, At, Near) -->
    { Room = room(R,_,_,_,_), memberchk(room(R,Type), Atoms),
      sides(Room, At, X1, X2, Y1, Y2), sides(Room, Near, A1, A2, B1, B2),
      maplist(within, [X2-X1,Y2-Y1,A2-A1,B2-B1], [X,Y,A,B]),
      (   memberchk(runs(R,x), Atoms)
      ->  W = Y, D = X, W0 is B, D0 is A
      ;   W = X, D = Y, W0 is A, D0 is B ),
      ( room_size_system(Type, W, D, Sizes) -> true ; Sizes = [] ) },
    list(Sizes),
    ( { memberchk(runs(R,_), Atoms) } -> [(W =< D)-[]] ; [] ),
    area(Type, W, D, W0, D0),
    rooms(Rooms, Atoms, At, Near).

%   all_same(+Atoms, +Rooms, +At)//: rooms of the types of same_size/1 have one size.

all_same(Atoms, Rooms, At) -->
    { findall(T, member(same_size(T), Atoms), Types),
      findall(T-Room, ( member(T, Types), member(Room, Rooms), arg(1, Room, R), memberchk(room(R,T), Atoms) ), Alike) },
    each_same(Alike, Atoms, At).

each_same([T-Room,T-Next|Alike], Atoms, At) --> !,
    { maplist(across_and_along(Atoms, At), [Room,Next], [W1-D1,W2-D2]) },
    [(W1 = W2)-[], (D1 = D2)-[]],
    each_same([T-Next|Alike], Atoms, At).
each_same([_|Alike], Atoms, At) --> each_same(Alike, Atoms, At).
each_same([], _, _) --> [].

across_and_along(Atoms, At, Room, W-D) :-
    sides(Room, At, X1, X2, Y1, Y2), arg(1, Room, R),
    ( memberchk(runs(R,x), Atoms) -> W = Y2-Y1, D = X2-X1 ; W = X2-X1, D = Y2-Y1 ).

list([])     --> [].
list([X|Xs]) --> [X], list(Xs).

%   A millionth more than the least area, whose tangent is right in one point, and less than the greatest.

area(Type, W, D, W0, D0) -->
    { grammar:room_area(Type, Least, Most) }, !,
    { Steep is D0/W0, Low is 2*sqrt(Steep*Least*(1 + 1.0e-6)), High is 2*sqrt(Steep*Most*(1 - 1.0e-6)) },
    [(Low =< Steep*W + D)-[], (Steep*W + D =< High)-[]].
area(_, _, _, _, _) --> [].

%   What the areas of a room and of its parts are together near their sizes, linear in these.

wholes(Atoms, Rooms, At, Near) -->
    { findall([Q|Parts]-Areas, whole(Atoms, Q, Parts, Areas), Wholes) },
    areas_of(Wholes, Rooms, At, Near).

whole(Atoms, Q, Parts, Least-Most) :-
    clause(grammar:whole_area(_,_,_), _),
    member(parts(Q,_), Atoms), memberchk(room(Q,T), Atoms), once(grammar:whole_area(T, Least, Most)),
    findall(R, member(part_of(R,Q), Atoms), Parts).

areas_of([], _, _, _) --> [].
areas_of([Numbers-(Least-Most)|Wholes], Rooms, At, Near) -->
    { foldl(area_near(Rooms, At, Near), Numbers, 0, Sum), Low is Least*(1 + 1.0e-8), High is Most*(1 - 1.0e-8) },
    [(Low =< Sum)-[], (Sum =< High)-[]],
    areas_of(Wholes, Rooms, At, Near).

area_near(Rooms, At, Near, R, Sum, Sum + W0*D + D0*W - W0*D0) :-
    Room = room(R,_,_,_,_), memberchk(Room, Rooms),
    sides(Room, At, X1, X2, Y1, Y2), sides(Room, Near, A1, A2, B1, B2),
    W = X2-X1, D = Y2-Y1, W0 is A2-A1, D0 is B2-B1.

% - walls ------------------------------------------------------------------------------------------------

doorway(Least) :- length_of(door_width, Width), length_of(door_margin, Margin), Least is Width + 2*Margin.

doors(Atoms, Rooms, At) -->
    { doorway(Least), findall(R-Q, member(door(R,Q,_), Atoms), Doors) },
    doors_of(Doors, Rooms, At, Least).

doors_of([], _, _, _) --> [].
doors_of([R-Q|Doors], Rooms, At, Least) -->
    { memberchk(room(R,W,E,N,S), Rooms), memberchk(room(Q,W1,E1,N1,S1), Rooms),
      sides(room(R,W,E,N,S), At, A1, A2, B1, B2), sides(room(Q,W1,E1,N1,S1), At, C1, C2, D1, D2),
      ( ( E =:= W1 ; W =:= E1 ) -> Along = B1-B2/(D1-D2) ; Along = A1-A2/(C1-C2) ) },
    overlap(Along, Least),
    doors_of(Doors, Rooms, At, Least).

overlap(A1-A2/(B1-B2), M0) --> { length_of(inner_wall, T), M is M0 + T }, [(A1+M =< A2)-[], (B1+M =< B2)-[], (A1+M =< B2)-[], (B1+M =< A2)-[]].

%   The longest part of an outer side has room for its window, the entrance or a garden door, as in own_plan.pl.

outer(Atoms, Walls, At) -->
    { length_of(door_width, Width), outer_margin(door_margin, Margin), Door is Width + 2*Margin,
      findall(R-S-outside-Door, ( member(Way, Atoms), outer_way(Way, R, S) ), Entrances),
      findall(R-S-Q-L, ( member(window(R,S), Atoms), memberchk(room(R,T), Atoms), window_walls(T, L, _), behind_window(Atoms, R, S, Q) ), Windows),
      append(Entrances, Windows, Openings) },
    parts(Openings, Walls, At).

parts([], _, _) --> [].
parts([R-S-Q-Least|Openings], Walls, At) -->
    { findall(part(R,S,F,T), member(wall(R,S,Q,F,T), Walls), Parts), longest(Parts, At, X1, X2) }, !,
    { length_of(outer_wall, T), Long is Least + T },       % what walls across take of it, at most
    [(X1+Long =< X2)-[]],
    parts(Openings, Walls, At).
parts([_|Openings], Walls, At) --> parts(Openings, Walls, At).

behind_window(Atoms, R, S, Q) :- ( memberchk(toward(R,S,P), Atoms) -> Q = P ; Q = outside ).

%   Of parts of a side, which begin and end at lines, the one over most of them.

longest(Parts, At, X1, X2) :-
    findall(N-F-T-S, ( member(part(_,S,F,T), Parts), N is T - F ), Long),
    max_member(_-F-T-S, Long),
    lines_along(S, At, Lines), place(F, Lines, X1), place(T, Lines, X2).

lines_along(S, at(X,Y), Lines) :- side_axis(S, Axis), ( Axis == x -> Lines = X ; Lines = Y ).

%   Rooms that share a wall still do.

touching([], _, _) --> [].
touching([wall(R,S,Q,F,T)|Walls], Rooms, At) -->
    ( { integer(Q), R < Q } -> { least_contact(M0), length_of(inner_wall, Thick), M is M0 + Thick, lines_along(S, At, Lines), place(F, Lines, X1), place(T, Lines, X2) }, [(X1+M =< X2)-[]] ; [] ),
    touching(Walls, Rooms, At).
