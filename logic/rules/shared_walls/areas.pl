:- module(areas, [room_system/4, house_system/3, square/2]).

/** <module> The linear constraints of a room's size and area, as data (linear.pl)

An area between Least and Most is no linear constraint of a width W and a depth D, but follows from some. The tangent of the
curve W*D = Most where D = A*W gives A*W + D =< 2*sqrt(A*Most), and so W*D =< Most. Chords of the curve
W*D = Least lie above it. Both leave out some sizes that the area allows, and let in none that it does not; where size and
area allow any room, they leave one: see anchor/5. So they may refute several rooms together that do have a house: then all sizes
are searched (exact_system/4 in walls.pl).
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module('../language/grammar_files').
:- use_module('../linear/grid').
:- use_module('../language/lengths').
:- use_module('../linear/regions').
:- use_module('../language/sizes').

:- table room_template/4, house_template/3.          % a clause is solved once

% How much longer one chord's end may be than its start: its middle is then at most 5.6 % above the curve.
chord_ratio(1.6).

%!  room_system(+Type, ?W, ?D, -Constraints) is det.
%
%   Constraints are those of the size and the area of a room of this type, with reasons size(Type) and room_area(Type). W and D
%   may be expressions.

room_system(Type, W, D, Constraints) :- room_template(Type, W0, D0, Template), copied([W0,D0]-Template, [W,D]-Constraints).

room_template(Type, W, D, Constraints) :-
    room_size_system(Type, W, D, Sizes),
    (   grammar:room_area(Type, Least0, Most0)
    ->  room_extent(Type, Width, Depth),
        maplist(square, [Least0,Most0], [Least,Most]),
        corners(Sizes, W, D, Corners),
        phrase(area(Corners, Width, Depth, Least-Most, W, D, [room_area(Type)]), Areas),
        append(Sizes, Areas, Constraints)
    ;   Constraints = Sizes ).

%!  square(+Area, -Squares) is det.
%
%   An Area in square metres is so many squares of the house's unit.

square(Area, Squares) :- in_unit(Area, Half), in_unit(Half, Squares).

area(Corners, Width, Depth, Least-Most, W, D, Why) -->
    { least_and_greatest_area(Corners, Low, High) },
    (   { anchor(Low, High, Least-Most, Anchor, L-M) }
    ->  at_most(High, M, Anchor, W, D, Why), at_least(Low, L, Anchor, Width, Depth, W, D, Why)
    ;   [(1.0 =< 0.0)-Why] ).

%   anchor(+Low, +High, +Areas, -Anchor, -Widened) is semidet: a point between that of the least and that of the greatest area,
%   which the tangent and the chords leave in. Fails where no point has an area among Least-Most. Where these are one, what
%   floats are off is added.

anchor(Low-P, High-Q, Least-Most, Anchor, Widened) :-
    From is max(Low, Least), To is min(High, Most), From =< To*(1 + 1.0e-9),
    Area is sqrt(From*To),
    point_of_area(Area, P, Q, Anchor),
    (   From > To*(1 - 1.0e-8)
    ->  L is Least*(1 - 1.0e-9), M is Most*(1 + 1.0e-9), Widened = L-M
    ;   Widened = Least-Most ).

at_most(High-_, Most, _, _, _, _) --> { High =< Most }, !.
at_most(_, Most, W1-D1, W, D, Why) --> { Steep is D1/W1, Sum is 2*sqrt(Steep*Most) }, [(Steep*W + D =< Sum)-Why].

%   Where the anchor is hardly larger than Least, two chords meet below it.

at_least(Low-_, Least, _, _, _, _, _, _) --> { Least =< Low }, !.
at_least(_, Least, W0-D0, W1-W2, D1-D2, W, D, Why) -->
    { From is max(W1, Least/D2), To is min(W2, Least/D1) },
    (   { From >= To*(1 - 1.0e-9) }
    ->  { Deep is Least/To }, [(From =< W)-Why, (Deep =< D)-Why]
    ;   { W0*D0 < 1.06*Least, W0 > From, W0 < To }
    ->  chords(From-W0, Least, W, D, Why), chords(W0-To, Least, W, D, Why)
    ;   chords(From-To, Least, W, D, Why) ).

chords(From-To, Least, W, D, Why) -->
    { chord_ratio(Ratio),
      Steps is max(1, ceiling(log(To/From)/log(Ratio))),
      Step is (To/From)**(1/Steps) },
    chords(Steps, From, Step, Least, W, D, Why).

%   chords(+Steps, +From, +Step, +Area, ?W, ?D, +Why)//: each between two widths of which one is Step times the other.

chords(0, _, _, _, _, _, _) --> !.
chords(Steps, W1, Step, Area, W, D, Why) -->
    { W2 is W1*Step, Slope is Area/(W1*W2), Sum is Area/W1 + Area/W2, Fewer is Steps - 1 },
    [(Sum =< Slope*W + D)-Why],
    chords(Fewer, W2, Step, Area, W, D, Why).

%!  house_system(?W, ?D, -Constraints) is det.
%
%   Constraints of the whole plan, W from west to east and D from north to south, with the reason house_size; none where the
%   grammar states none.

house_system(W, D, Constraints) :- house_template(W0, D0, Template), copied([W0,D0]-Template, [W,D]-Constraints).

house_template(W, D, Constraints) :-
    (   grammar:house_size(W0, D0)
    ->  ( on_grid -> metres(1, Cell), Sizes = [Cell*W,Cell*D] ; Sizes = [W,D] ),
        size_system(Sizes, [W0,D0], house_size, Constraints)
    ;   Constraints = [] ).

copied(Template, Instance) :- copy_term(Template, Instance).
