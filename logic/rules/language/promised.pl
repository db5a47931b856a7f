:- module(promised, [grammar_metres/3]).

/** <module> What a grammar's clauses say of lengths and areas, as it is written: houses keep it, whatever their grid */

:- use_module('../answers').
:- use_module(grammar_files).
:- use_module(lengths).

%!  grammar_metres(+Names, +Types, -Json) is det.
%
%   Json gives [Name,Metres] of the lengths of these names, and [Type,Least,Most] of the areas of rooms of these types, square
%   metres, of those that are stated, the same of `wholes` with their parts, the `total` area of the house, [Least,Most] or null, [Type,Metres] of the free squares, and
%   the thickness of `walls`, [Inner,Outer] or null; of `doors` [Type,Other,Metres].

grammar_metres(Names, Types, Json) :-
    findall([N,M], ( member(N, Names), once(stated_length(N, M)) ), Lengths),
    findall([T,Least,Most], ( member(T, Types), once(grammar:room_area(T, Least, Most)), number(Least), number(Most) ), Areas),
    findall([T,Least,Most], ( member(T, Types), clause(grammar:whole_area(_,_,_), _), once(grammar:whole_area(T, Least, Most)), number(Least), number(Most) ), Wholes),
    ( clause(grammar:house_area(_,_), _), once(grammar:house_area(L, M)), number(L), number(M) -> Total = [L,M] ; Total = null ),
    findall([T,M], ( member(T, Types), once(turning_side(T, M)), number(M) ), Turning),
    ( stated_length(inner_wall, Inner), stated_length(outer_wall, Outer), number(Inner), number(Outer), Inner > 0 -> Walls = [Inner,Outer] ; Walls = null ),
    findall([T,U,M], ( clause(grammar:door_width(T,U,M), true), ground(T-U-M), number(M) ), Doors),
    as_json(_{lengths:Lengths, areas:Areas, wholes:Wholes, total:Total, turning:Turning, walls:Walls, doors:Doors}, Json).
