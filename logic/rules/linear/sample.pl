:- module(sample, [unit_sample//1, interval_sample//4, projection_sample//1, all_projections_sample//1]).

/** <module> Random numbers, and samples of a solved store

The numbers come from a stream of 64-bit states (the linear congruence of Knuth's MMIX, of which the top 53 bits
are used). The state is that of a DCG, and its seed comes in from outside, so a sample depends on nothing else.
*/

:- use_module(library(clpr)).
:- use_module(grid).

%!  unit_sample(-U)// is det.
%
%   U is uniform in [0,1).

unit_sample(U, S0, S) :-
    S is (S0*6364136223846793005 + 1442695040888963407) /\ 0xFFFFFFFFFFFFFFFF,
    U is (S >> 11) / 9007199254740992.0.

%!  interval_sample(+Low, +High, +Gaps, -X)// is det.
%
%   X lies in Low..High, as the start of something that has this many Gaps from its own to the last, which share the
%   slack. Then all gaps together are uniform on their simplex, for the least of N uniform numbers is 1 - U^(1/N).
%   Among whole numbers it is the same law, rounded down.

interval_sample(Low, High, Gaps, X) -->
    { lattice(Kind) },
    unit_sample(U),
    { lattice_point(Kind, Low-High, Gaps, U, X) }.

% Ends nearer than the solver's tolerance are one point, best met in the middle.
lattice_point(real, Low-High, _, _, X)     :- High - Low < 1.0e-9, !, X is (Low+High)/2.
lattice_point(real, Low-High, Gaps, U, X)  :- X is Low + (High-Low)*(1 - (1-U)**(1/Gaps)).
lattice_point(whole, Low-High, Gaps, U, X) :-
    First is ceiling(Low - 1.0e-6), Last is floor(High + 1.0e-6),
    X is min(Last, First + floor((Last-First+1)*(1 - (1-U)**(1/Gaps)))).

%!  projection_sample(?X)// is det.
%
%   X is a number, uniform in its projection. The store is a conjunction of linear constraints that has a solution, and
%   it still has one with X fixed, so this neither fails nor backtracks.

projection_sample(X) --> { number(X) }, !.
projection_sample(X) --> { inf(X, Low), sup(X, High) }, interval_sample(Low, High, 1, V), { {X = V} }.

%!  all_projections_sample(?Xs)// is det.
%
%   Each of Xs is sampled in the projection that those before it leave.

all_projections_sample([])     --> [].
all_projections_sample([X|Xs]) --> projection_sample(X), all_projections_sample(Xs).
