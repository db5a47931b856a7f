:- module(exact, [exactly_posted/1, exact_conflict/3, rational_number/2]).

/** <module> What CLP(R) refutes, confirmed in CLP(Q)

CLP(R) computes in floating point and takes what differs by less than 1e-10 for equal. Whether it finds a solution of many
constraints may depend on the order in which they are posted, so what it refutes is proved in rational arithmetic
before it counts. A number of the constraints is taken as it is written: 0.1 is 1/10.
*/

:- use_module(library(apply)).
:- use_module(library(clpq), []).
:- use_module(library(lists)).
:- use_module(linear).

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
%
%   Conflict is a part of the constraints that has no solution, a minimal one where Proof is `minimal`. Fails if all of
%   them have one. What CLP(R) finds is confirmed; where it is wrong, CLP(Q) searches.

exact_conflict(Proof, Constraints, Conflict) :-
    (   floating_conflict(Proof, Constraints, Conflict0),
        \+ exactly_posted(Conflict0)
    ->  Conflict = Conflict0
    ;   \+ exactly_posted(Constraints),
        minimal_part(Constraints, Constraints, Conflict) ).

floating_conflict(minimal, Constraints, Conflict) :- minimal_conflict(Constraints, Conflict).
floating_conflict(quick, Constraints, Conflict)   :- quick_conflict(Constraints, Conflict).

%   minimal_part(+Left, +All, -Part): each of those Left is left out of All if the others have no solution either.

minimal_part([], Part, Part).
minimal_part([C|Cs], All, Part) :-
    exclude(==(C), All, Others),
    ( exactly_posted_not(Others) -> minimal_part(Cs, Others, Part) ; minimal_part(Cs, All, Part) ).

exactly_posted_not(Constraints) :- \+ exactly_posted(Constraints).
