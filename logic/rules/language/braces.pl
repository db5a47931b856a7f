:- module(braces, [constraint_fault/5, decimal_comma/3]).

/** <module> What stands in braces and is no linear constraint: seen as it is written, before anything is run */

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(written).

%!  constraint_fault(+Source, +Names, +Constraints, +Position, -Fault) is nondet.
%
%   Fault is Position-Text for a part of the Constraints, what a clause has in braces, that CLP(R) refuses. Names are those of
%   the clause's variables.

constraint_fault(Source, Names, Constraints, Position, Fault) :-
    phrase(conjuncts(Constraints, Position), Conjuncts),
    phrase(faults(Conjuncts, Source, Names), Faults),
    member(Fault, Faults).

conjuncts(C, parentheses_term_position(_,_,P)) --> !, conjuncts(C, P).
conjuncts(C, term_position(_,_,_,_,[PA,PB]))   --> { nonvar(C), ( C = (A,B) ; C = (A;B) ) }, !, conjuncts(A, PA), conjuncts(B, PB).
conjuncts(C, P) --> [C-P].

faults([], _, _) --> [].
faults([A,B|Others], Source, Names) --> { two_terms(A, B, Source, Fault) }, !, [Fault], faults(Others, Source, Names).
faults([A|Others], Source, Names) -->
    { A = C-P, findall(At-Text, fault(C, P, Source, Names, At, Text), Faults) },
    faults_all(Faults), faults(Others, Source, Names).

faults_all([]) --> [].
faults_all([F|Fs]) --> [F], faults_all(Fs).

%   two_terms(+A, +B, +Source, -Fault): a comma in a number parts it: 4,6 are the ends of two conjuncts.

two_terms(A-PA, B-PB, Source, Position-Text) :-
    \+ ( nonvar(B), relation(B, _, _) ),
    findall(X-P, part(A, PA, X, P), As), last(As, M-Last),
    findall(X-P, ( part(B, PB, X, P), number(X) ), [N-First|_]),
    integer(M), integer(N),
    arg(1, Last, From), arg(1, First, Second), arg(2, First, To),
    start(PB, Second),
    Position = From-To,
    decimal_comma(Source, Position, Text).

%!  decimal_comma(+Source, +Position, -Text) is det.
%
%   Text says what is wrong with the number at this Position, which has a comma in it.

decimal_comma(Source, Position, Text) :-
    wording(Source, Position, Said),
    split_string(Said, ",", " ", Parts), atomic_list_concat(Parts, '.', Meant),
    format(string(Text), "~w is read as two terms: write ~w", [Said, Meant]).

fault(C, P, Source, _, P, Text) :- var(C), !,
    said("~w is only a variable: state a bound, as in ~w =< 4.6", [P,P], Source, Text).
fault(C, term_position(_,_,_,_,[PA,PB]), Source, Names, At, Text) :- relation(C, A, B), !,
    ( wrong(A, PA, Source, Names, At, Text) ; wrong(B, PB, Source, Names, At, Text) ).
fault(C, P, Source, _, At, Text) :-
    compound(C), compound_name_arity(C, Name, 2), misread(Name, Meant), !,
    P = term_position(_,_,From,To,_), At = From-To,
    wording(Source, At, Said),
    format(string(Text), "~w is not a constraint: write ~w", [Said, Meant]).
fault(_, P, Source, _, P, Text) :-
    said("~w is not a constraint: state a bound by =<, >= or =", [P], Source, Text).

relation(A =< B, A, B).   relation(A >= B, A, B).   relation(A = B, A, B).
relation(A < B, A, B).    relation(A > B, A, B).    relation(A =:= B, A, B).

misread(=>, >=).    misread(<=, =<).    misread(≤, =<).     misread(≥, >=).    misread(==, =).     misread(is, =).
misread(#=<, =<).   misread(#>=, >=).   misread(#<, <).     misread(#>, >).    misread(#=, =).     misread(===, =).
misread(and, "a comma").                misread(or, "one bound: a size has one range").
misread(=\=, "one bound: a size has one range").   misread(<>, "one bound: a size has one range").
misread(#\=, "one bound: a size has one range").   misread(\=, "one bound: a size has one range").

%   wrong(+Expression, +Position, +Source, +Names, -At, -Text) is nondet: a part of it is no arithmetic.

wrong(E, _, _, _, _, _) :- var(E), !, fail.
wrong(E, _, _, _, _, _) :- number(E), !, fail.
wrong(E, parentheses_term_position(_,_,P), Source, Names, At, Text) :- !, wrong(E, P, Source, Names, At, Text).
wrong(E, P, Source, _, P, Text) :- string(E), !,
    wording(Source, P, Said),
    format(string(Text), "~w is text, not a number: write ~w without quotes", [Said, E]).
wrong(E, P, Source, Names, P, Text) :- atom(E), !,
    (   member(Name=_, Names), downcase_atom(Name, Low), downcase_atom(E, Low)
    ->  format(string(Text), "~w is a name, not a number: did you mean the variable ~w?", [E, Name])
    ;   said("~w is a name, not a number: a variable begins in upper case", [P], Source, Text) ).
wrong(E, term_position(_,_,_,_,Ps), Source, Names, At, Text) :- arithmetic(E), !,
    E =.. [_|Es], nth1(N, Es, A), nth1(N, Ps, P),
    wrong(A, P, Source, Names, At, Text).
wrong(_, P, Source, _, P, Text) :-
    said("~w is not arithmetic: CLP(R) accepts numbers, variables, +, -, * and /", [P], Source, Text).

arithmetic(E) :-
    functor(E, Name, Arity),
    memberchk(Name/Arity, [(+)/2,(-)/2,(*)/2,(/)/2,(-)/1,(+)/1,(^)/2,sin/1,cos/1,tan/1,abs/1,min/2,max/2,exp/2,pow/2]).

said(Format, Positions, Source, Text) :-
    maplist(wording(Source), Positions, Words),
    format(string(Text), Format, Words).
