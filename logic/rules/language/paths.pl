:- module(paths, [clause_path/5, conflict/2]).

/** <module> What a clause does, step by step, with the words of its author

A path is one way through a clause and the predicates of the grammar that it calls. Its steps are step(Goal,Live,Words):
Goal is a constraint, as post(C), or another goal; Live is the same after it was run; Words are source(File,Text)-Position,
or said(Format,Arguments) for what is given.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(grammar_files).
:- use_module(written).

%!  clause_path(+Terms, +Clause, +Given, ?Query, -Path) is nondet.
%
%   Clause is one of the Terms of the grammar's files. Given is Constraints-Head: pairs of a constraint on the variables of
%   the Head, which is called, and its words. The call is Live, under the constraints along the path. Path is
%   path(Steps,End): End is holds, or fails or raises(Error) in the last of the Steps.

clause_path(Terms, Clause, Given, Live, path(Steps,End)) :-
    copy_term(Given, Constraints0-Live),
    copy_term(Given, Constraints-Head),
    maplist(given, Constraints, Constraints0, First),
    entered(Clause, Head, Live, Body),
    append(First, [Body], Goals),
    path(Goals, Terms, Steps, End).

given(C-Words, C0-_, goal(post(C),post(C0),none,Words)).

%   entered(+Clause, ?Head, ?Live, -Body) is semidet: the clause twice. The one is run; the other stays as it is written, for
%   what is run binds variables.

entered(term(Source,_,clause(Head,Body,_,P,_,_)), Head1, Head2, goal(Body1,Body2,P,Source)) :-
    copy_term(Head-Body, Head1-Body1),
    copy_term(Head-Body, Head2-Body2).

path([], _, [], holds).
path([goal(Goal,Live,parentheses_term_position(_,_,P),Source)|Goals], Terms, Steps, End) :- !,
    path([goal(Goal,Live,P,Source)|Goals], Terms, Steps, End).
path([Goal|Goals], Terms, Steps, End) :-
    opened(Goal, Inner), !,
    append(Inner, Goals, All),
    path(All, Terms, Steps, End).
path([goal((A;B),(A1;B1),term_position(_,_,_,_,[P,Q]),Source)|Goals], Terms, Steps, End) :- !,
    branch(goal(A,A1,P,Source), goal(B,B1,Q,Source), Inner),
    append(Inner, Goals, All),
    path(All, Terms, Steps, End).
path([goal(Goal,Live,_,_)|Goals], Terms, Steps, End) :-
    \+ \+ called(Goal, Live, Terms, _), !,
    called(Goal, Live, Terms, Body),
    path([Body|Goals], Terms, Steps, End).
path([goal(Goal,Live,P,Source)|Goals], Terms, [step(Goal,Live,Words)|Steps], End) :-
    ( Source = said(_,_) -> Words = Source ; Words = Source-P ),
    (   catch(run(Live), Error, true)
    *-> (   nonvar(Error) -> Steps = [], End = raises(Error) ; path(Goals, Terms, Steps, End) )
    ;   Steps = [], End = fails ).

called(Goal, Live, Terms, Body) :-
    callable(Goal), functor(Goal, Name, Arity),
    member(Clause, Terms), Clause = term(_,_,clause(Head,_,_,_,_,_)), functor(Head, Name, Arity),
    entered(Clause, Goal, Live, Body).

opened(goal((A,B),(A1,B1),term_position(_,_,_,_,[P,Q]),S), [goal(A,A1,P,S),goal(B,B1,Q,S)]).
opened(goal({C},{C1},brace_term_position(_,_,P),S), [goal(post(C),post(C1),P,S)]).
opened(goal(post((A,B)),post((A1,B1)),term_position(_,_,_,_,[P,Q]),S), [goal(post(A),post(A1),P,S),goal(post(B),post(B1),Q,S)]).
opened(goal(once(A),once(A1),term_position(_,_,_,_,[P]),S), [goal(A,A1,P,S)]).
opened(goal(true,_,_,_), []).
opened(goal(!,_,_,_), []).

branch(goal((If->Then),(If1->Then1),term_position(_,_,_,_,[P,Q]),S), Else, Goals) :- !,
    (   catch(\+ run(If1), _, fail)
    ->  Goals = [Else]
    ;   Goals = [goal(If,If1,P,S),goal(Then,Then1,Q,S)] ).
branch(Either, _, [Either]).
branch(_, Or, [Or]).

run(post(C)) :- !, {C}.
run(Goal)    :- grammar:Goal.

%!  conflict(+Steps, -Conflict) is semidet.
%
%   Conflict is a minimal part of the Steps that fails: leave one out and the others hold. The first are left out first. Fails
%   if the Steps hold.

conflict(Steps, Conflict) :-
    excluded(Steps),
    needed(Steps, [], Conflict).

needed([], Conflict, Conflict).
needed([Step|Steps], Kept, Conflict) :-
    append(Kept, Steps, Others),
    (   excluded(Others)
    ->  needed(Steps, Kept, Conflict)
    ;   append(Kept, [Step], Kept1),
        needed(Steps, Kept1, Conflict) ).

excluded(Steps) :- catch(\+ maplist(run_step, Steps), _, fail).

run_step(step(Goal,_,_)) :- run(Goal).
