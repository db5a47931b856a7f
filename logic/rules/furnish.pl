:- module(furnish, [furnished//4, furnished//5, conflict_without/4, whole_system/4]).

/** <module> Sizes and places for a room's furniture: a random solution, or why there is none

Sizes are sampled by their own clauses first (filled.pl), and kept if CLP(R) finds that all can stand so: most can, and
what is left to solve is small then. Try after try the room is sampled nearer to its largest and the furniture nearer to
its least. Where that does not help, CLP(R) decides with every size unknown: it finds a conflict, or the sizes are
sampled one by one in what is left for each. Places are sampled last, by the gap law of chain.pl.
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(chain).
:- use_module(filled).
:- use_module(grammar_files).
:- use_module(grid).
:- use_module(laws).
:- use_module(lengths).
:- use_module(linear).
:- use_module(record_access).
:- use_module(records).
:- use_module(room).
:- use_module(sample).
:- use_module(sizes).

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

furnished(Type, Layout, shape(W,D,Doors), Proof, Answer) -->
    { layout_room(Type, Layout, Doors, Room),
      room_width(Room, W), room_depth(Room, D) },
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
    { Item = item(F,_,_,Wall), piece_law(Type, F, Law), law_at_wall(Law, Wall, Here) },
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
item_sample(clause, _, item(F,L,D,Wall))            --> own_store(L-D, item_clause_sample(F, L, D, Wall)).

item_clause_sample(F, L, D, Wall) -->
    { sized(piece_size(F, L, D, Wall)) },
    projection_sample(L),
    projection_sample(D).

%   own_store(?Result, :Sample)//: what Sample posts is in a store of its own, which ends with it; Result is numbers.

own_store(Result, Sample, S0, S) :- findall(Result-S1, once(call(Sample, S0, S1)), [Result-S]).

filling_constraints([], _, [], []).
filling_constraints([fill(Law,Along,Item)|Filling], Type, [Along|Alongs], Constraints) :-
    filling_range(Law, Type, Along, Item, Own),
    append(Own, Others, Constraints),
    filling_constraints(Filling, Type, Alongs, Others).

filling_range(box(L1,L2,D1,D2), _, Along, item(_,L,_,_), [(Low =< Along)-[], (Along =< High)-[]]) :- !,
    ( Along == L -> rounded_range(L1-L2, Low-High) ; rounded_range(D1-D2, Low-High) ).
filling_range(_, Type, _, Item, Constraints) :- item_size_system(Type, Item, Constraints).

% - places -------------------------------------------------------------------------------------------------

door_sample(Alongs, Constraints, Door) -->
    { posted(Constraints) },
    all_projections_sample(Alongs),
    projection_sample(Door).

places_sample(Room) --> { length_of(passage, P), room_chains(Room, Chains) }, all_chains_sample(Chains, P).

% - with every size unknown --------------------------------------------------------------------------------

solution_sample(Room, Constraints, Proof, Answer) -->
    { room_items(Room, Items), room_width(Room, W), room_depth(Room, D),
      ( lattice(whole), var(W) -> Kind = whole ; Kind = real ),
      system(Room, Items, Constraints, System) },
    own_store(Outcome, sizes_sample(Kind, Room, Items, Constraints, System, Outcome)),
    (   { Outcome = sizes(Items,W,D) }
    ->  { widest_core(Room), room_door(Room, Door), Answer = Room },
        own_store(Door, door_sample([], Constraints, Door)),
        places_sample(Room)
    ;   { Outcome = fitting(Count), conflict_at(Proof, System, Count, Conflict) }
    ->  { infeasible(Conflict, Answer) }
    ;   { infeasible(System, Answer) } ).

%   sizes_sample(+Kind, ?Room, ?Items, +Constraints, +System, -Outcome)//: Outcome is sizes(Items,Width,Depth), every size in
%   what the others leave, or fitting(Count) where only the first Count of the System fit. On a grid some whole width and
%   depth may take the furniture where others do not: all are tried, in random order, and Count is all if none does.

sizes_sample(real, Room, Items, _, System, Outcome) -->
    { posted(System, Count) },
    (   { length(System, Count) },
        unknown_sizes_sample(Room, Items)
    ->  { sizes(Room, Items, Outcome) }
    ;   { Outcome = fitting(Count) } ).
sizes_sample(whole, Room, Items, Constraints, System, Outcome) -->
    { findall(C, posted(System, C), [Count]) },
    (   { length(System, Count),
          room_type(Room, Type),
          room_extent(Type, W1-W2, D1-D2), numlist(W1, W2, Ws), numlist(D1, D2, Ds),
          findall(A-B, ( member(A, Ws), member(B, Ds) ), Pairs) },
        order_sample(Pairs, Order),
        whole_sizes_sample(Order, Room, Items, Constraints)
    ->  { sizes(Room, Items, Outcome) }
    ;   { Outcome = fitting(Count) } ).

sizes(Room, Items, sizes(Items,W,D)) :- room_width(Room, W), room_depth(Room, D).

whole_sizes_sample(Pairs, Room, Items, Constraints, S0, S) :-
    room_width(Room, W), room_depth(Room, D),
    member(W-D, Pairs),
    system(Room, Items, Constraints, System),
    posted(System),
    call(unknown_sizes_sample(Room, Items), S0, S), !.

order_sample(List, Order) --> keyed(List, Keyed), { keysort(Keyed, Sorted), pairs_values(Sorted, Order) }.

keyed([], [])              --> [].
keyed([X|Xs], [U-X|Keyed]) --> unit_sample(U), keyed(Xs, Keyed).

unknown_sizes_sample(Room, Items) -->
    { room_width(Room, W), room_depth(Room, D) },
    item_sizes_sample(Items),
    projection_sample(W),
    projection_sample(D).

item_sizes_sample([])                      --> [].
item_sizes_sample([_-item(_,L,D,_)|Items]) --> projection_sample(L), projection_sample(D), item_sizes_sample(Items).

%   system(+Room, +Items, +Constraints, -All): with the constraints of the sizes too.

system(Room, Items, Constraints, All) :-
    room_type(Room, Type), room_width(Room, W), room_depth(Room, D),
    ( number(W), number(D) -> Outline = [] ; room_size_system(Type, W, D, Outline) ),
    maplist(kind_item_system(Type), Items, Systems),
    append([Outline|Systems], Sizes),
    append(Sizes, Constraints, All).

kind_item_system(Type, _-Item, System) :- item_size_system(Type, Item, System).

infeasible(Conflict, infeasible(Reasons)) :-
    findall(Reason, ( member(_-Why, Conflict), member(Reason, Why) ), Found),
    sort(Found, Reasons).

%!  conflict_without(+Type, +Layout, +Without, -Reasons) is semidet.
%
%   Reasons are those of a minimal conflict of a room with this furniture, where the clauses Without are left out.

conflict_without(Type, Layout, Without, Reasons) :-
    whole_system(Type, Layout, Room, System),
    room_items(Room, Items),
    exclude(resting_on(Without), System, Rest),
    phrase(positive(Items), Positive),
    append(Positive, Rest, All),
    minimal_conflict(All, Conflict),
    infeasible(Conflict, infeasible(Reasons)).

%   A size without its clause is still a size.

positive([])                      --> [].
positive([_-item(_,L,D,_)|Items]) --> [(0 =< L)-[], (0 =< D)-[]], positive(Items).

resting_on(Without, _-Why) :- member(Reason, Why), memberchk(Reason, Without), !.

%!  whole_system(+Type, +Layout, -Room, -System) is det.
%
%   System is the whole linear system of a Room with this furniture, every size unknown.

whole_system(Type, Layout, Room, System) :-
    layout_room(Type, Layout, Room),
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    system(Room, Items, Constraints, System).
