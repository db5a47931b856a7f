:- module(thorough, [thoroughly_decided//5]).

/** <module> Search for lengths that give a brief its areas, where brief.pl leaves the question open

First, the ranges of width and depth that the other constraints leave to each box are computed. If the width or the depth is known, the
area is linear in the other; if all constraints are linear, the answer is exact. A bound of a range is the reason because(N) of constraints
that rest on it. N is the bound's number among Bounds, which hold N-bound(Against,System): the System has no solution together with
Against, the opposite of the bound. Once a conflict rests on a bound, rational arithmetic finds the part of the System that excludes Against.

Some areas leave only one point or a part of a curve, so that no polygon lies within the right sizes. Linear programmes move a nearby
point there (Newton's method).
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(brief).
:- use_module('../linear/exact').
:- use_module('../linear/linear').
:- use_module('../shared_walls/lines').

% Numbers of times that a range of widths is halved, that all ranges are narrowed after each halving, and that a point is moved.
halvings(40).
rounds(4).
moves(8).

% Metres that are added to a bound to allow for rounding errors.
margin(1.0e-8).

% A range is narrowed only if less than this share of it is left.
narrower(0.9).

%!  thoroughly_decided(?Lines, +Rooms, +System, +Items, -Answer)// is det.
%
%   Answer is as in items_decided//6, but for all widths: those that stage 1 chose do not matter.

thoroughly_decided(Lines, Rooms, System, Items, Answer) -->
    { halvings(Halvings), maplist(widened(any), Items, Wide) },
    searched(Halvings, _, layout(Lines,Rooms,System), Wide, [], Found),
    { Found = refuted(Conflicts) -> ( maplist(explained, Conflicts, Known), append(Known, All) -> Answer = refuted(All) ; Answer = open )
    ; Answer = Found }.

%   searched(+Left0, -Left, +Layout, +Items, +Bounds, -Answer)//: refuted(Conflicts) lists each Conflict-Bounds.

searched(Left, Left, layout(Lines,Rooms,System), [], Bounds, Answer) --> !,
    (   lines_sample(rational, Lines, Rooms, System)
    ->  { Answer = placed }
    ;   { exact_conflict(minimal, System, Conflict) }
    ->  { Answer = refuted([Conflict-Bounds]) }
    ;   { Answer = open } ).
searched(Left0, Left, Layout, Items0, Bounds0, Answer) -->
    { Layout = layout(_,_,System), rounds(Rounds),
      narrowed(Rounds, System, Items0, Bounds0, Items, Bounds),
      outer_system(System, Items, Outer) },
    (   { middle(Outer, Middle) }
    ->  from_middle(Middle, Left0, Left, Layout, Items, Outer, Bounds, Answer)
    ;   { Answer = open, Left = Left0 } ).

from_middle(impossible(Conflict), Left, Left, _, _, _, Bounds, refuted([Conflict-Bounds])) --> !.
from_middle(Middle, Left, Left, Layout, Items, Outer, _, placed) --> placed(Layout, Items, Outer, Middle), !.
from_middle(Middle, Left0, Left, Layout, Items, _, Bounds, Answer) -->
    { Left0 > 0, sizes_at(Middle, Items, Sizes), widest_miss(Items, Sizes, Item, Others) }, !,
    { halves(Item, Lower, Upper), Left1 is Left0 - 1 },
    searched(Left1, Left2, Layout, [Lower|Others], Bounds, Answer1),
    (   { Answer1 == placed }
    ->  { Answer = placed, Left = Left2 }
    ;   searched(Left2, Left, Layout, [Upper|Others], Bounds, Answer2),
        { either(Answer1, Answer2, Answer) } ).
from_middle(_, Left, Left, _, _, _, _, open) --> [].

either(_, placed, placed) :- !.
either(refuted(C1), refuted(C2), refuted(C)) :- !, append(C1, C2, C).
either(_, _, open).

% - a solution ------------------------------------------------------------------------------------------------------------

%   placed(+Layout, +Items, +Outer, +Middle)// is semidet: all lines become numbers, sampled where possible.

placed(layout(Lines,Rooms,System), Items, Outer, Middle) -->
    (   { sizes_at(Middle, Items, Sizes), pairs_keys(Sizes, Widths), held(layout(Lines,Rooms,System), Held) },
        near_sample(1, Held, Items, Widths)
    ;   lines_sample(real, Lines, Rooms, Outer),
        { \+ misses(at([],[]), Items) }
    ;   { moves(Moves), moved(Moves, System, Items, Middle) } ), !.

%   moved(+Moves, +System, +Items, +Point) is semidet: all places become those of a Point at(Xs,Values), or of a point near it, at which
%   no area is missed.

moved(_, System, Items, Point) :-
    \+ misses(Point, Items), !,
    Point = at(Xs,Xs), maplist(holds, System).
moved(Moves, System, Items, Point) :-
    Moves > 0, Fewer is Moves - 1,
    Point = at(Xs,_), sizes_at(Point, Items, Sizes),
    findall(Values, ( posted(System), foldl(aimed, Items, Sizes, 0, Off), inf(Off, _, Xs, Values) ), [Next]),
    moved(Fewer, System, Items, at(Xs,Next)).

misses(Point, Items) :- sizes_at(Point, Items, Sizes), widest_miss(Items, Sizes, _, _).

%   aimed(+Item, +Size, +Sum, -More): the area is linear near this Size. More adds a high cost for missing it and a low cost for distance.

aimed(item(W,D,Least-Most,_,_,_), W0-D0, Sum, Sum + 1000*Miss + Wide + Deep) :-
    {Miss >= 0, Least - Miss =< D0*W + W0*D - W0*D0, D0*W + W0*D - W0*D0 =< Most + Miss,
     Wide >= W - W0, Wide >= W0 - W, Deep >= D - D0, Deep >= D0 - D}.

holds((A =< B)-_) :- A - B < 1.0e-7.
holds((A = B)-_)  :- abs(A - B) < 1.0e-7.

% - what is left of widths ------------------------------------------------------------------------------------------------

%   narrowed(+Rounds, +System, +Items0, +Bounds0, -Items, -Bounds): ranges become the widths that are left, directly or by the depths.

narrowed(Rounds, System, Items0, Bounds0, Items, Bounds) :-
    (   Rounds > 0,
        outer_system(System, Items0, Outer),
        findall(Left, ( posted(Outer), maplist(sides_left, Items0, Left) ), [Left]),
        foldl(narrow(Outer), Items0, Left, Items1, Bounds0, Bounds1),
        Items1 \== Items0
    ->  Fewer is Rounds - 1, narrowed(Fewer, System, Items1, Bounds1, Items, Bounds)
    ;   Items = Items0, Bounds = Bounds0 ).

sides_left(item(W,D,_,_,_,_), left(W1-W2,D1-D2)) :- range_left(W, W1-W2), range_left(D, D1-D2).

range_left(X, Low-High) :- margin(M), inf(X, Inf), sup(X, Sup), Low is Inf - M, High is Sup + M.

narrow(System, Item0, left(W1-W2,D1-D2), Item, Bounds0, Bounds) :-
    Item0 = item(W,D,Least-Most,Why,from(Low0,Why1)-upto(High0,Why2),Wide),
    By1 is Least/D2*(1 - 1.0e-12), By2 is Most/D1*(1 + 1.0e-12),
    ( By1 > W1 -> Low = By1, Lower = (D2 =< D), Below = Why ; Low = W1, Lower = (W =< W1), Below = [] ),
    ( By2 < W2 -> High = By2, Upper = (D =< D1), Above = Why ; High = W2, Upper = (W2 =< W), Above = [] ),
    narrower(Share),
    (   min(High, High0) - max(Low, Low0) < Share*(High0 - Low0)
    ->  bounded(Low > Low0, from(Low,Below), Lower, System, from(Low0,Why1), From, Bounds0, Bounds1),
        bounded(High < High0, upto(High,Above), Upper, System, upto(High0,Why2), Upto, Bounds1, Bounds),
        Item = item(W,D,Least-Most,Why,From-Upto,Wide)
    ;   Item = Item0, Bounds = Bounds0 ).

%   bounded(+Nearer, +End, +Against, +System, +End0, -NewEnd, +Bounds0, -Bounds): NewEnd is End if that is Nearer, else End0.

bounded(Nearer, End, Against, System, _, NewEnd, Bounds, [N-bound(Against,System)|Bounds]) :-
    call(Nearer), !,
    length(Bounds, N),
    End =.. [Name,At,Why], NewEnd =.. [Name,At,[because(N)|Why]].
bounded(_, _, _, _, End, End, Bounds, Bounds).

% - why -------------------------------------------------------------------------------------------------------------------

%   explained(+Conflict-Bounds, -Known) is semidet: the Conflict and the constraints that its bounds follow from; fails if a bound is not confirmed.

explained(Conflict-Bounds, Known) :-
    numbers_of(Conflict, Numbers),
    bounds_explained(Numbers, [], Bounds, Others),
    append(Conflict, Others, All),
    maplist(without_bounds, All, Known).

bounds_explained([], _, _, []).
bounds_explained([N|Ns], Seen, Bounds, Constraints) :- memberchk(N, Seen), !, bounds_explained(Ns, Seen, Bounds, Constraints).
bounds_explained([N|Ns], Seen, Bounds, Constraints) :-
    memberchk(N-bound(Against,System), Bounds),
    exact_conflict(minimal, [Against-[]|System], Conflict),
    numbers_of(Conflict, More), append(More, Ns, Next),
    bounds_explained(Next, [N|Seen], Bounds, Others),
    append(Conflict, Others, Constraints).

numbers_of(Conflict, Numbers) :- findall(N, ( member(_-Why, Conflict), member(because(N), Why) ), Found), sort(Found, Numbers).

without_bounds(C-Why0, C-Why) :- exclude(is_bound, Why0, Why).

is_bound(because(_)).
