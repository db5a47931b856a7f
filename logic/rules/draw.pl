:- module(draw, [uniform//1, uniform//3, start//2, lowest/1, highest/1]).

/** <module> Drawing numbers from a solved store

The store holds a conjunction of linear constraints that has a solution. A variable is fixed at a random point
of its projection, which leaves a solution again, so a draw never fails and never backtracks. The random
numbers, uniform in [0,1), come in as a list.
*/

:- use_module(library(clpr)).

%!  uniform(?X)// is det.
%
%   Fixes X uniformly in its projection.

uniform(X) --> start(X, 1).

%!  uniform(?X, +Low, +High)// is det.
%
%   The same law where the projection is known to lie within Low..High: a point of that range which the store
%   takes is uniform in the projection already, and saves two simplex runs. One that it refuses is spent.

uniform(X, _, _)      --> { number(X) }, !.
uniform(X, Low, High) --> [U], { V is Low + U*(High-Low), {X = V} }, !.
uniform(X, _, _)      --> [_], uniform(X).

%!  start(?X, +Gaps)// is det.
%
%   Fixes X, where a piece starts on a chain, with so many Gaps behind it that share the slack: then all gaps
%   of the chain together are uniform on their simplex (the least of N uniform numbers is 1 - U^(1/N)).

start(X, _)    --> { number(X) }, !.
start(X, Gaps) --> [U], { inf(X, Low), sup(X, High), between_ends(Low, High, U, Gaps, V), {X = V} }.

% Ends nearer than the solver's tolerance are one point, best met in the middle.
between_ends(Low, High, _, _, V) :- High - Low < 1.0e-9, !, V is (Low+High)/2.
between_ends(Low, High, U, Gaps, V) :- V is Low + (High-Low)*(1 - U**(1/max(1,Gaps))).

%!  lowest(?X) is det.
%!  highest(?X) is det.
%
%   Fixes X at an end of its projection.

lowest(X)  :- ( number(X) -> true ; inf(X, V), {X = V} ).
highest(X) :- ( number(X) -> true ; sup(X, V), {X = V} ).
