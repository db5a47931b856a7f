:- module(systems, [stated/1, decided/0, drawn/1]).

/** <module> The linear systems of a house's rooms, every size unknown, kept so that their solution alone is timed */

:- use_module(library(apply)).
:- use_module('../logic/rules/draw').
:- use_module('../logic/rules/furnish').
:- use_module('../logic/rules/linear').

:- dynamic system/1.

%!  stated(+Rooms) is det.
%
%   The systems of these rooms, room(Type,Layout), take the place of those before.

stated(Rooms) :-
    retractall(system(_)),
    maplist(state, Rooms).

state(room(Type,Layout)) :-
    furnish:whole_system(Type, Layout, _, System),
    assertz(system(System)).

%!  decided is semidet.
%
%   CLP(R) finds that each of the systems has a solution.

decided :- forall(system(System), posted(System)).

%!  drawn(+Seed) is semidet.
%
%   Every unknown of each system is drawn, one by one, in what those before leave it.

drawn(Seed) :- forall(system(System), solution(System, Seed)).

solution(System, Seed) :-
    posted(System),
    term_variables(System, Unknowns),
    drawn_each(Unknowns, Seed, _).

drawn_each([])     --> [].
drawn_each([X|Xs]) --> uniform(X), drawn_each(Xs).
