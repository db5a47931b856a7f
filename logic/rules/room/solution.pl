:- module(solution, [solution_sample//4, conflict_without/4, system_conflict/4, whole_system/4, whole_system/5, shaped_room/4,
                     system_sample//2, own_store//2, door_sample//3, places_sample//1]).

/** <module> A room's furniture with every size unknown: a random solution, or why there is none

CLP(R) decides, and the sizes are sampled one by one in what is left for each. What it refutes is confirmed by CLP(Q), which
samples a solution where there is one after all.
*/

:- use_module(library(apply)).
:- use_module(library(apply_macros)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(library(yall)).
:- use_module('../linear/chain').
:- use_module('../linear/exact').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module(record_access).
:- use_module(records).
:- use_module(room).
:- use_module('../linear/sample').
:- use_module('../language/sizes').

%!  solution_sample(?Room, +Constraints, +Proof, -Answer)// is det.
%
%   Answer is as in furnished//4, of a Room with these Constraints but those of its sizes.

solution_sample(Room, Constraints, Proof, Answer) -->
    { room_items(Room, Items), room_width(Room, W), room_depth(Room, D),
      ( lattice(whole), var(W) -> Kind = whole ; Kind = real ),
      system(Room, Items, Constraints, System) },
    own_store(Outcome, sizes_sample(Kind, Room, Items, Constraints, System, Outcome)),
    (   { Outcome = sizes(Items,W,D) },
        rest_sample(Room, Constraints)
    ->  { Answer = Room }
    ;   { Outcome = fitting(Count), exact_conflict(Proof, System, Count, Conflict) }
    ->  { infeasible(Conflict, Answer) }
    ;   exact_sample(Kind, Room, Items, Constraints)         % CLP(R) was wrong
    ->  { Answer = Room }
    ;   { infeasible(System, Answer) } ).

rest_sample(Room, Constraints) -->
    { widest_core(Room), room_door(Room, Door) },
    own_store(Door, door_sample([], Constraints, Door)),
    places_sample(Room).

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
    (   { length(System, Count) },
        whole_sizes_sample(known_outline_sample(Room, Items, Constraints), Room)
    ->  { sizes(Room, Items, Outcome) }
    ;   { Outcome = fitting(Count) } ).

sizes(Room, Items, sizes(Items,W,D)) :- room_width(Room, W), room_depth(Room, D).

%   whole_sizes_sample(:Sample, ?Room)//: Sample, with the first of the sizes of the room on a grid that it takes.

whole_sizes_sample(Sample, Room) -->
    { room_type(Room, Type), room_extent(Type, W1-W2, D1-D2), numlist(W1, W2, Ws), numlist(D1, D2, Ds),
      findall(W-D, ( member(W, Ws), member(D, Ds) ), Pairs) },
    order_sample(Pairs, Order),
    first_sample(Order, Sample, Room).

first_sample(Pairs, Sample, Room, S0, S) :-
    room_width(Room, W), room_depth(Room, D),
    member(W-D, Pairs),
    call(Sample, S0, S), !.

known_outline_sample(Room, Items, Constraints) -->
    { system(Room, Items, Constraints, System), posted(System) },
    unknown_sizes_sample(Room, Items).

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

%   exact_sample(+Kind, ?Room, ?Items, +Constraints)// is semidet: the same in CLP(Q), and all else in the room; fails where
%   there is no solution.

exact_sample(whole, Room, Items, Constraints) -->
    whole_sizes_sample(exact_sample(real, Room, Items, Constraints), Room).
exact_sample(real, Room, Items, Constraints) -->
    { system(Room, Items, Constraints, System),
      room_width(Room, W), room_depth(Room, D), room_door(Room, Door),
      foldl(item_lengths, Items, Unknowns, [W,D,Door]) },
    own_store(Rationals, exact_lengths_sample(System, Unknowns, Rationals)),
    { maplist(nearest_length, Rationals, Unknowns), widest_core(Room) },
    places_sample(Room).

item_lengths(_-item(_,L,D,_), [L,D|Unknowns], Unknowns).

exact_lengths_sample(System, Unknowns, Unknowns) -->
    { exactly_posted(System), maplist([X,1-X]>>true, Unknowns, Pairs) },
    exactly_sampled(Pairs).

%!  system_sample(+System, ?Unknowns)// is semidet: some unknowns of a linear system are sampled, if it has a solution.

system_sample(System, Unknowns) -->
    (   own_store(Unknowns, posted_sample(System, Unknowns))
    ->  []
    ;   own_store(Rationals, exact_lengths_sample(System, Unknowns, Rationals)),
        { maplist(nearest_length, Rationals, Unknowns) } ).

posted_sample(System, Unknowns) --> { posted(System) }, all_projections_sample(Unknowns).

nearest_length(X, Length) :- ( number(Length) -> true ; on_grid -> Length = X ; Length is float(X) ).

% - the store of a solver -------------------------------------------------------------------------------------

%!  own_store(?Result, :Sample)// is semidet.
%
%   What Sample posts is in a store of its own, which ends with it; Result is numbers.

:- meta_predicate own_store(?, 2, +, -).

own_store(Result, Sample, S0, S) :- findall(Result-S1, once(call(Sample, S0, S1)), [Result-S]).

%!  door_sample(?Alongs, +Constraints, ?Door)// is semidet.
%
%   The lengths Alongs and the door's place are sampled, where all else that the constraints hold is known.

door_sample(Alongs, Constraints, Door) -->
    { posted(Constraints) },
    all_projections_sample(Alongs),
    projection_sample(Door).

%!  places_sample(?Room)// is semidet: the places of all furniture, by the gap law of chain.pl.

places_sample(Room) --> { length_of(passage, P), room_chains(Room, Chains) }, all_chains_sample(Chains, P).

% - the linear system ------------------------------------------------------------------------------------------

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
    system_conflict(Room, System, Without, Reasons).

%!  system_conflict(+Room, +System, +Without, -Reasons) is semidet: the same of the linear System of a Room.

system_conflict(Room, System, Without, Reasons) :-
    room_items(Room, Items),
    exclude(resting_on(Without), System, Rest),
    phrase(positive(Items), Positive),
    append(Positive, Rest, All),
    findall(Count, posted(All, Count), [Count]),
    \+ length(All, Count),
    exact_conflict(minimal, All, Count, Conflict),
    infeasible(Conflict, infeasible(Reasons)).

%   A size without its clause is still a size.

positive([])                      --> [].
positive([_-item(_,L,D,_)|Items]) --> [(0 =< L)-[], (0 =< D)-[]], positive(Items).

resting_on(Without, _-Why) :- member(Reason, Why), memberchk(Reason, Without), !.

%!  whole_system(+Type, +Layout, -Room, -System) is det.
%!  whole_system(+Type, +Layout, +Shape, -Room, -System) is det.
%
%   System is the whole linear system of a Room with this furniture, every size unknown but those of a known Shape with its doors.

whole_system(Type, Layout, Room, System) :- whole_system(Type, Layout, any, Room, System).

whole_system(Type, Layout, sized(_,_), Room, System) :- !, whole_system(Type, Layout, any, Room, System).
whole_system(Type, Layout, Shape, Room, System) :-
    shaped_room(Type, Layout, Shape, Room),
    room_system(Room, System).

room_system(Room, System) :-
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    system(Room, Items, Constraints, System).

%!  shaped_room(+Type, +Layout, +Shape, -Room) is det.
%
%   Room has this furniture and a known Shape, shape(Width,Depth,Doors), see records.pl; `sized(Width,Depth)`, of which the door is not
%   known; or `any`.

shaped_room(Type, Layout, any, Room) :- !, layout_room(Type, Layout, Room).
shaped_room(Type, Layout, sized(W,D), Room) :- !, layout_room(Type, Layout, Room), room_width(Room, W), room_depth(Room, D).
shaped_room(Type, Layout, shape(W,D,Doors), Room) :-
    layout_room(Type, Layout, Doors, Room),
    room_width(Room, W), room_depth(Room, D).
