:- module(origins, [clause_origins/2, size_clauses/1]).

/** <module> Where the grammar's clauses stand in its files */

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module(grammar_files).
:- use_module(written).

%!  clause_origins(+Clauses, -Origins) is det.
%
%   Clauses are length(Name), size(RoomType), size(RoomType,Piece), or named by their predicates. Origins are [Clause,File,Line] for those that the
%   grammar states, each with the place of the first clause for it.

clause_origins(Clauses, Origins) :-
    grammar_terms(Terms),
    convlist(clause_origin(Terms), Clauses, Origins).

clause_origin(Terms, Clause, [Text,File,Line]) :-
    clause_head(Clause, Head),
    member(term(source(File,Written),_,clause(H,_,Position,_,_,_)), Terms), \+ H \= Head, !,
    place(source(File,Written), Position, Line, _),
    term_string(Clause, Text).

%!  size_clauses(-Clauses) is det.
%
%   Clauses are [Predicate,Name,File,Line,Column] for each clause that gives a named type of room or piece a size or an area.

size_clauses(Clauses) :-
    grammar_terms(Terms),
    findall([Predicate,Name,File,Line,Column],
            ( member(term(source(File,Text),_,clause(Head,Body,P,_,_,_)), Terms),
              size_head(Predicate, Head, Type), named(Head, Body, Type, Name),
              place(source(File,Text), P, Line, Column) ),
            Clauses).

size_head(room_size,   room_size(Name,_,_),    Name).
size_head(piece_size,  piece_size(Name,_,_,_), Name).
size_head(room_area,   room_area(Name,_,_),    Name).
size_head(whole_area,  whole_area(Name,_,_),  Name).
size_head(window_size, window_size(Name,_,_),  Name).
size_head(turning,     turning(Name,_),        Name).
size_head(opening_size, opening_size(Name,_,_,_), Name).
size_head(opening_size, opening_size(_,Name,_,_), Name).

%   named(+Head, +Body, +Type, -Name) is nondet: what the clause is for, as written; or as its body gives it.

named(_, _, Type, Name) :- nonvar(Type), !, ( atom(Type) -> Name = Type ; term_to_atom(Type, Name) ).
named(Head, Body, Type, Name) :-
    copy_term(Head-Body-Type, _-Live-T),
    catch(call_with_inference_limit(findnsols(100, T, grammar:Live, Types), 300 000, Result), _, fail), !,
    Result \== inference_limit_exceeded,
    sort(Types, Distinct), member(Each, Distinct), nonvar(Each), ( atom(Each) -> Name = Each ; term_to_atom(Each, Name) ).

clause_head(length(inner_wall), Head) :- !, Head = wall_thickness(inner,_).
clause_head(length(Name), Head) :- Head =.. [Name,_].
clause_head(door_width(T,U),    door_width(T,U,_)).
clause_head(size(Type),    room_size(Type,_,_)).
clause_head(size(_,Piece), piece_size(Piece,_,_,_)).
clause_head(room_area(Type),   room_area(Type,_,_)).
clause_head(whole_area(Type),  whole_area(Type,_,_)).
clause_head(window_size(Type), window_size(Type,_,_)).
clause_head(opening_size(T,U), opening_size(T,U,_,_)).
clause_head(turning(Type),     turning(Type,_)).
clause_head(house_size,        house_size(_,_)).
clause_head(house_area,        house_area(_,_)).
clause_head(unit_depth,        unit_depth(_)).
