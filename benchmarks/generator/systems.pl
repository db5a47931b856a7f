:- module(systems, [stated/2, decided/1, sampled/2]).

/** <module> The linear systems of houses' rooms, every size unknown, kept so that their solution alone is timed */

:- use_module(library(apply)).
:- use_module('../../logic/rules/room/solution').
:- use_module('../../logic/rules/linear/linear').
:- use_module('../../logic/rules/linear/sample').

%   system(?House, ?System): constraints as in linear.pl, of one room.

:- dynamic system/2.

%!  stated(+House, +Rooms) is det.
%
%   The systems of these rooms, room(Type,Layout), take the place of those that House, a number, had before.

stated(House, Rooms) :-
    retractall(system(House, _)),
    maplist(state(House), Rooms).

state(House, room(Type,Layout)) :-
    whole_system(Type, Layout, _, System),
    assertz(system(House, System)).

%!  decided(+House) is semidet.
%
%   CLP(R) finds that each of the systems has a solution.

decided(House) :- forall(system(House, System), posted(System)).

%!  sampled(+House, +Seed) is semidet.
%
%   Every unknown of each system is sampled, one by one, in what those before leave it.

sampled(House, Seed) :- forall(system(House, System), solution(System, Seed)).

solution(System, Seed) :-
    posted(System),
    term_variables(System, Unknowns),
    all_projections_sample(Unknowns, Seed, _).
