:- module(chain, [chain_constraints//2, packed_constraints//3, draw_chain//2, nowhere/1]).

/** <module> Things in a row, at least a gap apart: pieces along a wall, rooms along the main room's

A chain is a list of block(Start,Length,Bounds,Apart): Bounds are at_least(E)-Reasons, at_most(E)-Reasons and
at(E)-Reasons on its Start, and Apart are the reasons why it keeps the gap to the block before it.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(draw).

%!  chain_constraints(+Blocks, +Gap)// describes the constraints of a chain, see linear.pl.

chain_constraints([], _) --> [].
chain_constraints([block(S,L,Bounds,_)|Blocks], Gap) -->
    bounded(Bounds, S),
    apart(Blocks, S, L, Gap),
    chain_constraints(Blocks, Gap).

bounded([], _) --> [].
bounded([Bound-Why|Bounds], S) --> [Constraint-Why], { bound(Bound, S, Constraint) }, bounded(Bounds, S).

bound(at(E),       S, S = E).
bound(at_least(E), S, E =< S).
bound(at_most(E),  S, S =< E).

apart([], _, _, _)                      --> [].
apart([block(S2,_,_,Why)|_], S, L, Gap) --> [(S + L + Gap =< S2)-Why].

%!  packed_constraints(+Blocks, +Gap, +After)// describes what a chain asks of all else that is unknown.
%
%   Where its lengths and lower bounds are numbers, each block can stand as early as that lets it, after After: then
%   only the upper bounds are left to be met, one constraint each, and no start is unknown.

packed_constraints([], _, _) --> [].
packed_constraints([block(_,L,Bounds,_)|Blocks], Gap, After) -->
    { low(Bounds, After, S), After1 is S + L + Gap },
    upper(Bounds, S),
    packed_constraints(Blocks, Gap, After1).

upper([], _) --> [].
upper([Bound-Why|Bounds], S) -->
    ( { Bound = at_most(E) } -> [(S =< E)-Why] ; [] ),
    upper(Bounds, S).

%!  draw_chain(+Blocks, +Gap)// is semidet.
%
%   Fixes every Start, where all else is known, so that the gaps between them share what is left over uniformly
%   (uniformly on their simplex, where no bound inside the chain cuts it). Fails if they do not fit. The bounds
%   of a row are known in one pass from each end, so this needs no solver.

draw_chain(Blocks, Gap) -->
    { latest(Blocks, Gap, Latest, Free, _) },
    { nowhere(Before) },
    placed(Blocks, Latest, Before, Gap, Free).

%!  nowhere(-After): before all that there is.

nowhere(-1.0e9).

%   latest(+Blocks, +Gap, -Latest, -Free, -Before): the greatest Start of each block, how many of them are not at a
%   fixed place, and what the first block's end must not pass.

latest([], _, [], 0, 1.0e9).
latest([block(_,L,Bounds,_)|Blocks], Gap, [Late|Lates], Free, Before) :-
    latest(Blocks, Gap, Lates, Free0, Behind),
    high(Bounds, 1.0e9, High),
    Late is min(High, Behind - L),
    Before is Late - Gap,
    ( memberchk(at(_)-_, Bounds) -> Free = Free0 ; Free is Free0 + 1 ).

high([], High, High).
high([Bound-_|Bounds], High0, High) :-
    ( Bound = at_least(_) -> High1 = High0 ; arg(1, Bound, E), High1 is min(High0, E) ),
    high(Bounds, High1, High).

low([], Low, Low).
low([Bound-_|Bounds], Low0, Low) :-
    ( Bound = at_most(_) -> Low1 = Low0 ; arg(1, Bound, E), Low1 is max(Low0, E) ),
    low(Bounds, Low1, Low).

placed([], [], _, _, _) --> [].
placed([block(S,L,Bounds,_)|Blocks], [Late|Lates], After, Gap, Free) -->
    { low(Bounds, After, Low), Low - Late < 1.0e-6 },
    (   { memberchk(at(_)-_, Bounds) }
    ->  { S = Low, Free1 = Free }
    ;   between_ends(Low, Late, Free, S), { Free1 is Free - 1 } ),
    { After1 is S + L + Gap },
    placed(Blocks, Lates, After1, Gap, Free1).
