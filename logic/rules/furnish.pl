:- module(furnish, [furnished//4, least_clash/4, linear_system/3]).

/** <module> Sizes and places for a room's furniture: a random solution, or why there is none

Sizes are drawn by their own clauses first, and kept if CLP(R) finds that all can stand so: most can, and what is
left to solve is small then. Try after try the room is drawn nearer to its largest and the furniture nearer to its
least. Where that does not help, CLP(R) decides with every size unknown. It finds a least clash, or the sizes are
drawn one by one in what is left for each. Places are drawn last, by the gap law of chain.pl.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(chain).
:- use_module(draw).
:- use_module(grammar).
:- use_module(linear).
:- use_module(room).

%!  furnished(+Type, +Layout, +Proof, -Answer)// is det.
%
%   Answer is the room (room.pl), every length of it known, or clash(Reasons): reasons why a room of this type cannot
%   have this furniture, a least set of them where Proof is `least`. Where it is `quick` they cost a fifth.

furnished(Type, Layout, Proof, Answer) -->
    { room(Type, Layout, Room),
      phrase(room_constraints(Room), Constraints) },
    (   sized_first(Room, Constraints)
    ->  { Answer = Room }
    ;   solved(Type, Room, Constraints, Proof, Answer) ).

%   try(?Try, -Ease): how much of its range each size is drawn in.

try(1, 1.0).
try(2, 1.0).
try(3, 0.8).
try(4, 0.6).
try(5, 0.4).
try(6, 0.2).
try(7, 0.0).

sized_first(Room, Constraints, S0, S) :-
    try(Try, Ease),
    Seed is S0 xor (Try << 32),            % each try with numbers of its own
    call(sized(Ease, Room, Constraints), Seed, S), !.

sized(Ease, Room, Constraints) -->
    { Room = room(Type,W,D,Door,_,_,_),
      room_law(Type, Law), room_items(Room, Items) },
    room_by(Law, Type, Ease, W, D),
    draw_items(Items, Type, Ease, Filling),
    { widest_core(Room), filling_constraints(Filling, Type, Alongs, Filled),
      append(Filled, Constraints, All) },
    forgotten(Door-Alongs, placed_door(Alongs, All, Door)),
    draw_places(Room).

room_by(box(A1,A2,B1,B2), _, Ease, W, D)  --> large(A1, A2, Ease, W), large(B1, B2, Ease, D).
room_by(line(A1,A2,B1,B2), _, Ease, W, D) --> random(U), { V is 1-U*Ease, W is A1 + V*(A2-A1), D is B1 + V*(B2-B1) }.
room_by(clause, Type, _, W, D)            --> forgotten(W-D, room_by_clause(Type, W, D)).

room_by_clause(Type, W, D) --> { once(grammar:room_size(Type, W, D)) }, uniform(W), uniform(D).

%   large(+Least, +Most, +Ease, -Size)// and small: in the upper or lower part of a range of metres.

large(M1, M2, Ease, Size) --> { rounded(M1, M2, Low, High), Low1 is High - Ease*(High-Low) }, between_ends(Low1, High, 1, Size).
small(M1, M2, Ease, Size) --> { rounded(M1, M2, Low, High), High1 is Low + Ease*(High-Low) }, between_ends(Low, High1, 1, Size).

%   draw_items(+Items, +Type, +Ease, -Filling)//: of what fills a stretch, the length along it is left to the solver.

draw_items([], _, _, []) --> [].
draw_items([Kind-Item|Items], Type, Ease, Filling) -->
    { Item = item(F,L,D,Wall), piece_law(Type, F, Law), law_on(Wall, Law, Here) },
    (   { Kind = filling(Along,Out) }
    ->  forgotten(Out, item_by(Here, F, Ease, L, D, Wall)),
        { Filling = [fill(Here,Along,Item)|Others] }
    ;   item_by(Here, F, Ease, L, D, Wall),
        { Filling = Others } ),
    draw_items(Items, Type, Ease, Others).

law_on(Wall, Law, Here) :- Law =.. [Kind|Ys], metres(Wall, Metres), maplist(at_wall(Metres), Ys, Xs), Here =.. [Kind|Xs].

at_wall(Wall, on(Wall1,Y1,Slope), Y) :- !, Y is Y1 + Slope*(Wall-Wall1).
at_wall(_, Y, Y).

item_by(box(L1,L2,D1,D2), _, Ease, L, D, _)  --> small(L1, L2, Ease, L), small(D1, D2, Ease, D).
item_by(line(L1,L2,D1,D2), _, Ease, L, D, _) --> random(U), { V is U*Ease, L is L1 + V*(L2-L1), D is D1 + V*(D2-D1) }.
item_by(clause, F, _, L, D, Wall)            --> forgotten(L-D, item_by_clause(F, L, D, Wall)).

item_by_clause(F, L, D, Wall) --> { once(grammar:piece_size(F, L, D, Wall)) }, uniform(L), uniform(D).

%   forgotten(?Result, :Draw)//: what Draw posts ends with it; Result is numbers.

forgotten(Result, Draw, S0, S) :-
    findall(Result-S1, once(call(Draw, S0, S1)), [Result-S]).

filling_constraints([], _, [], []).
filling_constraints([fill(Law,Along,Item)|Filling], Type, [Along|Alongs], Constraints) :-
    filling_range(Law, Type, Along, Item, Own),
    append(Own, Others, Constraints),
    filling_constraints(Filling, Type, Alongs, Others).

filling_range(box(L1,L2,D1,D2), _, Along, item(_,L,_,_), [(Low =< Along)-[], (Along =< High)-[]]) :- !,
    ( Along == L -> rounded(L1, L2, Low, High) ; rounded(D1, D2, Low, High) ).
filling_range(_, Type, _, item(F,L,D,Wall), Constraints) :- piece_system(Type, F, L, D, Wall, Constraints).

placed_door(Alongs, Constraints, Door) -->
    { posted(Constraints) },
    draw_each(Alongs),
    uniform(Door).

draw_each([])     --> [].
draw_each([X|Xs]) --> uniform(X), draw_each(Xs).

draw_places(Room) --> { length_of(passage, P), room_chains(Room, Chains) }, draw_chains(Chains, P).

draw_chains([], _)              --> [].
draw_chains([Chain|Chains], P)  --> draw_chain(Chain, P), draw_chains(Chains, P).

% - with every size unknown ------------------------------------------------------------------------------------

solved(Type, Room, Constraints, Proof, Answer) -->
    { Room = room(_,W,D,Door,_,_,_), room_items(Room, Items),
      system(Type, W, D, Items, Constraints, System) },
    (   { clash(Proof, System, Clash) }
    ->  { because(Clash, Answer) }
    ;   forgotten(Items-W-D, solved_sizes(Type, W, D, Items, Constraints, System))
    ->  { widest_core(Room) },
        forgotten(Door, placed_door([], Constraints, Door)),
        { Answer = Room },
        draw_places(Room)
    ;   { because(System, Answer) } ).

%   solved_sizes(+Type, ?W, ?D, ?Items, +Constraints, +System)// is semidet: draws every size in what the others leave.
%   On a grid some whole W and D may take the furniture where others do not: all are tried, in random order. Where none
%   does, though lengths that are not whole could, nothing less than the whole system is to blame.

solved_sizes(Type, W, D, Items, Constraints, _) -->
    { lattice(whole) }, !,
    { room_extent(Type, W1, W2, D1, D2), numlist(W1, W2, Ws), numlist(D1, D2, Ds),
      findall(A-B, ( member(A, Ws), member(B, Ds) ), Pairs) },
    shuffled(Pairs, Order),
    sized_whole(Order, Type, W, D, Items, Constraints).
solved_sizes(_, W, D, Items, _, System) -->
    { posted(System) },
    drawn_sizes(Items, W, D).

sized_whole(Pairs, Type, W, D, Items, Constraints, S0, S) :-
    member(W-D, Pairs),
    system(Type, W, D, Items, Constraints, System),
    posted(System),
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

because(Clash, clash(Reasons)) :-
    findall(Reason, ( member(_-Why, Clash), member(Reason, Why) ), Found),
    sort(Found, Reasons).

%   clash(+Proof, +System, -Clash) is semidet.

clash(least, All, Clash) :- clash(All, Clash).
clash(quick, All, Clash) :- clash_among(All, Clash).

%!  least_clash(+Type, +Layout, +Without, -Reasons) is semidet.
%
%   Reasons are a least clash of a room with this furniture, where the clauses Without are left out.

least_clash(Type, Layout, Without, Reasons) :-
    whole_system(Type, Layout, Items, System),
    exclude(resting_on(Without), System, Rest),
    phrase(positive(Items), Positive),
    append(Positive, Rest, All),
    clash(All, Clash),
    because(Clash, clash(Reasons)).

%   A size without its clause is still a size.

positive([])                       --> [].
positive([_-item(_,L,D,_)|Items])  --> [(0 =< L)-[], (0 =< D)-[]], positive(Items).

resting_on(Without, _-Why) :- member(Reason, Why), memberchk(Reason, Without), !.

whole_system(Type, Layout, Items, System) :-
    room(Type, Layout, Room),
    Room = room(_,W,D,_,_,_,_),
    phrase(room_constraints(Room), Constraints),
    room_items(Room, Items),
    system(Type, W, D, Items, Constraints, System).

%!  linear_system(+Type, +Layout, -Rows) is det.
%
%   The whole linear system of a room, as rows of numbers (linear.pl): what another solver is compared with.

linear_system(Type, Layout, Rows) :-
    whole_system(Type, Layout, _, System),
    rows(System, Rows).
