:- module(draw, [random//1, between_ends//4, uniform//1, lattice/1]).

/** <module> Random numbers, and drawing with them from a solved store

The numbers come from a stream of 64-bit states (the linear congruence of Knuth's MMIX, of which the top 53 bits
are used), threaded through as the state of a DCG. Its seed comes in from outside, so a draw depends on nothing else.
*/

:- use_module(library(clpr)).

:- dynamic lattice/1.

%!  lattice(-Kind) is det.
%
%   Kind is `real`, or `whole` where all lengths are whole numbers (of cells).

lattice(real).

%!  random(-U)// is det.
%
%   U is uniform in [0,1).

random(U, S0, S) :-
    S is (S0*6364136223846793005 + 1442695040888963407) /\ 0xFFFFFFFFFFFFFFFF,
    U is (S >> 11) / 9007199254740992.0.

%!  between_ends(+Low, +High, +Gaps, -X)// is det.
%
%   X lies in Low..High, as the start of something with so many Gaps behind it, its own among them, that share the
%   slack: then all gaps together are uniform on their simplex, for the least of N uniform numbers is
%   1 - U^(1/N). Among whole numbers it is the same law rounded down.

between_ends(Low, High, Gaps, X) --> { lattice(Kind) }, random(U), { point(Kind, Low, High, Gaps, U, X) }.

% Ends nearer than the solver's tolerance are one point, best met in the middle.
point(real, Low, High, _, _, X)     :- High - Low < 1.0e-9, !, X is (Low+High)/2.
point(real, Low, High, Gaps, U, X)  :- X is Low + (High-Low)*(1 - (1-U)**(1/Gaps)).
point(whole, Low, High, Gaps, U, X) :-
    First is ceiling(Low - 1.0e-6), Last is floor(High + 1.0e-6),
    X is min(Last, First + floor((Last-First+1)*(1 - (1-U)**(1/Gaps)))).

%!  uniform(?X)// is det.
%
%   Fixes X uniformly in its projection: the store is a conjunction of linear constraints that has a solution, and
%   has one still, so this neither fails nor backtracks.

uniform(X) --> { number(X) }, !.
uniform(X) --> { inf(X, Low), sup(X, High) }, between_ends(Low, High, 1, V), { {X = V} }.
