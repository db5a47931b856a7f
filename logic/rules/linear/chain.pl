:- module(chain, [chain_constraints//2, all_chains_constraints//2, all_even_constraints//1, packed_constraints//3, chain_sample//2, all_chains_sample//2,
                  before_all/1]).

/** <module> Things in a row, at least a gap apart: pieces along a wall, rooms along the main room's

A chain is a list of block(Start,Length,Bounds,Apart): Bounds are at_least(E)-Reasons, at_most(E)-Reasons and
at(E)-Reasons on its Start, or wish(E)-[], where it starts if the others let it, and Apart are the reasons why it keeps the gap to the block before it. To be sampled, a chain may
be even(Blocks): as far from each Start to the next.
*/

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(grid).
:- use_module(sample).

%!  chain_constraints(+Blocks, +Gap)// describes the constraints of a chain, see linear.pl.

chain_constraints([], _) --> [].
chain_constraints([block(S,L,Bounds,_)|Blocks], Gap) -->
    bounded(Bounds, S),
    apart(Blocks, S, L, Gap),
    chain_constraints(Blocks, Gap).

%!  all_chains_constraints(+Chains, +Gap)// describes the constraints of several chains.

all_chains_constraints([], _)               --> [].
all_chains_constraints([Chain|Chains], Gap) --> chain_constraints(Chain, Gap), all_chains_constraints(Chains, Gap).

%!  all_even_constraints(+Chains)// describes that in each chain it is as far from each Start to the next.

all_even_constraints([])             --> [].
all_even_constraints([Chain|Chains]) --> even_constraints(Chain), all_even_constraints(Chains).

even_constraints([One,Two,Three|Blocks]) --> !,
    { maplist(start_reasons, [One,Two,Three], [S1,S2,S3], Whys), append(Whys, Why) },
    [(S1 + S3 = S2 + S2)-Why],
    even_constraints([Two,Three|Blocks]).
even_constraints(_) --> [].

start_reasons(block(S,_,[_-Why|_],_), S, Why).

bounded([], _) --> [].
bounded([wish(_)-_|Bounds], S) --> !, bounded(Bounds, S).
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

packed_constraints(even(Blocks), Gap, _) --> !,
    { pitch_range(Blocks, Gap, Pitch, _), lowest(Blocks, 0, Pitch, -1.0e9, S) },
    evenly_packed(Blocks, S, Pitch).
packed_constraints([], _, _) --> [].
packed_constraints([block(_,L,Bounds,_)|Blocks], Gap, After) -->
    { low(Bounds, After, S), After1 is S + L + Gap },
    upper(Bounds, S),
    packed_constraints(Blocks, Gap, After1).

evenly_packed([], _, _) --> [].
evenly_packed([block(_,_,Bounds,_)|Blocks], S, Pitch) -->
    upper(Bounds, S),
    { S1 is S + Pitch },
    evenly_packed(Blocks, S1, Pitch).

upper([], _) --> [].
upper([Bound-Why|Bounds], S) -->
    ( { Bound = at_least(_) ; Bound = wish(_) } -> [] ; { arg(1, Bound, E) }, [(S =< E)-Why] ),
    upper(Bounds, S).

%!  chain_sample(?Blocks, +Gap)// is semidet.
%
%   Every Start is a number, where all else is known, and the gaps between them share what is left over uniformly
%   (uniformly on their simplex, where no bound inside the chain cuts it). Fails if they do not fit. The bounds
%   of a row are known in one pass from each end, so this needs no solver.

chain_sample(even(Blocks), Gap) --> !,
    { pitch_range(Blocks, Gap, Least, Most), Least - Most < 1.0e-6 },
    interval_sample(Least, Most, 1, Pitch),
    { lowest(Blocks, 0, Pitch, -1.0e9, Low), highest(Blocks, 0, Pitch, 1.0e9, High), Low - High < 1.0e-6 },
    interval_sample(Low, High, 1, S),
    { evenly_placed(Blocks, S, Pitch) }.
chain_sample(Blocks, Gap) -->
    { latest(Blocks, Gap, Latest, Free, _),
      before_all(Before) },
    starts_sample(Blocks, Latest, Before, Gap, Free).

