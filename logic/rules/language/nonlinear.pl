:- module(nonlinear, [nonlinear/2, linear_instead/2]).

/** <module> Constraints that CLP(R) suspends, since they are not linear */

:- use_module(library(apply)).
:- use_module(library(lists)).

%!  nonlinear(+Constraint, -Term) is semidet.
%
%   Term is a part of the Constraint that is nonlinear.

nonlinear(Constraint, Term) :-
    compound_name_arguments(Constraint, _, [A,B]),
    ( curved(A, Term) ; curved(B, Term) ), !.

curved(E, Term) :- nonvar(E), \+ ground(E), curved_(E, Term).

curved_(A*B, A*B)  :- \+ ground(A), \+ ground(B), !.
curved_(A/B, A/B)  :- \+ ground(B), !.
curved_(E, E)      :- \+ ( functor(E, Name, _), memberchk(Name, [+,-,*,/]) ), !.
curved_(E, Term)   :- E =.. [_|Es], member(A, Es), curved(A, Term), !.

%!  linear_instead(+Constraint, -Text) is semidet.
%
%   Text says what to write instead. Fails if the Constraint is linear.

linear_instead(Constraint, Text) :- nonlinear(Constraint, Term), instead(Term, Text).

instead(A*B, "bound a side by a number (W =< 4.0), or the sum of both (W + D =< 7.0)") :- A \== B, !.
instead(_/_, "multiply by the divisor (W >= 1.5*D for W/D >= 1.5)") :- !.
instead(_,   "bound the size itself by numbers (W =< 4.0)").
