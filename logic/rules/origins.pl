:- module(origins, [origins/2, sized/1]).

/** <module> Where the grammar's clauses stand in its files */

:- use_module(library(apply)).
:- use_module(grammar).

%!  origins(+Clauses, -Origins) is det.
%
%   Clauses are length(Name), size(RoomType) or size(RoomType,Piece). Origins are [Clause,File,Line] for those that the
%   grammar states, each with the place of the first clause for it.

origins(Clauses, Origins) :- convlist(origin, Clauses, Origins).

origin(Clause, [Text,File,Line]) :-
    head(Clause, Head),
    once(clause(grammar:Head, _, Reference)),
    clause_property(Reference, file(File)),
    clause_property(Reference, line_count(Line)),
    term_string(Clause, Text).

%!  sized(-Clauses) is det.
%
%   Clauses are [Predicate,Name,File,Line] for each clause that gives a named type of room or piece its size.

sized(Clauses) :-
    findall([Predicate,Name,File,Line],
            ( sizes(Predicate, Head, Name), clause(grammar:Head, _, Reference), atom(Name),
              clause_property(Reference, file(File)), clause_property(Reference, line_count(Line)) ),
            Clauses).

sizes(room_size,  room_size(Name,_,_),    Name).
sizes(piece_size, piece_size(Name,_,_,_), Name).

head(length(Name), Head) :- Head =.. [Name,_].
head(size(Type),    room_size(Type,_,_)).
head(size(_,Piece), piece_size(Piece,_,_,_)).