%   pitch_range(+Blocks, +Gap, -Least, -Most): from one Start to the next, by the lengths of the blocks and by the bounds of
%   each two of them. A single block has any pitch, and so 0.

pitch_range([_], _, 0, 0) :- !.
pitch_range(Blocks, Gap, Least, Most) :-
    append(Before, [_], Blocks),
    foldl(longest_step(Gap), Before, 0, Long),
    number_blocks(Blocks, 0, Numbered),
    findall(I-Low, ( member(I-block(_,_,Bounds,_), Numbered), number_low(Bounds, Low) ), Lows),
    findall(I-High, ( member(I-block(_,_,Bounds,_), Numbered), number_high(Bounds, High) ), Highs),
    findall(P, ( member(I-Low, Lows), member(J-High, Highs), I < J, P is (High-Low)/(J-I) ), Uppers),
    findall(P, ( member(I-Low, Lows), member(J-High, Highs), I > J, P is (Low-High)/(I-J) ), Lowers),
    min_list([1.0e9|Uppers], Most),
    max_list([Long|Lowers], Least).

longest_step(Gap, block(_,L,_,_), Long0, Long) :- Long is max(Long0, L + Gap).

number_blocks([], _, []).
number_blocks([Block|Blocks], I, [I-Block|Numbered]) :- I1 is I + 1, number_blocks(Blocks, I1, Numbered).

number_low(Bounds, Low)   :- low(Bounds, -1.0e9, Low).
number_high(Bounds, High) :- catch(high(Bounds, 1.0e9, High), error(_,_), High = 1.0e9).   % a bound that is unknown yet

lowest([], _, _, Low, Low).
lowest([block(_,_,Bounds,_)|Blocks], I, Pitch, Low0, Low) :-
    low(Bounds, -1.0e9, Own), Low1 is max(Low0, Own - I*Pitch), I1 is I + 1,
    lowest(Blocks, I1, Pitch, Low1, Low).

highest([], _, _, High, High).
highest([block(_,_,Bounds,_)|Blocks], I, Pitch, High0, High) :-
    high(Bounds, 1.0e9, Own), High1 is min(High0, Own - I*Pitch), I1 is I + 1,
    highest(Blocks, I1, Pitch, High1, High).

evenly_placed([], _, _).
evenly_placed([block(S,_,_,_)|Blocks], S, Pitch) :- S1 is S + Pitch, evenly_placed(Blocks, S1, Pitch).

%!  all_chains_sample(?Chains, +Gap)// is semidet: several chains, one by one, those with a wish last.

all_chains_sample(Chains, Gap) -->
    { partition(wishing, Chains, Last, First) },
    chains_sample(First, Gap),
    chains_sample(Last, Gap).

chains_sample([], _)               --> [].
chains_sample([Chain|Chains], Gap) --> chain_sample(Chain, Gap), chains_sample(Chains, Gap).

wishing(Blocks) :- is_list(Blocks), member(block(_,_,Bounds,_), Blocks), memberchk(wish(_)-_, Bounds), !.

%!  before_all(-After) is det.
%
%   After is a place before all that there is.

before_all(-1.0e9).

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
    ( ( Bound = at_least(_) ; Bound = wish(_) ) -> High1 = High0 ; arg(1, Bound, E), High1 is min(High0, E) ),
    high(Bounds, High1, High).

low([], Low, Low).
low([Bound-_|Bounds], Low0, Low) :-
    ( ( Bound = at_most(_) ; Bound = wish(_) ) -> Low1 = Low0 ; arg(1, Bound, E), Low1 is max(Low0, E) ),
    low(Bounds, Low1, Low).

starts_sample([], [], _, _, _) --> [].
starts_sample([block(S,L,Bounds,_)|Blocks], [Late|Lates], After, Gap, Free) -->
    { low(Bounds, After, Low), Low - Late < 1.0e-6 },
    (   { memberchk(at(_)-_, Bounds) }
    ->  { S = Low, Free1 = Free }
    ;   { memberchk(wish(E)-_, Bounds), lattice(real) }
    ->  { S is max(Low, min(Late, E)), Free1 is Free - 1 }
    ;   interval_sample(Low, Late, Free, S), { Free1 is Free - 1 } ),
    { After1 is S + L + Gap },
    starts_sample(Blocks, Lates, After1, Gap, Free1).
