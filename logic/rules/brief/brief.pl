:- module(brief, [brief_constraints//2, area_items/4, grammar_item/2, has_area/2, item_range/2, items_decided//6, outer_system/3, middle/2, areas_bounded/3,
                  near_sample//4, held/2, halves/3, sizes_at/3, widest_miss/4, widened/3]).

/** <module> Lengths and areas that a brief requires, in addition to the walls of a layout

Lengths of requirements are whole millimetres, areas square centimetres (brief.lp). A box is room(B,Type,Sides,Edges) as in
walls.pl: a room, a void, or the `outline`.

An area between Least and Most is no linear constraint, so two linear systems replace it. The inner system has a tangent of
W*D = Most and some chords of W*D = Least, near the shape that stage 1 has chosen. It admits no wrong size and most right sizes, so
each of its solutions is right. The outer system has tangents of W*D = Least and the chord of W*D = Most, over the widths that
stage 1 leaves. It excludes no right size, so each of its conflicts is right. If neither system decides, the search halves the widths
of a box.

An item is item(W,D,Least-Most,Why,Range,Wide): Range is W1-W2 with the reasons of both ends, from(W1,Why1)-upto(W2,Why2). Wide is a
wider range around Range, so that one conflict refutes more shapes. All lengths are metres: a house by a brief lies on no grid.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(library(clpr)).
:- use_module('../linear/exact').
:- use_module('../linear/linear').
:- use_module('../language/grammar_files').
:- use_module('../language/lengths').
:- use_module('../shared_walls/areas').
:- use_module('../shared_walls/contacts').
:- use_module('../shared_walls/lines').
:- use_module('../shared_walls/openings').

% Least side of a box with an area, in metres.
least_side(0.5).

% - lines that are linear ----------------------------------------------------------------------------------------------

%!  brief_constraints(+Atoms, +Boxes)// describes the constraints.

brief_constraints(Atoms, Boxes) -->
    { findall(Q, ( member(granted(Q), Atoms), is_length(Q) ), Requirements) },
    requirements(Requirements, Atoms, Boxes),
    { findall(R/Side/V, member(at_void(R,Side,V), Atoms), Contacts) },
    at_voids(Contacts, Boxes).

is_length(extent(_,_,_,_)).
is_length(offset(_,_,_,_)).
is_length(sides(_,_,_,_,_)).

requirements([], _, _) --> [].
requirements([Q|Qs], Atoms, Boxes) -->
    { arg(1, Q, B), memberchk(room(B,_,Sides,Edges), Boxes) },
    requirement(Q, Sides, Edges, Atoms, Boxes),
    requirements(Qs, Atoms, Boxes).

requirement(Q, Sides, Edges, _, _) -->
    { Q = extent(_,Axis,L,M), along(Axis, Sides, Edges, X1, X2, Lines) },
    between(X2-X1, L-M, [granted(Q)|Lines]).
requirement(Q, Sides, Edges, _, Boxes) -->
    { Q = offset(_,Axis,L,M), along(Axis, Sides, Edges, X, _, [Line|_]),
      memberchk(room(outline,_,Outline,_), Boxes), along(Axis, Outline, none, O, _, _) },
    between(X-O, L-M, [granted(Q),Line]).
requirement(Q, Sides, Edges, Atoms, _) -->
    { Q = sides(R,A,B,C,E), turned_sides(Atoms, R, (A-B)/(C-E), Wide/Deep, How),
      along(x, Sides, Edges, X1, X2, Across), along(y, Sides, Edges, Y1, Y2, Down),
      append([[granted(Q)],How,Across], WhyX), append([[granted(Q)],How,Down], WhyY) },
    between(X2-X1, Wide, WhyX), between(Y2-Y1, Deep, WhyY).

turned_sides(_, _, Same/Same, Same/Same, []) :- !.
turned_sides(Atoms, R, One/Other, Other/One, [turned(R)]) :- memberchk(turned(R), Atoms), !.
turned_sides(_, R, One/Other, One/Other, [not(turned(R))]).

%   between(+Length, +Millimetres, +Why)//: a length with one value is an equation, which leaves CLP(R) one unknown less.

between(X, L-L, Why) --> !, { Metres is L/1000 }, [(X = Metres)-Why].
between(X, L-M, Why) --> { Low is L/1000, High is M/1000 }, [(Low =< X)-Why, (X =< High)-Why].

along(x, sides(X1,X2,_,_), Edges, X1, X2, Lines) :- ( Edges = edges(W,E,_,_) -> Lines = [W,E] ; Lines = [] ).
along(y, sides(_,_,Y1,Y2), Edges, Y1, Y2, Lines) :- ( Edges = edges(_,_,N,S) -> Lines = [N,S] ; Lines = [] ).

%   at_voids(+Contacts, +Boxes)//: a room shares a part of a wall with a void.

at_voids([], _) --> [].
at_voids([R/Side/V|Contacts], Boxes) -->
    { memberchk(room(R,_,SidesR,EdgesR), Boxes), memberchk(room(V,_,SidesV,EdgesV), Boxes), side_axis(Side, Axis),
      span(Axis, SidesR, EdgesR, A1, A2, WhyR), span(Axis, SidesV, EdgesV, B1, B2, WhyV),
      append([[at_void(R,Side,V)],WhyR,WhyV], Why), least_contact(Least) },
    [(A1+Least =< B2)-Why, (B1+Least =< A2)-Why],
    at_voids(Contacts, Boxes).

% - areas --------------------------------------------------------------------------------------------------------------

%!  has_area(+Atoms, +Box) is semidet.

has_area(Atoms, Box) :- memberchk(granted(area(Box,_,_)), Atoms).

%!  area_items(+Atoms, +Boxes, -Items, -Sides) is det.
%
%   Items has an item for each box with an area. Sides has the constraints that the sides of these boxes are not too short.

area_items(Atoms, Boxes, Items, Sides) :-
    findall(area(B,L,M), member(granted(area(B,L,M)), Atoms), Areas),
    maplist(area_item(Atoms, Boxes), Areas, Items0, Slits),
    append(Slits, Sides),
    append(Items0, Items1),
    ( house_item(Boxes, Item) -> Items = [Item|Items1] ; Items = Items1 ).

%   area_item(+Atoms, +Boxes, +Area, -Items, -Slits): the item of the brief's Area, and one of the grammar's area if that is narrower.

area_item(Atoms, Boxes, Area, [item(W,D,Least-Most,Why,Range,Wide)|Others], [(Slit =< W)-Why,(Slit =< D)-Why]) :-
    Area = area(B,L,M), memberchk(room(B,Type,sides(X1,X2,Y1,Y2),Edges), Boxes),
    W = X2-X1, D = Y2-Y1,
    ( Edges = edges(E1,E2,E3,E4) -> Lines = [E1,E2,E3,E4] ; Lines = [] ),
    Least is L/10000, Most is M/10000,
    least_side(Slit),
    width_range(0, B, Atoms, Slit, Most, Range), width_range(3, B, Atoms, Slit, Most, Wide),
    Why = [granted(Area)|Lines],
    (   B \== outline, grammar:room_area(Type, Least1, Most1),
        \+ ( Least1 =< Least, Most =< Most1 )
    ->  Others = [item(W,D,Least1-Most1,[room_area(Type),room(B,Type)|Lines],Range,Wide)]
    ;   Others = [] ).

%   width_range(+Away, +Box, +Atoms, +Slit, +Most, -Range): the widths of the step that stage 1 has chosen, and of Away steps on
%   either side.

width_range(Away, B, Atoms, Slit, Most, from(Low,WhyLow)-upto(High,WhyHigh)) :-
    (   memberchk(slim(B,First), Atoms), between(0, Away, Less), Last is First + Away - Less, memberchk(step(B,Last,_,V,_,_), Atoms)
    ->  High is V/1000, WhyHigh = [slim(B,Last)]
    ;   High is Most/Slit, WhyHigh = [] ),
    (   memberchk(slim(B,First), Atoms), First > 0, Before is max(0, First - 1 - Away), memberchk(step(B,Before,W,_,_,_), Atoms)
    ->  Low is W/1000, WhyLow = [not(slim(B,Before))]
    ;   Low = Slit, WhyLow = [] ).

%!  grammar_item(+Room, -Item) is semidet.
%
%   Item is the area that the grammar states for a room, for all widths.

grammar_item(room(R,Type,sides(X1,X2,Y1,Y2),edges(E1,E2,E3,E4)), Item) :-
    clause(grammar:room_area(_,_,_), _), grammar:room_area(Type, Least, Most), !,
    widened(any, item(X2-X1,Y2-Y1,Least-Most,[room_area(Type),room(R,Type),E1,E2,E3,E4],_,_), Item).

%!  item_range(+Item, -Range) is det.

item_range(item(_,_,_,_,Range,_), Range).

%   house_item(+Boxes, -Item) is semidet: the area of the house that the grammar states. With walls it is less than
%   the area of the outline. A brief excludes that case (logic/generation/brief.py).

house_item(Boxes, item(X2-X1,Y2-Y1,Least-Most,[house_area],Range,Range)) :-
    clause(grammar:house_area(_,_), _), grammar:house_area(Least, Most), !,
    length_of(inner_wall, T), T =:= 0,
    memberchk(room(outline,_,sides(X1,X2,Y1,Y2),_), Boxes),
    least_side(Slit), High is Most/Slit,
    Range = from(Slit,[])-upto(High,[]).

% - a search for lengths that have the areas ------------------------------------------------------------------------

%!  items_decided(+Proof, ?Lines, +Rooms, +System, +Items, -Answer)// is det.
%
%   Answer is one of three. `placed`: all Lines are numbers, sampled as by lines_sample//4. refuted(Conflict): rational arithmetic
%   refutes the Conflict, a part of the System and of constraints that follow from the Items; it is minimal if the Proof is `minimal`.
%   `open`: the search found neither.

items_decided(Proof, Lines, Rooms, System, Items, Answer) -->
    decided(24, _, Proof, layout(Lines,Rooms,System), Items, Answer).

decided(Left, Left, _, Layout, Items, placed) -->
    { maplist(chosen_width, Items, Widths) },
    inner_sample(Layout, Items, Widths), !.
decided(Left0, Left, Proof, Layout, Items, Answer) -->
    { Layout = layout(_,_,System), outer_system(System, Items, Outer), middle(Outer, Middle) }, !,
    (   { Middle = impossible(Conflict) }
    ->  { Left = Left0,
          ( member(Scope, [any,wide]), maplist(widened(Scope), Items, Wide), outer_system(System, Wide, Whole), impossible(Whole, Stronger)
          ->  Answer = refuted(Stronger)
          ;   Answer = refuted(Conflict) ) }
    ;   { sizes_at(Middle, Items, Sizes), pairs_keys(Sizes, Widths), held(Layout, Held) },
        near_sample(1, Held, Items, Widths)
    ->  { Answer = placed, Left = Left0 }
    ;   { Left0 > 0, sizes_at(Middle, Items, Sizes), widest_miss(Items, Sizes, Item, Others) }
    ->  { halves(Item, Lower, Upper), Left1 is Left0 - 1 },
        decided(Left1, Left2, Proof, Layout, [Lower|Others], Answer1),
        other_half(Answer1, Left2, Left, Proof, Layout, [Upper|Others], Answer)
    ;   { Answer = open, Left = Left0 } ).
decided(Left, Left, _, _, _, open) --> [].

other_half(placed, Left, Left, _, _, _, placed) --> !.
other_half(Answer1, Left0, Left, Proof, Layout, Items, Answer) -->
    decided(Left0, Left, Proof, Layout, Items, Answer2),
    { both(Answer1, Answer2, Answer) }.

both(_, placed, placed) :- !.
both(refuted(C1), refuted(C2), refuted(C)) :- !, append(C1, C2, C).
both(_, _, open).

halves(item(W,D,Area,Why,from(W1,Why1)-upto(W2,Why2),_), Lower, Upper) :-
    Half is sqrt(W1*W2), append(Why1, Why2, Both),
    Range1 = from(W1,Both)-upto(Half,Both), Lower = item(W,D,Area,Why,Range1,Range1),
    Range2 = from(Half,Both)-upto(W2,Both), Upper = item(W,D,Area,Why,Range2,Range2).

%   held(+Layout, -Held): Held is the Layout. If CLP(R) wrongly refutes it, Held has constraints eased by a tenth of a micrometre.

held(layout(Lines,Rooms,System), layout(Lines,Rooms,Held)) :- ( \+ posted(System) -> maplist(eased, System, Held) ; Held = System ).

eased((A =< B)-Why, (A =< B + 1.0e-7)-Why).
eased((A = B)-Why, (A = B)-Why).

chosen_width(item(_,_,_,_,from(W1,_)-upto(W2,_),_), W) :- W is sqrt(W1*W2).

%   near_sample(+Tries, +Layout, +Items, +Widths)// is semidet: samples lines near the shapes of these Widths. If it fails, it repeats,
%   up to Tries times, with shapes that come nearer to the areas.

near_sample(_, Layout, Items, Widths) --> inner_sample(Layout, Items, Widths), !.
near_sample(Tries, Layout, Items, Widths) -->
    { Tries > 0, Fewer is Tries - 1, Layout = layout(_,_,System), nearest(System, Items, Widths, Nearer) },
    near_sample(Fewer, Layout, Items, Nearer).

nearest(System, Items, Widths, Nearer) :-
    maplist(inner, Items, Widths, Inner),
    term_variables(System-Inner, Xs),
    findall(Values, ( posted(System), foldl(off, Inner, 0, Off), inf(Off, _, Xs, Values) ), [Values]),
    sizes_at(at(Xs,Values), Items, Sizes),
    pairs_keys(Sizes, Nearer).

%   off(+Constraints, +Sum, -More): More is the Sum and a share by which the Constraints are violated at most.

off(Constraints, Sum, Sum+Share) :- {Share >= 0}, maplist(off_by(Share), Constraints).

off_by(Share, (A =< B)-_) :- ( number(A) -> {A =< B + A*Share} ; {A =< B + B*Share} ).

inner_sample(layout(Lines,Rooms,System), Items, Widths) -->
    { maplist(inner, Items, Widths, Inner), append([System|Inner], All) },
    lines_sample(real, Lines, Rooms, All).

%   inner(+Item, +Width, -Constraints): constraints near a shape of this width that admit no wrong size. The tangent of the greatest area
%   leaves the widths between W1 and W2. The chords of the least area span these widths.

inner(item(W,D,Least-Most,Why,_,_), Width, [(Steep*W + D =< Sum)-Why|Chords]) :-
    Steep is sqrt(Least*Most)/Width**2, Sum is 2*sqrt(Steep*Most),
    Middle is sqrt(Most/Steep), Away is sqrt(max(0, 1 - Least/Most)),
    W1 is Middle*(1 - Away), W2 is Middle*(1 + Away),
    Step is (W2/W1)**(1/4),
    findall(A-B, ( between(0, 3, K), A is W1*Step**K, B is A*Step ), Parts),
    maplist(inner_chord(W, D, Least, Why), Parts, Chords).

inner_chord(W, D, Area, Why, W1-W2, (Sum =< Slope*W + D)-Why) :- Slope is Area/(W1*W2), Sum is Area/W1 + Area/W2.

% - proofs that no lengths have them ------------------------------------------------------------------------------------------------

%!  outer_system(+System, +Items, -All) is det.
%
%   All is the System, with constraints from the Items that exclude no right size.

outer_system(System, Items, All) :- maplist(outer, Items, Outer), append([System|Outer], All).

%   A small margin covers the rounding of floats, since rational arithmetic takes the constraints as exact.

outer(item(W,D,Least-Most,Why,from(W1,Why1)-upto(W2,Why2),_), [(W1 =< W)-Lower,(W =< W2)-Upper,(Slope*W + D =< Sum)-All|Tangents]) :-
    append(Why, Why1, Lower), append(Why, Why2, Upper), append(Lower, Why2, All),
    Slope is Most/(W1*W2), Sum is (Most/W1 + Most/W2)*(1 + 1.0e-9),
    Middle is sqrt(W1*W2),
    maplist(outer_tangent(W, D, Least, Why), [W1,Middle,W2], Tangents).

outer_tangent(W, D, Area, Why, At, (Sum =< Slope*W + D)-Why) :- Slope is Area/At**2, Sum is 2*Area/At*(1 - 1.0e-9).

%!  areas_bounded(+System, +Items, -All) is det.
%
%   All is the System, with constraints that follow from the areas for all widths.

areas_bounded(System, Items, All) :- maplist(widened(any), Items, Wide), outer_system(System, Wide, All).

%   widened(+Scope, +Item, -Wide): Wide is the Item with its wide range, or, for the Scope `any`, with all widths that its area permits.

widened(wide, item(W,D,Area,Why,_,Wide), item(W,D,Area,Why,Wide,Wide)).
widened(any, item(W,D,Least-Most,Why,_,_), item(W,D,Least-Most,Why,Range,Range)) :-
    least_side(Slit), High is Most/Slit, Range = from(Slit,[])-upto(High,[]).

%!  middle(+System, -Middle) is semidet.
%
%   Middle is at(Xs,Values), a point where the System holds with the greatest slack, or impossible(Conflict). All constraints are
%   loosened by the least amount with which they have a solution. If this amount is positive, the constraints that bind there are in
%   conflict. Rational arithmetic confirms the conflict.

middle(System, impossible(Conflict)) :- impossible(System, Conflict), !.
middle(System, Middle) :-
    term_variables(System, Xs),
    once(( member(Equations, [kept,loosened]), findall(T-Values, least_loose(Equations, System, Xs, T, Values), [T-Values]) )),
    (   T > 1.0e-9
    ->  copy_term(Xs-System, Values-There),
        binding(There, System, T, Tight),
        ( exact_conflict(minimal, Tight, Conflict) -> true ; exact_conflict(minimal, System, Conflict) ),
        Middle = impossible(Conflict)
    ;   Middle = at(Xs, Values) ).

%   impossible(+System, -Conflict) is semidet: CLP(R) refutes the System, and CLP(Q) confirms the Conflict.

impossible(System, Conflict) :- findall(Count, posted(System, Count), [Count]), confirmed_conflict(minimal, System, Count, Conflict).

%   least_loose(+Equations, +System, +Xs, -T, -Values) is semidet. If the equations have a solution, Equations is `kept`:
%   they are not loosened, so that the other constraints have slack.

least_loose(Equations, System, Xs, T, Values) :- {Loose >= -1}, maplist(loosened(Equations, Loose), System), inf(Loose, T, Xs, Values).

loosened(_, T, (A =< B)-_)       :- {A - T =< B}.
loosened(kept, _, (A = B)-_)     :- {A = B}.
loosened(loosened, T, (A = B)-_) :- {A - T =< B, B - T =< A}.

%   binding(+There, +System, +T, -Tight): the constraints of the System that bind. There has the same constraints with numbers.

binding([], [], _, []).
binding([C-_|There], [Constraint|System], T, Tight) :-
    ( binds(T, C) -> Tight = [Constraint|More] ; Tight = More ),
    binding(There, System, T, More).

binds(T, A =< B) :- A - B > T - 1.0e-7.
binds(_, _ = _).

%   sizes_at(+Middle, +Items, -Sizes): Width-Depth of the box of each Item at the point Middle.

sizes_at(at(Xs,Values), Items, Sizes) :- copy_term(Xs-Items, Values-There), maplist(size_of, There, Sizes).

size_of(item(W,D,_,_,_,_), Width-Depth) :- Width is W, Depth is D.

%   widest_miss(+Items, +Sizes, -Item, -Others) is semidet: the item whose size misses its area by most. It fails if no
%   item misses its area by more than rounding.

widest_miss(Items, Sizes, Item, Others) :-
    maplist(missed, Items, Sizes, Misses),
    pairs_keys_values(Pairs, Misses, Items),
    max_member(Miss-_, Pairs), Miss > 1.0e-7,
    once(( nth0(Place, Misses, Miss), nth0(Place, Items, Item, Others) )).

missed(item(_,_,Least-Most,_,_,_), W-D, Miss) :- Area is W*D, Miss is max(Least-Area, Area-Most)/Most.
