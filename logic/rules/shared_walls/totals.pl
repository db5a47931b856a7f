:- module(totals, [total_area/1, totals/3, house_areas/2, total_constraints/3, total_sample//7, type_ranges/2, square_metres/2]).

/** <module> Areas that are sums: of a whole plan, and of a room with its parts

A total is total(Least-Most,Rooms,Why): the areas of these rooms, by number, together, in squares of the house's unit; Why begins with the
clause that states it. That it lies between two numbers is no linear constraint, but much that follows from it is. The area of a room is an unknown
between bounds of the product of its sides, which are linear (McCormick, 1976): they lose no plan, so what they leave without a solution is
impossible. Once the walls that run one way have their places, the sum is linear in the others. Where neither way
finds a plan, a range of sizes is halved: in smaller ranges the bounds are narrower.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(yall)).
:- use_module(library(pairs)).
:- use_module('../answers').
:- use_module(areas).
:- use_module('../linear/exact').
:- use_module('../language/grammar_files').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/linear').
:- use_module(lines).
:- use_module('../linear/regions').
:- use_module('../linear/sample').

:- table type_ranges/2.

%!  total_area(-Total) is semidet.
%
%   Total is Least-Most, squares of the house's unit, where the grammar states an area of the house.

total_area(Least-Most) :- clause(grammar:house_area(_,_), _), grammar:house_area(L, M), !, maplist(square, [L,M], [Least,Most]).

%!  totals(+Atoms, +Rooms, -Totals) is det.
%
%   Totals of a plan with these rooms (walls.pl).

totals(Atoms, Rooms, Totals) :- findall(Total, total(Atoms, Rooms, Total), Totals).

total(Atoms, Rooms, total(Areas,Numbers,[house_area|Outside])) :-
    total_area(Areas),
    partition(is_outdoor(Atoms), Rooms, Outdoors, Indoors),
    findall(R, member(room(R,_,_,_), Indoors), Numbers),
    findall(Reason, ( member(room(R,T,_,_), Outdoors), member(Reason, [room(R,T),outdoor(T)]) ), Outside).  % else they would count
total(Atoms, Rooms, total(Least-Most,[Q|Parts],[whole_area(T),room(Q,T),parts(Q,N)|Joints])) :-
    clause(grammar:whole_area(_,_,_), _),
    member(room(Q,T,_,_), Rooms), once(grammar:whole_area(T, L, M)), memberchk(parts(Q,N), Atoms),
    maplist(square, [L,M], [Least,Most]),
    findall(R-part_of(R,Q), member(part_of(R,Q), Atoms), Found), pairs_keys_values(Found, Parts, Joints).

is_outdoor(Atoms, room(_,T,_,_)) :- memberchk(outdoor(T), Atoms).

%   of_total(+Constraint): it says how large a total is.

of_total(_-[house_area|_]).
of_total(_-[whole_area(_)|_]).

%!  house_areas(+Types, -Json) is det.
%
%   Json is [Total,Rooms]: Total is [Least,Most], the area of the house in square metres, and Rooms are [Type,Least,Most,Narrowest,Widest],
%   areas and widths (metres) of rooms of these Types. Both are empty where the grammar states no area of the house.

house_areas(Types, Json) :-
    (   total_area(_)
    ->  once(grammar:house_area(Least, Most)), Total = [Least,Most],
        maplist(type_areas, Types, Rooms)
    ;   Total = [], Rooms = [] ),
    as_json([Total,Rooms], Json).

type_areas(Type, [Type,Least,Most,Narrowest,Widest]) :-
    type_ranges(Type, ranges(W1-W2,_,A1-A2)),
    maplist(square_metres, [A1,A2], [Least,Most]),
    maplist(metres, [W1,W2], [Narrowest,Widest]).

%!  square_metres(+Squares, -Area) is det.
%
%   An area in squares of the house's unit is so many square metres.

square_metres(Squares, Area) :- metres(Squares, Half), metres(Half, Area).

%!  type_ranges(+Type, -Ranges) is det.
%
%   Ranges are ranges(Widths,Depths,Areas), each Least-Greatest, that the size and the area of a type leave to its rooms.

type_ranges(Type, ranges(W1-W2,D1-D2,Least-Most)) :-
    room_system(Type, W, D, System),
    corners(System, W, D, Corners),
    pairs_keys_values(Corners, Ws, Ds),
    maplist(min_list, [Ws,Ds], [W1,D1]), maplist(max_list, [Ws,Ds], [W2,D2]),
    least_and_greatest_area(Corners, Least-_, Most-_).

%!  total_constraints(+Totals, +Sized, -Constraints) is det.
%
%   Constraints of rooms that are Sized as in walls.pl.

total_constraints(Totals, Sized, Constraints) :- total_boxes(Totals, Sized, Boxes), bounded(Totals, Boxes, Constraints).

%   total_boxes(+Totals, +Sized, -Boxes): of the rooms of the Totals, box(R,W,D,Ranges,Own,All) with the reasons of its area and of
%   what follows from its sides.

total_boxes(Totals, Sized, Boxes) :-
    include(in_some(Totals), Sized, Counted),
    maplist(type_box, Counted, Boxes).

in_some(Totals, R-_) :- member(total(_,Rooms,_), Totals), memberchk(R, Rooms), !.

type_box(R-sized(Type,W,D,Own,Across,Along), box(R,W,D,Ranges,Mine,All)) :-
    type_ranges(Type, Ranges),
    append(Own, [size(Type),room_area(Type)], Mine), append([Mine,Across,Along], All).

bounded(Totals, Boxes, Constraints) :-
    boxes_bounded(Boxes, Areas, Bounds),
    maplist(total_sum(Areas), Totals, Sums),
    foldl(sum_bounded, Sums, Bounds, Constraints).

%   total_sum(+Areas, +Total, -Sum): Sum is sum(Least-Most,Area,Why), of Areas R-Area that are any expressions.

total_sum(Areas, total(Bounds,Rooms,Why), sum(Bounds,Sum,Why)) :- maplist(area_in(Areas), Rooms, Some), sum_of(Some, Sum).

area_in(Areas, R, Area) :- memberchk(R-Area, Areas).

sum_bounded(sum(Least-Most,Area,Why), Constraints, [(Least =< Area)-Why,(Area =< Most)-Why|Constraints]).

boxes_bounded([], [], []).
boxes_bounded([box(R,W,D,ranges(W1-W2,D1-D2,Least-Most),Mine,All)|Boxes], [R-A|As],
              [(Least =< A)-Mine,(A =< Most)-Mine,
               (W1*D + D1*W - W1*D1 =< A)-All,(W2*D + D2*W - W2*D2 =< A)-All,
               (A =< W2*D + D1*W - W2*D1)-All,(A =< W1*D + D2*W - W1*D2)-All|Constraints]) :-
    boxes_bounded(Boxes, As, Constraints).

sum_of([X|Xs], Sum) :- foldl([Y,S,S+Y]>>true, Xs, X, Sum).

%!  total_sample(+Arithmetic, ?Order, +System, +Totals, +Rooms, +Sized, +Halvings)// is semidet.
%
%   The places in Order (lines.pl) are numbers with which the System, that of total_constraints/3 too, holds and the Totals of the
%   Rooms are as stated. What is left after this number of Halvings, or `any`, is passed over.

total_sample(Arithmetic, Order, System, Totals, Rooms, Sized, Halvings) -->
    { total_boxes(Totals, Sized, Boxes),
      maplist([room(R,_,sides(X1,X2,Y1,Y2),_),X1-X2,R-((X2-X1)*(Y2-Y1))]>>true, Rooms, Pairs, Areas),
      maplist(total_sum(Areas), Totals, Sums), term_variables(Pairs, Along),
      partition(among(Along), Order, Ways1, Ways2),
      exclude(of_total, System, Walls) },
    halving(Halvings, Walls, Boxes, all(Arithmetic,Totals,Sums), Ways1-Ways2).

among(Variables, _-X) :- member(V, Variables), V == X, !.

halving(Halvings, Walls, Boxes, All, Ways) -->
    { All = all(Arithmetic,Totals,_), bounded(Totals, Boxes, Bounds), append(Walls, Bounds, System) },
    (   either_way(Ways, System, Walls, All)
    ->  []
    ;   { fewer(Halvings, Fewer), left_of(Arithmetic, System, Boxes, Left),
          widest(Left, box(R,W,D,ranges(W1-W2,Ds,Area),Own,Why), Others),
          Half is (W1+W2)/2 },
        unit_sample(U),
        { Lower = part(W1-Half,W =< Half), Upper = part(Half-W2,Half =< W),
          ( U < 0.5 -> Parts = [Lower,Upper] ; Parts = [Upper,Lower] ),
          member(part(Range,Constraint), Parts) },
        halving(Fewer, [Constraint-[]|Walls], [box(R,W,D,ranges(Range,Ds,Area),Own,Why)|Others], All, Ways), ! ).

fewer(any, any).
fewer(N, Fewer) :- integer(N), N > 0, Fewer is N - 1.

%   either_way(+Ways, +System, +Walls, +All)// is semidet: the walls that run one way have their places, and then the others.

either_way(Ways1-Ways2, System, Walls, all(Arithmetic,_,Sums)) -->
    { foldl(sum_bounded, Sums, [], Exactly), lattice(Kind) },
    (   lines_sample(Arithmetic, Ways1, System, Exactly, Ways2)
    ;   lines_sample(Arithmetic, Ways2, System, Exactly, Ways1)
    ;   { Arithmetic-Kind == real-real },
        places_sample(Ways1, System, Values),
        nearer(4, Ways1-Ways2, Values, Walls, Sums) ), !.

%   nearer(+Rounds, +Ways, +Values, +Walls, +Sums)//: with the first Ways at these Values the others go as near to the areas as
%   they can, nearly, in turn, until these are reached.

nearer(Rounds, Ways1-Ways2, Values, Walls, Sums) -->
    { Rounds > 0 },
    (   { pairs_values(Ways1, Values), foldl(sum_bounded, Sums, [], Exactly) },
        lines_sample(real, [], Walls, Exactly, Ways2)
    ->  []
    ;   { copy_term(k(Ways1,Ways2,Walls,Sums), k(Known,Others,Copy,Aims)), pairs_values(Known, Values),
          findall(Targets, ( posted(Copy), maplist(aimed_at, Aims, Targets) ), [Targets]),
          foldl(aim, Aims, Targets, Copy, Aimed) },
        places_sample(Others, Aimed, Next),
        { Fewer is Rounds - 1 },
        nearer(Fewer, Ways2-Ways1, Next, Walls, Sums) ).

%   aimed_at(+Sum, -Target): nearly as far towards its bounds as it goes; in their middle, as far as it goes, where it is between.

aimed_at(sum(Least-Most,Area,_), Target) :-
    extremes(Area, Low-High),
    (   Low > Most   -> Target is 0.95*Low + 0.05*High
    ;   High < Least -> Target is 0.05*Low + 0.95*High
    ;   Target is (max(Low, Least) + min(High, Most))/2 ),
    {Area = Target}.

aim(sum(_,Area,_), Target, System, [(Area = Target)-[]|System]).

%   left_of(+Arithmetic, +System, +Boxes, -Left) is semidet: the Boxes, with what the System leaves to both sides.

left_of(real, System, Boxes, Left) :- findall(Ranges, ( posted(System), maplist(sides_left, Boxes, Ranges) ), [Ranges]), maplist(narrowed, Boxes, Ranges, Left).
left_of(rational, System, Boxes, Boxes) :- \+ exact_conflict(quick, System, _).

sides_left(box(_,W,D,_,_,_), Ws-Ds) :- extremes(W, Ws), extremes(D, Ds).

narrowed(box(R,W,D,ranges(_,_,Area),Own,All), Ws-Ds, box(R,W,D,ranges(Ws,Ds,Area),Own,All)).

%   widest(+Boxes, -Box, -Others) is semidet: the Box of which least is known, unless all are known to a square centimetre.

widest(Boxes, Box, Others) :-
    maplist(spread, Boxes, Keyed), max_member(Spread-Box, Keyed), square(0.01, Least), Spread > Least,
    once(( select(B, Boxes, Others), B == Box )).

spread(Box, Spread-Box) :- Box = box(_,_,_,ranges(W1-W2,D1-D2,_),_,_), Spread is (W2-W1)*(D2-D1).
