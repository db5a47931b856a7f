:- module(swings, [clear_doors//2, start_sample//5]).

/** <module> Doors whose leaves miss each other

The leaf of an open door sweeps over a part of the squares in front of its doorway, one in each of its rooms. A door stands where
its squares meet those of no other door, if its wall has such a place.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module('../language/lengths').
:- use_module('../linear/sample').

:- meta_predicate clear_doors(3, -, +, -).

% Number of times that all doors are placed again if the first ones leave no place for a later one.
tries(9).

%!  clear_doors(:Sample, -Doors)// is det.
%
%   Sample places the Doors. Their squares do not meet if one of a few tries finds such places.

clear_doors(Sample, Doors, S0, S) :-
    tries(Tries),
    between(0, Tries, Try),
    Seed is S0 xor (Try << 32),            % each try with random numbers of its own
    call(Sample, Doors, Seed, S),
    ( Try =:= Tries -> true ; all_clear(Doors) ), !.

all_clear([]).
all_clear([Door|Doors]) :- clear(Door, Doors), all_clear(Doors).

clear(opening(_,_,_), _).
clear(door(Box,_,_), Doors) :-
    placed(Box, Wall, Length, Start),
    \+ ( member(Door, Doors), barred(Wall, Length, Door, Low-High), Low < Start, Start < High ).

placed(box(X,Y,L,W), x-Y, L, X) :- W =:= 0, !.
placed(box(X,Y,_,L), y-X, L, Y).

%!  start_sample(+Wall, +Length, +Range, +Doors, -Start)// is det.
%
%   Start is the place in the Range where a door of this Length begins along the Wall, Axis-At. Doors are the doors already placed.

start_sample(Wall, Length, Low-High, Doors, Start) -->
    interval_sample(Low, High, 1, First),
    { convlist(barred(Wall, Length), Doors, Barred),
      foldl(cut, Barred, [First-First], Clear), foldl(cut, Barred, [Low-High], Parts) },
    (   { Clear == [], Parts \== [] }
    ->  { foldl(add_length, Parts, 0, All) },
        interval_sample(0, All, 1, Along),
        { start_at(Parts, Along, Start) }
    ;   { Start = First } ).

%   barred(+Wall, +Length, +Door, -Range): the Door's squares meet those of a door of this Length that starts within the Range.

barred(Axis-At, Length, door(Box,_,_), Low-High) :-
    squares(Box, Axis, A1, A2, B1, B2),
    reach(Length, Out),
    At - Out < B2 - 1.0e-9, B1 < At + Out - 1.0e-9,
    Low is A1 - Length, High is A2.

%   squares(+Box, +Axis, -From, -To, -Low, -High): both squares of a door, along this axis and across.

squares(box(X,Y,L,W), x, X, X2, Y1, Y2) :- W =:= 0, !, X2 is X + L, reach(L, Out), Y1 is Y - Out, Y2 is Y + Out.
squares(box(X,Y,_,L), x, X1, X2, Y, Y2) :- reach(L, Out), X1 is X - Out, X2 is X + Out, Y2 is Y + L.
squares(box(X,Y,L,W), y, A1, A2, B1, B2) :- squares(box(Y,X,W,L), x, A1, A2, B1, B2).

%   reach(+Length, -Out): the squares of a door of this Length reach Out from the middle of its wall.

reach(Length, Out) :- length_of(inner_wall, T), Out is Length + T/2.

%   cut(+Barred, +Ranges, -Parts): Parts are the Ranges without the inside of the Barred range.

cut(Low-High, Ranges, Parts) :- foldl(cut_one(Low-High), Ranges, Parts, []).

cut_one(Low-High, A-B) -->
    ( { B1 is min(B, Low),  A =< B1 } -> [A-B1] ; [] ),
    ( { A1 is max(A, High), A1 =< B } -> [A1-B] ; [] ).

add_length(A-B, Sum0, Sum) :- Sum is Sum0 + B - A.

start_at([A-B|Parts], Along, Start) :- Rest is Along - (B-A), ( ( Rest =< 0 ; Parts == [] ) -> Start is min(A + Along, B) ; start_at(Parts, Rest, Start) ).
