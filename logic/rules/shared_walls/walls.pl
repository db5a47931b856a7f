:- module(walls, [walls_placed//4, wall_system/3, unit_range/5, off_grid/2, fewest_unknowns_first/2]).

/** <module> Stage 2 of plans: where walls, doors and windows are, for any topology

A topology says on which line each side of a room lies: edge(R,Side,Line). The unknowns are the places of these lines: x
where they run from north to south, y where they run from west to east, and the plan's north-west corner is (0,0). All
constraints are linear (areas.pl), each with the atoms and clauses that make it. A room is here

    room(R,Type,sides(X1,X2,Y1,Y2),edges(West,East,North,South))     with its edge/3 atoms

Of a house of units, these are placed first, as rooms of the type `unit`, and then the rooms of each. What is Given says so:

    at(Line,Place)                  this line is there: of a unit that has its place, the four lines of its outline
    size(B,Axis,Depth,Low,High)     the unit B is so deep along the axis, and from Low to High along the other one
*/

:- use_module(library(apply)).
:- use_module(library(assoc)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(areas).
:- use_module(contacts).
:- use_module('../linear/exact').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module(openings).
:- use_module('../linear/sample').

%!  walls_placed(+Atoms, +Given, +Proof, -Answer)// is det.
%
%   Answer is plan(Rooms,Doors,Windows), a random solution (openings.pl), or infeasible(Reasons), proved in rational
%   arithmetic; the reasons are those of a minimal conflict where Proof is `minimal`.

walls_placed(Atoms, Given, Proof, Answer) -->
    { wall_system(Atoms, Given, plan(Lines,Rooms), System) },
    (   lines_sample(real, Lines, Rooms, System)
    ->  plan_openings(Atoms, Rooms, Answer)
    ;   { exact_conflict(Proof, System, Conflict) }
    ->  { refuted(Conflict, Answer) }
    ;   lines_sample(rational, Lines, Rooms, System)       % CLP(R) was wrong
    ->  plan_openings(Atoms, Rooms, Answer)
    ;   { refuted(System, Answer) } ).                     % on a grid: no whole numbers satisfy them

refuted(Conflict, infeasible(Reasons)) :-
    findall(Reason, ( member(_-Why, Conflict), member(Reason, Why) ), Found),
    sort(Found, Reasons).

%!  wall_system(+Atoms, -Plan, -System) is det.
%
%   Plan is plan(Lines,Rooms), Lines a list of Name-Place; System are all constraints of it, those with the fewest unknowns
%   first: in that order CLP(R) is least often wrong.

wall_system(Atoms, Plan, System) :- wall_system(Atoms, [], Plan, System).

wall_system(Atoms, Given, plan(Lines,All), System) :-
    findall(Line, member(edge(_,_,Line), Atoms), Names0), sort(Names0, Names),
    pairs_keys(Lines, Names),
    list_to_assoc(Lines, Places),
    forall_given(Given, Places),
    maplist(get_assoc_of(Places), [outline(west),outline(east),outline(north),outline(south)], [West,East,North,South]),
    maplist(zero_unless_known, [West,North]),
    findall(T-R, member(room(R,T), Atoms), Types), placed_rooms(Types, Atoms, Places, Rooms),
    findall(unit-B, member(unit(B,_), Atoms), Units0), placed_rooms(Units0, Atoms, Places, Units),
    append(Rooms, Units, All),
    ( Units == [] -> house_system(East-West, South-North, Whole) ; unit_sizes(Given, Atoms, Units, Whole) ),
    phrase(( all_rooms(Rooms, Atoms), all_openings(Atoms, Rooms), all_contacts(Atoms, Rooms) ), Each),
    ( memberchk(bounded, Atoms) -> foldl(within(West-East, North-South), Rooms, Each, Within) ; Within = Each ),
    findall(court(L,M), member(court(L,M), Atoms), Courts),
    foldl(court_between(Places), Courts, Within, Inside),
    append(Whole, Inside, Constraints),
    fewest_unknowns_first(Constraints, System).

%   within(+Along, +Down, +Room, +Constraints, -More): the room lies between the lines of the outline.

within(West-East, North-South, room(_,_,sides(X1,X2,Y1,Y2),edges(W,E,N,S)), Constraints,
       [(West =< X1)-[bounded,W],(X2 =< East)-[bounded,E],(North =< Y1)-[bounded,N],(Y2 =< South)-[bounded,S]|Constraints]).

%   court_between(+Places, +Court, +Constraints, -More): a narrower court is a slit.

court_between(Places, court(L,M), Constraints, [(X+Least =< Y)-[court(L,M)]|Constraints]) :-
    get_assoc(L, Places, X), get_assoc(M, Places, Y), !,
    in_unit(0.5, Least).
court_between(_, _, Constraints, Constraints).

forall_given([], _).
forall_given([at(Line,X)|Given], Places) :- !, get_assoc(Line, Places, X), forall_given(Given, Places).
forall_given([_|Given], Places) :- forall_given(Given, Places).

get_assoc_of(Places, Line, X) :- get_assoc(Line, Places, X).

zero_unless_known(X) :- ( var(X) -> X = 0.0 ; true ).

placed_rooms(Types, Atoms, Places, Rooms) :-
    findall(r(R,T,[edge(R,west,W),edge(R,east,E),edge(R,north,N),edge(R,south,S)]),
            ( member(T-R, Types),
              memberchk(edge(R,west,W), Atoms), memberchk(edge(R,east,E), Atoms),
              memberchk(edge(R,north,N), Atoms), memberchk(edge(R,south,S), Atoms) ),
            Found),
    maplist(room_sides(Places), Found, Rooms).

%   unit_sizes(+Given, +Atoms, +Units, -Constraints): the size of each unit, because of it and its place.

unit_sizes([], _, _, []).
unit_sizes([size(B,Axis,Depth,Low,High)|Given], Atoms, Units, [(D = Depth)-Why,(Low =< W)-Why,(W =< High)-Why|Constraints]) :-
    memberchk(room(B,_,sides(X1,X2,Y1,Y2),edges(E1,E2,E3,E4)), Units),
    memberchk(unit(B,K), Atoms),
    ( Axis == x -> D = X2-X1, W = Y2-Y1 ; D = Y2-Y1, W = X2-X1 ),
    Why = [unit(B,K),E1,E2,E3,E4],
    unit_sizes(Given, Atoms, Units, Constraints).

room_sides(Places, r(R,T,Edges), room(R,T,Sides,AsTerm)) :-
    maplist(line_place(Places), Edges, Xs),
    Sides =.. [sides|Xs], AsTerm =.. [edges|Edges].

line_place(Places, edge(_,_,Line), X) :- get_assoc(Line, Places, X).

%!  fewest_unknowns_first(+Constraints, -Ordered) is det.

fewest_unknowns_first(Constraints, Ordered) :-
    map_list_to_pairs(unknowns, Constraints, Keyed),
    keysort(Keyed, Sorted),
    pairs_values(Sorted, Ordered).

unknowns(Constraint-_, Count) :- term_variables(Constraint, Variables), length(Variables, Count).

%!  unit_range(+Atoms, +Axis, +Depth, +Proof, -Answer) is det.
%
%   Answer is range(Low,High), how long a unit with these rooms may be along the other axis where it is this deep along
%   the Axis: anything between is possible. Or infeasible(Reasons), as in walls_placed//4.

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

because([])     --> [].
because([C|Cs]) --> [C], because(Cs).

%   A room that runs along x has its depth there, see oblong/1.

room_size_constraints(room(R,T,sides(X1,X2,Y1,Y2),edges(West,East,North,South)), Atoms, Constraints) :-
    (   memberchk(runs(R,x), Atoms)
    ->  Own = [room(R,T),runs(R,x)], W = Y2-Y1, Across = [North,South], D = X2-X1, Along = [West,East]
    ;   ( memberchk(runs(R,y), Atoms) -> Own = [room(R,T),runs(R,y)] ; Own = [room(R,T)] ),
        W = X2-X1, Across = [West,East], D = Y2-Y1, Along = [North,South] ),
    append([Own,Across], Wide), append([Own,Along], Deep), append([Own,Across,Along], Both),
    room_system(T, W0, D0, System),
    maplist(explained(W0, D0, Wide, Deep, Both), System, Sizes),
    W0 = W, D0 = D,
    ( memberchk(runs(R,_), Atoms), \+ always_longer(T) -> Constraints = [(W =< D)-Both|Sizes] ; Constraints = Sizes ).

explained(W, D, Wide, Deep, Both, C-Why, C-All) :-
    term_variables(C, Variables),
    ( Variables == [W] -> Atoms = Wide ; Variables == [D] -> Atoms = Deep ; Atoms = Both ),
    append(Why, Atoms, All).

% - a random solution --------------------------------------------------------------------------------------------

%   lines_sample(+Arithmetic, ?Lines, +Rooms, +System)// is semidet: every line is a number, sampled in the projection that
%   those before it leave: first the outline, then line by line from the west and from the north. Lines that are still to
%   come up to the outline share the slack, as in chain.pl. Arithmetic is real, or rational and slow.

lines_sample(Arithmetic, Lines, Rooms, System, S0, S) :-
    pairs_values(Lines, Places),
    sampling_order(Lines, Rooms, Order),
    lattice(Kind),
    findall(Places-S1, once(sampled(Arithmetic-Kind, System, Order, S0, S1)), [Found-S]),
    ( Kind == whole -> maplist(nearest_cell, Found, Places) ; Places = Found ).

nearest_cell(X, Cell) :- ( X =:= 0 -> Cell = X ; Cell is round(X) ).

sampled(real-real, System, Order)      --> { posted(System) }, all_sampled(Order).
sampled(rational-real, System, Order)  --> { exactly_posted(System) }, exactly_sampled(Order).
sampled(real-whole, System, Order)     --> { posted(System) }, all_whole_sampled(Order, clpr).
sampled(rational-whole, System, Order) --> { exactly_posted(System) }, all_whole_sampled(Order, clpq).

all_sampled([]) --> [].
all_sampled([Gaps-X|Order]) -->
    (   { number(X) }
    ->  []
    ;   { inf(X, Low), sup(X, High) },
        interval_sample(Low, High, Gaps, V),
        { {X = V} } ),
    all_sampled(Order).

%   all_whole_sampled(+Order, +Solver)// is nondet: whole numbers, each sampled in its projection, then those next to it.

all_whole_sampled([], _) --> [].
all_whole_sampled([Gaps-X|Order], Solver) -->
    (   { number(X) }
    ->  { abs(X - round(X)) < 1.0e-6 }
    ;   { Solver:inf(X, Low), Solver:sup(X, High), First is ceiling(Low - 1.0e-6), Last is floor(High + 1.0e-6), First =< Last },
        interval_sample(First, Last, Gaps, V),
        { findall(Away-N, ( between(First, Last, N), Away is abs(N-V) ), Numbers),
          keysort(Numbers, Nearest),
          member(_-N1, Nearest),
          Solver:{X = N1} } ),
    all_whole_sampled(Order, Solver).

%!  off_grid(+Plan, +System) is semidet.
%
%   On a grid no whole numbers satisfy the System.

off_grid(plan(Lines,Rooms), System) :-
    on_grid,
    \+ call(lines_sample(real, Lines, Rooms, System), 0, _),
    \+ call(lines_sample(rational, Lines, Rooms, System), 0, _).

%   sampling_order(+Lines, +Rooms, -Order): Gaps-Place of the outline and then of the other lines, where Gaps is the most
%   rooms in a row between the line and the outline's east or south side.

sampling_order(Lines, Rooms, [1-Width,1-Depth|Order]) :-
    memberchk(outline(east)-Width, Lines), memberchk(outline(south)-Depth, Lines),
    findall(A-B, ( member(room(_,_,_,edges(edge(_,_,W),edge(_,_,E),edge(_,_,N),edge(_,_,S))), Rooms),
                   ( A = W, B = E ; A = N, B = S ) ), Steps0),
    sort(Steps0, Steps),
    findall(Line-0, member(Line-_, Lines), Zeros),
    list_to_assoc(Zeros, Gaps0),
    farthest(Steps, Gaps0, Gaps),
    findall(N-Line, ( member(Line-_, Lines), \+ Line = outline(_), get_assoc(Line, Gaps, N) ), Ranks0),
    sort(1, @>=, Ranks0, Ranks),
    maplist(ranked(Lines), Ranks, Order).

% From a line that leads to no outline there is one gap.
ranked(Lines, N-Line, Gaps-Place) :- memberchk(Line-Place, Lines), Gaps is max(1, N).

farthest(Steps, Gaps0, Gaps) :-
    foldl(farther, Steps, Gaps0, Gaps1),
    ( Gaps1 == Gaps0 -> Gaps = Gaps0 ; farthest(Steps, Gaps1, Gaps) ).

farther(A-B, Gaps0, Gaps) :-
    get_assoc(A, Gaps0, N), get_assoc(B, Gaps0, M),
    ( M + 1 > N -> N1 is M + 1, put_assoc(A, Gaps0, N1, Gaps) ; Gaps = Gaps0 ).
