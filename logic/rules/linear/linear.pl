:- module(linear, [posted/1, posted/2, interval/3, minimal_conflict/2, conflict_at/4, rows/2]).

/** <module> A linear system as data

A constraint is (A =< B)-Why or (A = B)-Why: linear expressions, and why it binds (reasons.pl). Data can be posted to
CLP(R), searched for a part that has no solution, and handed to another solver.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(library(yall)).

%!  posted(+Constraints) is semidet.
%
%   CLP(R) holds them all; fails if, and only if, they have no solution together with what is posted already.

posted([]).
posted([Constraint-_|Constraints]) :- post(Constraint), posted(Constraints).

% Much is known by then, and arithmetic is quicker than the solver.
post(A =< B) :- ground(A-B), !, A - B < 1.0e-9.
post(A = B)  :- ground(B), !, V is B, ( var(A), \+ attvar(A) -> A = V ; ground(A) -> abs(A-V) < 1.0e-9 ; {A = V} ).
post(A =< B) :- {A =< B}.
post(A = B)  :- {A = B}.

%!  posted(+Constraints, -Count) is det.
%
%   CLP(R) holds the first Count of them: all, or those before the first that has no solution together with them.

posted(Constraints, Count) :- fitting(Constraints, 0, Count).

fitting([], Count, Count).
fitting([Constraint-_|Constraints], Count0, Count) :-
    (   post(Constraint)
    ->  Count1 is Count0 + 1,
        fitting(Constraints, Count1, Count)
    ;   Count = Count0 ).

%!  interval(+X, +Constraints, -Range) is semidet.
%
%   Range is Low-High, what inequalities leave of X, their one unknown, which each has once. The numbers are those of
%   CLP(R), bit for bit, at a tenth of its cost.

interval(X, Constraints, Range) :- narrowed(Constraints, X, -inf-inf, Range).

narrowed([], _, Low-High, Low-High) :- Low - High < 1.0e-10.
narrowed([(A =< B)-_|Constraints], X, Low-High, Range) :-
    (   ground(A-B)
    ->  A - B < 1.0e-9, Low1 = Low, High1 = High
    ;   copy_term(X-A-B, 0-A0-B0),
        ( ground(A) -> Low1 is max(Low, A0-B0), High1 = High ; Low1 = Low, High1 is min(High, B0-A0) ) ),
    narrowed(Constraints, X, Low1-High1, Range).

%!  minimal_conflict(+Constraints, -Conflict) is semidet.
%
%   Conflict is a minimal part of them that has no solution: leave one out and there is one. Fails if the whole has
%   one. (The additive method of Tamiz, Mardle and Jones: what makes all before it fail is needed.)

minimal_conflict(Constraints, Conflict) :- conflict_with(Constraints, [], Conflict).

conflict_with(Constraints, Needed, Conflict) :-
    (   \+ posted(Needed)
    ->  Conflict = Needed
    ;   culprit(Constraints, Needed, Before, Culprit),
        conflict_with(Before, [Culprit|Needed], Conflict) ).

culprit(Constraints, Needed, Before, Culprit) :-
    findall(Count, ( posted(Needed), posted(Constraints, Count), \+ length(Constraints, Count) ), [Count]),
    conflict_at(quick, Constraints, Count, [Culprit|Before]).

%!  conflict_at(+Proof, +Constraints, +Count, -Conflict) is det.
%
%   Conflict is one among the constraints up to the first that does not fit, after Count that do: a minimal one, or all
%   of them where Proof is `quick`.

conflict_at(quick, Constraints, Count, [Culprit|Before]) :-
    length(Before, Count),
    append(Before, [Culprit|_], Constraints).
conflict_at(minimal, Constraints, Count, Conflict) :-
    conflict_at(quick, Constraints, Count, [Culprit|Before]),
    conflict_with(Before, [Culprit], Conflict).

%!  rows(+Constraints, -Rows) is det.
%
%   Rows are [Coefficients,Constant,Relation] for the sum of Coefficients, pairs of a variable's number and its
%   factor, and the Constant that is Relation ("=<" or "=") to zero: what any solver of linear programs reads.

rows(Constraints, Rows) :-
    copy_term(Constraints, Numbered),
    term_variables(Numbered, Variables),
    foldl([v(N),N,N1]>>(N1 is N+1), Variables, 0, _),
    maplist(row, Numbered, Rows).

row((A =< B)-_, [Pairs,Constant,"=<"]) :- !, difference(A, B, Pairs, Constant).
row((A = B)-_,  [Pairs,Constant,"="])  :- difference(A, B, Pairs, Constant).

difference(A, B, Pairs, Constant) :-
    phrase((terms(A, 1), terms(B, -1)), Terms),
    partition([_-_]>>true, Terms, Factors, Constants),
    sum_list(Constants, Constant),
    keysort(Factors, Sorted),
    group_pairs_by_key(Sorted, Grouped),
    maplist([V-Fs,[V,F]]>>sum_list(Fs, F), Grouped, Pairs).

terms(v(N), F)  --> !, [N-F].
terms(A+B, F)   --> !, terms(A, F), terms(B, F).
terms(A-B, F)   --> !, { G is -F }, terms(A, F), terms(B, G).
terms(-A, F)    --> !, { G is -F }, terms(A, G).
terms(A*B, F)   --> { number(A) }, !, { G is F*A }, terms(B, G).
terms(A*B, F)   --> !, { G is F*B }, terms(A, G).
terms(A, F)     --> { C is F*A }, [C].
