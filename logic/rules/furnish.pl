:- module(furnish, [furnished//3, linear_system/3]).

/** <module> Sizes and places for a room's furniture: a random solution, or why there is none

Sizes are drawn by their own clauses first, and kept if CLP(R) finds that all can stand so: most can, and what is
left to solve is small then. Where they cannot, CLP(R) decides with every size unknown. It finds a least clash, or
the sizes are drawn one by one in what is left for each. Places are drawn last, by the gap law of chain.pl.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(chain).
:- use_module(draw).
:- use_module(grammar).
:- use_module(room).
:- use_module(linear).

tries(4).

%!  furnished(+Type, +Layout, -Answer)// is det.
%
%   Answer is the room (room.pl), every length of it known, or clash(Reasons), a least set of reasons why a room of
%   this type cannot have this furniture.

furnished(Type, Layout, Answer) -->
    { room(Type, Layout, Room),
      phrase(room_constraints(Room), Constraints),
      tries(Tries) },
    (   sized_first(Tries, Room, Constraints)
    ->  { Answer = Room }
    ;   solved(Type, Room, Constraints, Answer) ).

%   sized_first(+Tries, ?Room, +Constraints)// is semidet: each try draws with numbers of its own.

sized_first(Tries, Room, Constraints, S0, S) :-
    between(1, Tries, Try),
    Seed is S0 xor (Try << 32),
    call(sized(Room, Constraints), Seed, S), !.

sized(Room, Constraints) -->
    { Room = room(Type,W,D,Door,_,_,_),
      room_law(Type, Law), room_items(Room, Items) },
    drawn_by(Law, Type, W, D),
    draw_items(Items, Filling),
    { widest_core(Room), filling_constraints(Filling, Type, Alongs, Filled),
      append(Filled, Constraints, All) },
    forgotten(Door-Alongs, placed_door(Alongs, All, Door)),
    draw_places(Room).

drawn_by(box(A1,A2,B1,B2), _, A, B)  --> between_ends(A1, A2, 1, A), between_ends(B1, B2, 1, B).
drawn_by(line(A1,A2,B1,B2), _, A, B) --> random(U), { A is A1 + U*(A2-A1), B is B1 + U*(B2-B1) }.
drawn_by(clause, Type, A, B)         --> forgotten(A-B, room_by_clause(Type, A, B)).

room_by_clause(Type, A, B) --> { once(grammar:room_size(Type, A, B)) }, uniform(A), uniform(B).

%   draw_items(+Items, -Filling)//: of what fills a stretch, the length along it is left to the solver.

draw_items([], []) --> [].
draw_items([free-item(F,L,D,Wall)|Items], Filling) -->
    { piece_law(F, Law) },
    item_by(Law, F, L, D, Wall),
    draw_items(Items, Filling).
draw_items([filling(Along,Out)-item(F,L,D,Wall)|Items], [fill(Along,F,L,D,Wall)|Filling]) -->
    { piece_law(F, Law) },
    forgotten(Drawn, filled(Law, F, L, D, Wall, Out, Drawn)),
    { Out = Drawn },
    draw_items(Items, Filling).

item_by(box(L1,L2,D1,D2), _, L, D, _)  --> between_ends(L1, L2, 1, L), between_ends(D1, D2, 1, D).
item_by(line(L1,L2,D1,D2), _, L, D, _) --> random(U), { L is L1 + U*(L2-L1), D is D1 + U*(D2-D1) }.
item_by(clause, F, L, D, Wall)         --> forgotten(L-D, item_by_clause(F, L, D, Wall)).

item_by_clause(F, L, D, Wall) -->
    { lattice(whole) }, !,
    { metres(Wall, Metres), piece_range(F, Metres, L1, L2, D1, D2),
      rounded(L1, L2, LLow, LHigh), rounded(D1, D2, DLow, DHigh) },
    between_ends(LLow, LHigh, 1, L), between_ends(DLow, DHigh, 1, D).
item_by_clause(F, L, D, Wall) --> { once(grammar:piece_size(F, L, D, Wall)) }, uniform(L), uniform(D).

filled(Law, F, L, D, Wall, Out, Out) --> item_by(Law, F, L, D, Wall).

%   forgotten(?Result, :Draw)//: what Draw posts ends with it; Result is numbers.

forgotten(Result, Draw, S0, S) :-
    findall(Result-S1, once(call(Draw, S0, S1)), [Result-S]).

filling_constraints([], _, [], []).
filling_constraints([fill(Along,F,L,D,Wall)|Filling], Type, [Along|Alongs], Constraints) :-
    piece_system(Type, F, L, D, Wall, Own),
    append(Own, Others, Constraints),
    filling_constraints(Filling, Type, Alongs, Others).

placed_door(Alongs, Constraints, Door) -->
    { posted(Constraints) },
    draw_each(Alongs),
    uniform(Door).

draw_each([])     --> [].
draw_each([X|Xs]) --> uniform(X), draw_each(Xs).

draw_places(Room) --> { length_of(passage, P), room_chains(Room, Chains) }, draw_chains(Chains, P).

draw_chains([], _)              --> [].
draw_chains([Chain|Chains], P)  --> draw_chain(P, Chain), draw_chains(Chains, P).

% - with every size unknown ------------------------------------------------------------------------------------

solved(Type, Room, Constraints, Answer) -->
    { Room = room(_,W,D,Door,_,_,_), room_items(Room, Items) },
    (   forgotten(Items-W-D, solved_sizes(Type, W, D, Items, Constraints))
    ->  { widest_core(Room) },
        forgotten(Door, placed_door([], Constraints, Door)),
        { Answer = Room },
        draw_places(Room)
    ;   { why(Type, W, D, Items, Constraints, Answer) } ).

%   solved_sizes(+Type, ?W, ?D, ?Items, +Constraints)// is semidet: draws every size in what the others leave. On a
%   grid some whole W and D may take the furniture where others do not: all are tried, in random order.

solved_sizes(Type, W, D, Items, Constraints) -->
    { lattice(whole) }, !,
    { room_extent(Type, W1, W2, D1, D2), numlist(W1, W2, Ws), numlist(D1, D2, Ds),
      findall(A-B, ( member(A, Ws), member(B, Ds) ), Pairs) },
    shuffled(Pairs, Order),
    sized_whole(Order, Type, W, D, Items, Constraints).
solved_sizes(Type, W, D, Items, Constraints) -->
    { system(Type, W, D, Items, Constraints, All), posted(All) },
    drawn_sizes(Items, W, D).

sized_whole(Pairs, Type, W, D, Items, Constraints, S0, S) :-
    member(W-D, Pairs),
    system(Type, W, D, Items, Constraints, All),
    posted(All),
    call(drawn_sizes(Items, W, D), S0, S), !.

shuffled(List, Shuffled) --> keyed(List, Keyed), { keysort(Keyed, Sorted), pairs_values(Sorted, Shuffled) }.

keyed([], [])             --> [].
keyed([X|Xs], [U-X|Keyed]) --> random(U), keyed(Xs, Keyed).

drawn_sizes(Items, W, D) --> draw_item_sizes(Items), uniform(W), uniform(D).

draw_item_sizes([])                     --> [].
draw_item_sizes([_-item(_,L,D,_)|Items]) --> uniform(L), uniform(D), draw_item_sizes(Items).

%   system(+Type, ?W, ?D, +Items, +Constraints, -All): with the constraints of the sizes too.

system(Type, W, D, Items, Constraints, All) :-
    room_system(Type, W, D, Outline),
    item_systems(Items, Type, Systems),
    append([Outline|Systems], Sizes),
    append(Sizes, Constraints, All).

item_systems([], _, []).
item_systems([_-item(F,L,D,Wall)|Items], Type, [System|Systems]) :-
    piece_system(Type, F, L, D, Wall, System),
    item_systems(Items, Type, Systems).

%   why(+Type, ?W, ?D, +Items, +Constraints, -clash(Reasons)): on a grid, whole lengths may be what does not fit, where
%   the same lengths do: then nothing less than all of it is to blame.

why(Type, W, D, Items, Constraints, clash(Reasons)) :-
    system(Type, W, D, Items, Constraints, All),
    ( clash(All, Clash) -> true ; Clash = All ),
    findall(Reason, ( member(_-Why, Clash), member(Reason, Why) ), Found),
    sort(Found, Reasons).

%!  linear_system(+Type, +Layout, -Rows) is det.
%
%   The whole linear system of a room, as rows of numbers (linear.pl): what another solver is compared with.

linear_system(Type, Layout, Rows) :-
    room(Type, Layout, Room),
    Room = room(_,W,D,_,_,_,_),
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    system(Type, W, D, Items, Constraints, All),
    rows(All, Rows).
