:- module(exact, [exactly_posted/1, exact_conflict/3, exact_conflict/4, confirmed_conflict/4, exactly_sampled//1, solver_verdicts/2]).

/** <module> What CLP(R) refutes, confirmed in CLP(Q)

CLP(R) computes in floating point and takes what differs by less than 1e-10 for equal. Whether it finds a solution of many
constraints may depend on the order in which they are posted, so what it refutes is proved in rational arithmetic
before it counts. A number of the constraints is taken as it is written: 0.1 is 1/10.
*/

:- use_module(library(apply)).
:- use_module(library(clpq), []).
:- use_module(library(lists)).
:- use_module(grid).
:- use_module(linear).
:- use_module(sample).

%!  exactly_posted(+Constraints) is semidet.
%
%   CLP(Q) holds them all, of which no unknown is one of CLP(R); fails if, and only if, they have no solution.

exactly_posted([]).
exactly_posted([Constraint-_|Constraints]) :-
    rational_terms(Constraint, Exact),
    clpq:{Exact},
    exactly_posted(Constraints).

rational_terms(X, X) :- var(X), !.
rational_terms(X, Y) :- number(X), !, rational_number(X, Y).
rational_terms(X, Y) :- X =.. [F|As], maplist(rational_terms, As, Bs), Y =.. [F|Bs].

%!  rational_number(+Number, -Rational) is det.

rational_number(X, Y) :- Y is rationalize(X).

%!  exact_conflict(+Proof, +Constraints, -Conflict) is semidet.
%!  exact_conflict(+Proof, +Constraints, +Count, -Conflict) is semidet.
%
%   Conflict is a part of the constraints that has no solution, a minimal one where Proof is `minimal`. Fails if all of
%   them have one. What CLP(R) finds, which holds the first Count of them, is confirmed; where it is wrong, CLP(Q) searches.

exact_conflict(Proof, Constraints, Conflict) :-
    findall(Count, posted(Constraints, Count), [Count]),
    exact_conflict(Proof, Constraints, Count, Conflict).

exact_conflict(Proof, Constraints, Count, Conflict) :-
    (   confirmed_conflict(Proof, Constraints, Count, Conflict0)
    ->  Conflict = Conflict0
    ;   exactly_posted_not(Constraints),
        minimal_part(Constraints, Constraints, Conflict) ).

%!  confirmed_conflict(+Proof, +Constraints, +Count, -Conflict) is semidet.
%
%   The same, as far as CLP(R) finds it: fails too where it finds none that CLP(Q) confirms.

confirmed_conflict(Proof, Constraints, Count, Conflict) :-
    conflict_at(Proof, Constraints, Count, Conflict),
    exactly_posted_not(Conflict).

%   minimal_part(+Left, +All, -Part): each of those Left is left out of All if the others have no solution either.

minimal_part([], Part, Part).
minimal_part([C|Cs], All, Part) :-
    exclude(==(C), All, Others),
    ( exactly_posted_not(Others) -> minimal_part(Cs, Others, Part) ; minimal_part(Cs, All, Part) ).

exactly_posted_not(Constraints) :- \+ exactly_posted(Constraints).

%!  exactly_sampled(+Unknowns)// is det.
%
%   Unknowns are Gaps-X, where CLP(Q) holds all constraints. Each X becomes a rational number, sampled in what those before
%   it leave, as by interval_sample//4; a whole one on a grid.

exactly_sampled([]) --> [].
exactly_sampled([Gaps-X|Unknowns]) -->
    (   { number(X) }
    ->  []
    ;   { clpq:inf(X, Low), clpq:sup(X, High), lattice(Kind) },
        exact_point_sample(Kind, Low-High, Gaps, V),
        { clpq:{X = V} } ),
    exactly_sampled(Unknowns).

exact_point_sample(real, Low-High, Gaps, V) -->
    interval_sample(0.0, 1.0, Gaps, U),
    { rational_number(U, Q), V is Low + (High-Low)*Q }.
exact_point_sample(whole, Low-High, Gaps, V) --> interval_sample(Low, High, Gaps, V).

%!  solver_verdicts(+Constraints, -Record) is det.
%
%   Record is the linear system, "rows" as in linear.pl, and whether it has a solution as CLP(R) finds ("real") and CLP(Q)
%   ("rational").

solver_verdicts(Constraints, _{rows:Rows, real:Real, rational:Rational}) :-
    rows(Constraints, Rows),
    ( \+ posted(Constraints) -> Real = false ; Real = true ),
    ( exactly_posted_not(Constraints) -> Rational = false ; Rational = true ).
