:- module(furnish, [furnished//4, furnished//5]).

/** <module> Sizes and places for a room's furniture: a random solution, or why there is none

Sizes are sampled by their own clauses first (filled.pl), and kept if CLP(R) finds that all can stand so: most can, and
what is left to solve is small then. Try after try the room is sampled nearer to its largest and the furniture nearer to
its least. Where that does not help, every size is unknown (solution.pl): there is a conflict, or a solution after all.
Places are sampled last, by the gap law of chain.pl.
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(filled).
:- use_module('../language/grammar_files').
:- use_module('../linear/grid').
:- use_module('../language/laws').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module(record_access).
:- use_module(records).
:- use_module(room).
:- use_module('../linear/sample').
:- use_module('../language/sizes').
:- use_module(solution).

%!  furnished(+Type, +Layout, +Proof, -Answer)// is det.
%
%   Answer is the room (records.pl), every length of it known, or infeasible(Reasons): reasons why a room of this type
%   cannot have this furniture, a minimal set of them where Proof is `minimal`. Where it is `quick` they cost a fifth.

furnished(Type, Layout, Proof, Answer) -->
    { layout_room(Type, Layout, Room) },
    room_furnished(Room, Proof, Answer).

%!  furnished(+Type, +Layout, +Shape, +Proof, -Answer)// is det.
%
%   The same in a room of a known Shape, shape(Width,Depth,Doors), see records.pl.

furnished(Type, Layout, Shape, Proof, Answer) -->
    { shaped_room(Type, Layout, Shape, Room) },
    room_furnished(Room, Proof, Answer).

room_furnished(Room, Proof, Answer) -->
    { phrase(room_constraints(Room), Constraints) },
    (   tries_sample(Room, Constraints)
    ->  { Answer = Room }
    ;   solution_sample(Room, Constraints, Proof, Answer) ).

% - sizes by their own clauses -----------------------------------------------------------------------------

%   try(?Try, -Ease): how much of its range each size is sampled in.

try(1, 1.0).
try(2, 1.0).
try(3, 0.8).
try(4, 0.6).
try(5, 0.4).
try(6, 0.2).
try(7, 0.0).

tries_sample(Room, Constraints, S0, S) :-
    room_type(Room, Type), room_items(Room, Items),
    room_law(Type, Law0),
    filled_law(Room, Law0, Law),
    try(Try, Ease),
    Seed is S0 xor (Try << 32),            % each try with random numbers of its own
    call(try_sample(Ease, Room, Items, Law, Constraints), Seed, S), !.

try_sample(Ease, Room, Items, Law, Constraints) -->
    { room_type(Room, Type) },
    room_sample(Law, Ease, Room),
    items_sample(Items, Type, Ease, Filling),
    { widest_core(Room),
      room_door(Room, Door) },
    (   { Filling == [], number(Door) }
    ->  { phrase(door_constraints(Room), All), posted(All) }
    ;   { Filling == [], free_front(Room) }
    ->  { phrase(door_constraints(Room), All), interval(Door, All, Low-High) },
        ( { High - Low < 1.0e-10 } -> { Door = Low } ; interval_sample(Low, High, 1, Door) )   % as CLP(R) would
    ;   { filling_constraints(Filling, Type, Alongs, Filled),
          append(Filled, Constraints, All) },
        own_store(Door-Alongs, door_sample(Alongs, All, Door)) ),
    places_sample(Room).

free_front(Room) :- room_stretches(Room, [stretch(front_left,[],_),_,_,_,stretch(front_right,[],_)]).

%   room_sample(+Law, +Ease, ?Room)//: the width and depth by their law.

room_sample(Law, Ease, Room) -->
    { room_type(Room, Type), room_width(Room, W), room_depth(Room, D) },
    ( { number(W), number(D) } -> [] ; room_sizes_sample(Law, Type, Ease, W, D) ).

room_sizes_sample(box(A1,A2,B1,B2), _, Ease, W, D) --> large_sample(A1-A2, Ease, W), large_sample(B1-B2, Ease, D).
room_sizes_sample(line(A1,A2,B1,B2), _, Ease, W, D) -->
    unit_sample(U),
    { V is 1-U*Ease, W is A1 + V*(A2-A1), D is B1 + V*(B2-B1) }.
room_sizes_sample(clause, Type, _, W, D) --> own_store(W-D, room_clause_sample(Type, W, D)).

room_clause_sample(Type, W, D) -->
    { sized(room_size(Type, W, D)) },
    all_projections_sample([W,D]).

%   large_sample(+Range, +Ease, -Size)// and small_sample: in the upper or lower part of a range of metres.

large_sample(Range, Ease, Size) -->
    { rounded_range(Range, Low-High), Low1 is High - Ease*(High-Low) },
    interval_sample(Low1, High, 1, Size).

small_sample(Range, Ease, Size) -->
    { rounded_range(Range, Low-High), High1 is Low + Ease*(High-Low) },
    interval_sample(Low, High1, 1, Size).

%   items_sample(?Items, +Type, +Ease, -Filling)//: of what fills a stretch, the length along it is left to the solver.

items_sample([], _, _, []) --> [].
items_sample([Kind-Item|Items], Type, Ease, Filling) -->
    { Item = item(F,_,_,Walls), piece_law(Type, F, Law), law_at_wall(Law, Walls, Here) },
    (   { Kind = filling(Along,Out) }
    ->  own_store(Out, item_sample(Here, Ease, Item)),
        { Filling = [fill(Here,Along,Item)|Others] }
    ;   item_sample(Here, Ease, Item),
        { Filling = Others } ),
    items_sample(Items, Type, Ease, Others).

item_sample(box(L1,L2,D1,D2), Ease, item(_,L,D,_))  --> small_sample(L1-L2, Ease, L), small_sample(D1-D2, Ease, D).
item_sample(line(L1,L2,D1,D2), Ease, item(_,L,D,_)) -->
    unit_sample(U),
    { V is U*Ease, L is L1 + V*(L2-L1), D is D1 + V*(D2-D1) }.
item_sample(clause, _, item(F,L,D,Walls))           --> { on_grid }, !,
    { item_extent(_, item(F,L,D,Walls), L1-L2, D1-D2) },
    interval_sample(L1, L2, 1, L),
    interval_sample(D1, D2, 1, D).
item_sample(clause, _, item(F,L,D,Walls))           --> own_store(L-D, item_clause_sample(F, L, D, Walls)).

item_clause_sample(F, L, D, Walls) -->
    { piece_sized(F, L, D, Walls) },
    projection_sample(L),
    projection_sample(D).

filling_constraints([], _, [], []).
filling_constraints([fill(Law,Along,Item)|Filling], Type, [Along|Alongs], Constraints) :-
    filling_range(Law, Type, Along, Item, Own),
    append(Own, Others, Constraints),
    filling_constraints(Filling, Type, Alongs, Others).

filling_range(box(L1,L2,D1,D2), _, Along, item(_,L,_,_), [(Low =< Along)-[], (Along =< High)-[]]) :- !,
    ( Along == L -> rounded_range(L1-L2, Low-High) ; rounded_range(D1-D2, Low-High) ).
filling_range(_, Type, _, Item, Constraints) :- item_size_system(Type, Item, Constraints).
