:- module(walls, [walls_placed//4, wall_system/4, whole_system/4, brief_system/4, exact_system/4, of_brief/1, unit_range/5, unsampled/3, fewest_unknowns_first/2]).

/** <module> Stage 2 of plans: where walls, doors and windows are, for any topology

A topology says on which line each side of a room lies: edge(R,Side,Line). The unknowns are the places of these lines: x
where they run from north to south, y where they run from west to east. All
constraints are linear (areas.pl), each with the atoms and clauses that make it. A room is here

    room(R,Type,sides(X1,X2,Y1,Y2),edges(West,East,North,South))     with its edge/3 atoms

A wall on a line reaches from the line to the east or south, by the thickness of an inner wall. The rest of a thicker outer wall lies
outside. The sides of a room are the faces of its walls, so a room begins at X1 = Line+Thickness. The first rooms begin at (0,0).

In a house of units, stage 2 places the units first, as rooms of the type `unit`, and then the rooms of each unit. Given has the places
and sizes that are known before:

    at(Line,Place)                  this line is there: of a unit that has its place, the four lines of its outline
    size(B,Axis,Depth,Low,High)     the unit B is Depth long along the Axis, and Low to High long along the other axis
*/

:- use_module(library(apply)).
:- use_module(library(assoc)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(areas).
:- use_module('../brief/brief').
:- use_module('../brief/thorough').
:- use_module(contacts).
:- use_module('../linear/exact').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module('../language/sizes').
:- use_module(lines).
:- use_module(openings).
:- use_module(totals).

%!  walls_placed(+Atoms, +Given, +Proof, -Answer)// is det.
%
%   Answer is plan(Rooms,Doors,Windows), a random solution (openings.pl), or infeasible(Reasons), proved in rational
%   arithmetic; the reasons are those of a minimal conflict where Proof is `minimal`. Without `thorough` among the Atoms, the
%   System excludes some sizes that areas allow. With `thorough` or a brief, Answer may be open(Reasons): neither a plan nor a proof
%   was found.

walls_placed(Atoms, _, _, Answer)         --> { memberchk(thorough, Atoms) }, !, thoroughly_placed(Atoms, Answer).
walls_placed(Atoms, _, Proof, Answer)     --> { of_brief(Atoms) }, !, brief_placed(Atoms, Proof, Answer).
walls_placed(Atoms, Given, Proof, Answer) -->
    { whole_system(Atoms, Given, Plan, System) },
    plan_placed(Atoms, Plan, System, Proof, Answer).

%   plan_placed(+Atoms, +Plan, +System, +Proof, -Answer)//: CLP(R) is quick, but it rounds, so it may miss a solution. Then rational
%   arithmetic proves a conflict, or samples a plan if there is no conflict.

plan_placed(Atoms, Plan, System, _, Answer) -->
    plan_sample(real-3, Atoms, Plan, System), !,
    plan_answer(Plan, Atoms, Answer).
plan_placed(_, _, System, Proof, Answer) -->
    { exact_conflict(Proof, System, Conflict), !, refuted(Conflict, Answer) }.
plan_placed(Atoms, Plan, System, _, Answer) -->
    plan_sample(rational-0, Atoms, Plan, System), !,
    plan_answer(Plan, Atoms, Answer).
plan_placed(_, _, System, _, Answer) -->      % no whole numbers satisfy the System, or no plan has the stated area
    { refuted(System, Answer) }.

plan_answer(plan(_,Rooms), Atoms, Answer) --> plan_openings(Atoms, Rooms, Answer).

brief_placed(Atoms, Proof, Answer) -->
    { brief_system(Atoms, plan(Lines,Rooms), System, Items) },
    items_decided(Proof, Lines, Rooms, System, Items, Found),
    brief_answer(Found, Atoms, Rooms, Items, Answer).

brief_answer(placed, Atoms, Rooms, _, Answer)      --> plan_openings(Atoms, Rooms, Answer).
brief_answer(refuted(Conflict), _, _, _, Answer)   --> { refuted(Conflict, Answer) }.
brief_answer(open, Atoms, _, Items, open(Reasons)) -->
    { findall(A, ( member(A, Atoms), A = edge(_,_,_) ; chosen_step(Items, A) ), Reasons) }.

thoroughly_placed(Atoms, Answer) -->
    { exact_system(Atoms, plan(Lines,Rooms), System, Items) },
    thoroughly_decided(Lines, Rooms, System, Items, Found),
    thorough_answer(Found, Atoms, Rooms, System, Items, Answer).

%   thorough_answer(+Found, ...)//: if the search found no answer, any constraint and any item may be a reason.

thorough_answer(open, _, _, System, Items, open(Reasons)) --> !,
    { findall(_-Why, ( member(_-Why, System) ; member(item(_,_,_,Why,_,_), Items) ), All),
      refuted(All, infeasible(Reasons)) }.
thorough_answer(Found, Atoms, Rooms, _, Items, Answer)    --> brief_answer(Found, Atoms, Rooms, Items, Answer).

plan_sample(Arithmetic-Halvings, Atoms, plan(Lines,Rooms), System) -->
    (   { totals(Atoms, Rooms, Totals), Totals \== [] }
    ->  { rooms_sized(Rooms, Atoms, Sized), sampling_order(Lines, Rooms, Order) },
        total_sample(Arithmetic, Order, System, Totals, Rooms, Sized, Halvings)
    ;   lines_sample(Arithmetic, Lines, Rooms, System) ).

%!  brief_system(+Atoms, -Plan, -System, -Items) is det.
%
%   As wall_system/4 for the rooms of a brief, with the items of their areas (brief.pl).

brief_system(Atoms, Plan, System, Items) :-
    wall_system(Atoms, [], Plan, Walls),
    Plan = plan(Lines,Rooms),
    plan_boxes(Atoms, Lines, Rooms, Boxes),
    phrase(brief_constraints(Atoms, Boxes), Lengths),
    area_items(Atoms, Boxes, Items, Sides),
    append([Walls,Lengths,Sides], All),
    fewest_unknowns_first(All, System).

of_brief(Atoms) :- memberchk(granted(_), Atoms).

%!  exact_system(+Atoms, -Plan, -System, -Items) is det.
%
%   As brief_system/4, for any plan without totals: Items include all areas that the grammar states.

exact_system(Atoms, Plan, System, Items) :-
    (   of_brief(Atoms)
    ->  brief_system(Atoms, Plan, System, Items0)
    ;   wall_system(Atoms, [], Plan, System), Items0 = [] ),
    Plan = plan(_,Rooms),
    exclude(of_stated_area(Atoms), Rooms, Others),
    convlist(grammar_item, Others, Items1),
    append(Items0, Items1, Items).

of_stated_area(Atoms, room(R,_,_,_)) :- has_area(Atoms, R).

%   plan_boxes(+Atoms, +Lines, +Rooms, -Boxes): the rooms, the voids and the outline.

plan_boxes(Atoms, Lines, Rooms, [room(outline,none,sides(West,East,North,South),none)|Boxes]) :-
    maplist(outline_place(Lines), [west,east,north,south], [West0,East,North0,South]),
    thickness_of(Rooms, T), maplist(wall_face(T), [West0,North0], [West,North]),
    list_to_assoc(Lines, Places),
    placed_voids(Atoms, Places, T, Free),
    append(Rooms, Free, Boxes).

outline_place(Lines, Side, X) :- memberchk(outline(Side)-X, Lines).

%   chosen_step(+Items, -Step): Step is an atom by which stage 1 has chosen a bound of an item's width.

chosen_step(Items, Step) :- member(Item, Items), item_range(Item, from(_,Low)-upto(_,High)), ( member(Step, Low) ; member(Step, High) ).

%!  whole_system(+Atoms, +Given, -Plan, -System) is det.
%
%   As wall_system/4, with constraints on areas that are sums (totals.pl).

whole_system(Atoms, Given, Plan, System) :-
    wall_system(Atoms, Given, Plan, Walls),
    Plan = plan(_,Rooms),
    (   totals(Atoms, Rooms, Totals), Totals \== []
    ->  rooms_sized(Rooms, Atoms, Sized),
        total_constraints(Totals, Sized, Areas), append(Walls, Areas, All),
        fewest_unknowns_first(All, System)
    ;   System = Walls ).

%   rooms_sized(+Rooms, +Atoms, -Sized): each R-sized(..), see room_sized/3.

rooms_sized([], _, []).
rooms_sized([Room|Rooms], Atoms, [R-Sized|Others]) :-
    Room = room(R,_,_,_),
    room_sized(Atoms, Room, Sized),
    rooms_sized(Rooms, Atoms, Others).

refuted(Conflict, infeasible(Reasons)) :-
    findall(Reason, ( member(_-Why, Conflict), member(Reason, Why) ), Found),
    sort(Found, Reasons).

%!  wall_system(+Atoms, +Given, -Plan, -System) is det.
%
%   Plan is plan(Lines,Rooms): Lines has Name-Place for each line; Rooms has the rooms of the house and its units. System has all
%   constraints of the plan. Constraints with the fewest unknowns come first, since CLP(R) is least often wrong in that order.

wall_system(Atoms, Given, plan(Lines,All), System) :-
    findall(Line, member(edge(_,_,Line), Atoms), Names0), sort(Names0, Names),
    pairs_keys(Lines, Names),
    list_to_assoc(Lines, Places),
    thickness(T, Thick),
    lines_given(Given, Places),
    outline_box(Places, T, Box),
    findall(Type-R, member(room(R,Type), Atoms), Types), placed_rooms(Types, Atoms, Places, T, Rooms),
    findall(unit-B, member(unit(B,_), Atoms), Units0), placed_rooms(Units0, Atoms, Places, T, Units),
    append(Rooms, Units, All),
    whole_size(Units, Box, Given, Atoms, Whole),
    placed_voids(Atoms, Places, T, Voids),
    phrase(( all_rooms(Rooms, Atoms), all_voids(Voids, Atoms), all_openings(Atoms, Rooms), all_contacts(Atoms, Rooms),
             all_same_sizes(Atoms, Rooms) ), Each),
    rooms_within(Atoms, Box, Rooms, Each, Within),
    findall(court(L,M), member(court(L,M), Atoms), Courts),
    foldl(court_between(Places), Courts, Within, Inside),
    append([Thick,Whole,Inside], Constraints),
    fewest_unknowns_first(Constraints, System).

%   outline_box(+Places, +Thickness, -Box): Box is box(West,East,North,South), the inner faces of the outer walls. The first rooms begin at
%   0, so the west or north line of the outline, if it is unknown, lies one thickness before 0.

outline_box(Places, T, box(West,East,North,South)) :-
    maplist(get_assoc_of(Places), [outline(west),outline(east),outline(north),outline(south)], [West0,East,North0,South]),
    maplist(first_unless_known, [West0,North0]),
    maplist(wall_face(T), [West0,North0], [West,North]).

%   whole_size(+Units, +Box, +Given, +Atoms, -Constraints): the size of the house or, where units are placed, of each unit.

whole_size([], box(West,East,North,South), _, _, Constraints) :- !, house_system(East-West, South-North, Constraints).
whole_size(Units, _, Given, Atoms, Constraints)               :- unit_sizes(Given, Atoms, Units, Constraints).

%   rooms_within(+Atoms, +Box, +Rooms, +Constraints, -More): if `bounded` is among the Atoms, all rooms lie within the outline.

rooms_within(Atoms, Box, Rooms, Constraints, More) :-
    (   memberchk(bounded, Atoms)
    ->  foldl(within(Box), Rooms, Constraints, More)
    ;   More = Constraints ).

within(box(West,East,North,South), room(_,_,sides(X1,X2,Y1,Y2),edges(W,E,N,S)), Constraints,
       [(West =< X1)-[bounded,W],(X2 =< East)-[bounded,E],(North =< Y1)-[bounded,N],(Y2 =< South)-[bounded,S]|Constraints]).

%   court_between(+Places, +Court, +Constraints, -More): a court is at least 0.5 m wide between its walls; a narrower one is a slit.

court_between(Places, court(L,M), Constraints, [(X+Apart =< Y)-[court(L,M)]|Constraints]) :-
    get_assoc(L, Places, X), get_assoc(M, Places, Y), !,
    in_unit(0.5, Least), maplist(length_of, [inner_wall,outer_wall], [Inner,Outer]), Apart is Least + 2*Outer - Inner.
court_between(_, _, Constraints, Constraints).

%   lines_given(+Given, +Places): the lines of the Given faces of walls have the places of these faces.

lines_given([], _).
lines_given([at(Line,Face)|Given], Places) :- !,
    length_of(inner_wall, T),
    ( T =\= 0, memberchk(Line, [outline(west),outline(north)]) -> X is Face - T ; X = Face ),
    get_assoc(Line, Places, X), lines_given(Given, Places).
lines_given([_|Given], Places) :- lines_given(Given, Places).

get_assoc_of(Places, Line, X) :- get_assoc(Line, Places, X).

first_unless_known(X) :- ( var(X) -> length_of(inner_wall, T), X is 0.0 - T ; true ).

%   thickness(-T, -Constraints): T is the thickness of inner walls. It is an unknown, so that a conflict names it only if it matters.

thickness(T, Constraints) :-
    length_of(inner_wall, Thick),
    ( Thick =:= 0 -> T = 0, Constraints = [] ; Constraints = [(T = Thick)-[length(inner_wall)],(0 =< T)-[]] ).

%   thickness_of(+Rooms, -T): T is the unknown thickness of inner walls, or 0.

thickness_of([room(_,_,sides(X,_,_,_),_)|_], T) :- ( compound(X), X = _+T0 -> T = T0 ; T = 0 ).

%   wall_face(+Thickness, +Line, -Face): the face to the east or south of a wall on this line.

wall_face(T, X, Face) :- ( T == 0 -> Face = X ; Face = X+T ).

placed_rooms(Types, Atoms, Places, T, Rooms) :-
    findall(r(R,Type,[edge(R,west,W),edge(R,east,E),edge(R,north,N),edge(R,south,S)]),
            ( member(Type-R, Types),
              memberchk(edge(R,west,W), Atoms), memberchk(edge(R,east,E), Atoms),
              memberchk(edge(R,north,N), Atoms), memberchk(edge(R,south,S), Atoms) ),
            Found),
    maplist(room_sides(Places, T), Found, Rooms).

placed_voids(Atoms, Places, T, Voids) :- findall(void-V, member(void(V), Atoms), Free), placed_rooms(Free, Atoms, Places, T, Voids).

%   unit_sizes(+Given, +Atoms, +Units, -Constraints): the size of each unit. The reasons are the unit's atom and its edges.

unit_sizes([], _, _, []).
unit_sizes([size(B,Axis,Depth,Low,High)|Given], Atoms, Units, [(D = Depth)-Why,(Low =< W)-Why,(W =< High)-Why|Constraints]) :-
    memberchk(room(B,_,sides(X1,X2,Y1,Y2),edges(E1,E2,E3,E4)), Units),
    memberchk(unit(B,K), Atoms),
    ( Axis == x -> D = X2-X1, W = Y2-Y1 ; D = Y2-Y1, W = X2-X1 ),
    Why = [unit(B,K),E1,E2,E3,E4],
    unit_sizes(Given, Atoms, Units, Constraints).

room_sides(Places, T, r(R,Type,Edges), room(R,Type,sides(X1,X2,Y1,Y2),AsTerm)) :-
    maplist(line_place(Places), Edges, [West,X2,North,Y2]),
    maplist(wall_face(T), [West,North], [X1,Y1]),
    AsTerm =.. [edges|Edges].

line_place(Places, edge(_,_,Line), X) :- get_assoc(Line, Places, X).

%!  unsampled(+Atoms, +Plan, +System) is semidet.
%
%   On a grid no whole numbers satisfy the System, or no plan is of the area that the grammar states.

unsampled(Atoms, Plan, System) :-
    once(( on_grid ; Plan = plan(_,Rooms), totals(Atoms, Rooms, [_|_]) )),
    \+ call(plan_sample(real-any, Atoms, Plan, System), 0, _),
    \+ call(plan_sample(rational-0, Atoms, Plan, System), 0, _).

%!  fewest_unknowns_first(+Constraints, -Ordered) is det.

fewest_unknowns_first(Constraints, Ordered) :-
    map_list_to_pairs(unknowns, Constraints, Keyed),
    keysort(Keyed, Sorted),
    pairs_values(Sorted, Ordered).

unknowns(Constraint-_, Count) :- term_variables(Constraint, Variables), length(Variables, Count).

%!  unit_range(+Atoms, +Axis, +Depth, +Proof, -Answer) is det.
%
%   The unit has these rooms and this Depth along the Axis. Answer is range(Low,High): along the other axis the unit can have any length
%   from Low to High. Or Answer is infeasible(Reasons), as in walls_placed//4.

unit_range(Atoms, Axis, Depth, Proof, Answer) :-
    ( Axis == x -> Deep = outline(east), Long = outline(south) ; Deep = outline(south), Long = outline(east) ),
    wall_system(Atoms, [at(Deep,Depth)], plan(Lines,_), System),
    memberchk(Long-X, Lines),
    (   findall(Range, ( posted(System), extremes(X, Range) ), [Low-High])
    ->  Answer = range(Low,High)
    ;   exact_conflict(Proof, System, Conflict)
    ->  refuted(Conflict, Answer)
    ;   findall(L-H, ( exactly_posted(System), clpq:inf(X, L0), clpq:sup(X, H0), L is float(L0), H is float(H0) ), [Low-High]),
        Answer = range(Low,High) ).

% - sizes --------------------------------------------------------------------------------------------------------

all_rooms([], _)             --> [].
all_rooms([Room|Rooms], Atoms) --> { room_size_constraints(Room, Atoms, Constraints) }, because(Constraints), all_rooms(Rooms, Atoms).

%   all_voids(+Voids, +Atoms)//: a void is at least a metre wide and deep. The grammar may state its size, by room_size/3 of the type
%   `void`. With a brief, the lines of the brief state the size instead.

all_voids([], _) --> [].
all_voids([room(V,void,sides(X1,X2,Y1,Y2),edges(West,East,North,South))|Voids], Atoms) -->
    { in_unit(1.0, Least) },
    [(X1+Least =< X2)-[West,East], (Y1+Least =< Y2)-[North,South]],
    (   { \+ of_brief(Atoms), clause(grammar:room_size(Type,_,_), _), Type == void }
    ->  { room_system(void, W, D, System), maplist(because_of([void(V),West,East,North,South]), System, Sizes), W = X2-X1, D = Y2-Y1 },
        because(Sizes)
    ;   [] ),
    all_voids(Voids, Atoms).

because_of(Atoms, C-Why, C-All) :- append(Why, Atoms, All).

because([])     --> [].
because([C|Cs]) --> [C], because(Cs).

room_size_constraints(Room, Atoms, Constraints) :-
    room_sized(Atoms, Room, sized(T,W,D,Own,Across,Along)),
    append([Own,Across], Wide), append([Own,Along], Deep), append([Own,Across,Along], Both),
    Room = room(R,_,_,_),
    ( ( memberchk(thorough, Atoms) ; has_area(Atoms, R) ) -> room_size_system(T, W0, D0, System) ; room_system(T, W0, D0, System) ),
    maplist(explained(W0, D0, Wide, Deep, Both), System, Sizes),
    W0 = W, D0 = D,
    ( memberchk(runs(_,_), Own), \+ always_longer(T) -> Constraints = [(W =< D)-Both|Sizes] ; Constraints = Sizes ).

%   all_same_sizes(+Atoms, +Rooms)//: each room of a type with same_size/1 is as wide and as deep as the next room of that type. For an
%   oblong type, the length across is the width and the length along is the depth.

all_same_sizes(Atoms, Rooms) -->
    { findall(T, member(same_size(T), Atoms), Types), maplist(room_sized(Atoms), Rooms, Sized) },
    types_same(Types, Sized).

types_same([], _) --> [].
types_same([T|Types], Sized) -->
    { include(sized_of(T), Sized, Same) },
    each_as_next(Same),
    types_same(Types, Sized).

sized_of(T, sized(T,_,_,_,_,_)).

each_as_next([sized(T,W1,D1,Own1,Across1,Along1),Next|Same]) --> !,
    { Next = sized(T,W2,D2,Own2,Across2,Along2),
      append([[same_size(T)],Own1,Own2,Across1,Across2], Wide), append([[same_size(T)],Own1,Own2,Along1,Along2], Deep) },
    [(W1 = W2)-Wide, (D1 = D2)-Deep],
    each_as_next([Next|Same]).
each_as_next(_) --> [].

%   room_sized(+Atoms, +Room, -Sized): Sized is sized(Type,W,D,Own,Across,Along): the width W, the depth D, and the reasons. Own has the
%   room's own atoms, Across the edges of its width, Along those of its depth. The depth of a room that runs along x is along x: see
%   oblong/1.

room_sized(Atoms, room(R,T,sides(X1,X2,Y1,Y2),edges(West,East,North,South)), Sized) :-
    (   memberchk(runs(R,x), Atoms)
    ->  Sized = sized(T,Y2-Y1,X2-X1,[room(R,T),runs(R,x)],[North,South],[West,East])
    ;   ( memberchk(runs(R,y), Atoms) -> Own = [room(R,T),runs(R,y)] ; Own = [room(R,T)] ),
        Sized = sized(T,X2-X1,Y2-Y1,Own,[West,East],[North,South]) ).

explained(W, D, Wide, Deep, Both, C-Why, C-All) :-
    term_variables(C, Variables),
    ( Variables == [W] -> Atoms = Wide ; Variables == [D] -> Atoms = Deep ; Atoms = Both ),
    append(Why, Atoms, All).
