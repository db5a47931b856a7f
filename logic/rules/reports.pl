:- module(reports, [length_report/2, room_report/2, piece_report/3]).

/** <module> Whether the grammar's clauses give lengths that can be used, and the extremes of those that do

A report is a length in metres or a list of four extremes; or a text that says why the clause cannot be used; or null
where the grammar has no clause.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(solution_sequences)).
:- use_module(grammar_files).
:- use_module(grid).
:- use_module(lengths).

%!  length_report(+Name, -Report) is det.
%
%   Report is the named length, a text or null.

length_report(Name, Report) :-
    findall(M, stated_length(Name, M), Stated),
    length_judged(Stated, Report).

length_judged([], null).
length_judged([M|Ms], Report) :-
    (   Ms \== []
    ->  Report = "is stated more than once"
    ;   number(M), M >= 0
    ->  rounded_up(M, Length), metres(Length, Report)
    ;   Report = "is not a number of metres, 0 or more" ).

%!  room_report(+Type, -Report) is det.
%
%   Report lists the least and greatest width and depth, or is a text or null.

room_report(Type, Report) :-
    clause_report([W,D], [], grammar:room_size(Type, W, D), Report),
    ( is_list(Report) -> room_extent(Type, _, _) ; true ).

%!  piece_report(+Type, +Piece, -Report) is det.
%
%   Report lists the least and greatest length and depth in a room of this type, or is a text or null.

piece_report(Type, Piece, Report) :-
    (   room_range(Type, W1-W2, D1-D2)
    ->  Least is min(W1, D1), Most is max(W2, D2),
        { Wall >= Least, Wall =< Most },
        clause_report([L,D], [Wall], grammar:piece_size(Piece, L, D, Wall), Report),
        ( is_list(Report) -> piece_extent(Type, Piece, _, _) ; true )
    ;   Report = [0,0,0,0] ).

%   clause_report(+Sizes, +Given, :Clause, -Report): of Sizes under the one solution of Clause, which may use the Given.

clause_report(Sizes, Given, Clause, Report) :-
    call_with_inference_limit(solution_report(Sizes, Given, Clause, Found), 1 000 000, Result),
    ( Result == inference_limit_exceeded -> Report = "recurs without end" ; Report = Found ).

solution_report(_, _, Clause, null) :- \+ Clause, !.
solution_report(_, _, Clause, "has more than one solution: state one") :-
    findall(x, limit(2, Clause), [_,_]), !.
solution_report(Sizes, Given, Clause, Report) :-
    once(Clause),
    append(Sizes, Given, All),
    once(size_report(Sizes, All, Report)).

size_report(_, All, Report) :-
    nonlinear(All, Constraint),
    format(string(Report), "has the nonlinear constraint ~p, and CLP(R) decides linear ones", [Constraint]).
size_report(Sizes, _, "is not bounded on both sides") :- \+ maplist(extremes, Sizes, _).
size_report(Sizes, _, "allows a size that is not positive") :- member(X, Sizes), extremes(X, Low-_), Low =< 0.
size_report(Sizes, _, Report) :-
    maplist(extremes, Sizes, Ranges),
    maplist(rounded_range, Ranges, [L-LL,D-DD]),
    maplist(metres, [L,LL,D,DD], Report).

nonlinear(Sizes, Constraint) :-
    copy_term(Sizes, _, Goals),
    member({Conjunction}, Goals),
    conjunct(Constraint, Conjunction),
    Constraint =.. [_, A, B],
    \+ ( linear_expression(A), linear_expression(B) ).

conjunct(G, (A,B)) :- !, ( conjunct(G, A) ; conjunct(G, B) ).
conjunct(G, G).

linear_expression(X)   :- var(X), !.
linear_expression(X)   :- number(X).
linear_expression(A+B) :- linear_expression(A), linear_expression(B).
linear_expression(A-B) :- linear_expression(A), linear_expression(B).
linear_expression(-A)  :- linear_expression(A).
linear_expression(A*B) :- ( number(A) -> linear_expression(B) ; number(B), linear_expression(A) ).
