:- module(positions, [main/0]).

/** <module> The places in a Prolog file where it could be wrong

main/0 prints a line for each edit: operator, first and last character, the text in their place, parted by tabs.
A clause is dropped; a goal becomes `true`, in a grammar rule `[]`; a comparison is taken off by one and turned, in linear
constraints too, which are data; a number grows by 1 %, a whole one by 1 at least.
*/

:- use_module(library(clpr)).
:- use_module(library(record)).

main :-
    current_prolog_flag(argv, [File]),
    setup_call_cleanup(open(File, read, Stream, [encoding(utf8)]), clauses(Stream), close(Stream)),
    halt.

clauses(Stream) :-
    repeat,
    read_term(Stream, Term, [subterm_positions(Place), module(positions)]),
    (   Term == end_of_file
    ->  !
    ;   character_count(Stream, End),
        clause_edits(Term, Place, End),
        fail
    ).

clause_edits((:- op(Priority,Type,Names)), _, _) :- !, op(Priority, Type, Names).
clause_edits((:- _), _, _) :- !.
clause_edits(Term, Place, End) :-
    arg(1, Place, Start),
    edit(clause, Start, End, ''),
    body(Term, Place),
    parts(Term, Place).

% - goals --------------------------------------------------------------------------------------------------------------

body((_ :- Body), term_position(_,_,_,_,[_,Place])) :- !, goals(Body, Place, true).
body((_ --> Body), term_position(_,_,_,_,[_,Place])) :- !, goals(Body, Place, []).
body(_, _).

goals(Term, parentheses_term_position(_,_,Place), Nothing) :- !, goals(Term, Place, Nothing).
goals(Term, term_position(_,_,_,_,[P,Q]), Nothing) :-
    control(Term, A, B), !,
    goals(A, P, Nothing),
    goals(B, Q, Nothing).
goals({Term}, brace_term_position(_,_,Place), []) :- !, goals(Term, Place, true).
goals(Term, _, _) :- memberchk(Term, [!,[],true]), !.
goals(_, Place, Nothing) :-
    arg(1, Place, Start),
    arg(2, Place, End),
    edit(goal, Start, End, Nothing).

control((A,B), A, B).
control((A;B), A, B).
control((A->B), A, B).
control((A*->B), A, B).

% - comparisons and numbers --------------------------------------------------------------------------------------------

parts(Term, Start-End) :- !, ( number(Term) -> larger(Term, More), edit(number, Start, End, More) ; true ).
parts(Term, parentheses_term_position(_,_,Place)) :- !, parts(Term, Place).
parts({Term}, brace_term_position(_,_,Place)) :- !, parts(Term, Place).
parts(Term, list_position(_,_,Places,Tail)) :- !, elements(Places, Term, Tail).
parts(Term, term_position(_,_,Start,End,Places)) :- !,
    (   compound_name_arity(Term, Name, 2)
    ->  forall(turned(Name, Other), edit(comparison, Start, End, Other))
    ;   true
    ),
    compound_name_arguments(Term, _, Arguments),
    maplist(parts, Arguments, Places).
parts(_, _).

elements([], Term, Tail) :- ( Tail == none -> true ; parts(Term, Tail) ).
elements([Place|Places], [Term|Terms], Tail) :- parts(Term, Place), elements(Places, Terms, Tail).

turned(<, =<).      turned(=<, <).       turned(>, >=).      turned(>=, >).
turned(<, >).       turned(=<, >=).      turned(>, <).       turned(>=, =<).
turned(@<, @>).     turned(@>, @<).      turned(==, \==).    turned(\==, ==).
turned(=:=, =\=).   turned(=\=, =:=).    turned(\=, =).

larger(N, More) :- integer(N), !, More is N + max(1, round(abs(N)/100)).
larger(X, More) :- More is 1.01*X.

edit(Operator, Start, End, After) :- format("~w\t~d\t~d\t~w~n", [Operator,Start,End,After]).
