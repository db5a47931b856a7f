:- module(core, [grammar_problems/2, grammar_lengths/3, grammar_origins/2, grammar_sized/1, set_cell/1, placed/3, room_clash/4,
                 room_system/3]).

/** <module> Stage 2: from a layout to a house

The one goal that Python asks for a house is placed/3: terms in, JSON out.

    grammar.pl     the grammar's clauses and their extremes
    room.pl        a room's furniture, as a linear system; stretch.pl, island.pl: what stands at its walls, in its middle
    linear.pl      linear constraints as data: posted to CLP(R), or asked for what clashes
    furnish.pl     a random solution for a room, or why it has none
    main_room.pl   the rooms around the main room
    chain.pl       things in a row, at least a gap apart: furniture along a wall, rooms along a side
    draw.pl        random numbers
    plan.pl        from the rooms' frames to the house's plan
*/

:- use_module(library(apply)).
:- use_module(library(http/json)).
:- use_module(library(lists)).
:- use_module(grammar, except([room_system/4])).
:- use_module(lint).
:- use_module(main_room).
:- use_module(origins).
:- use_module(plan).
:- use_module(furnish).

%!  grammar_problems(+Files, -Json) is det.
%
%   Json lists [File,Line,Column,Text] of what is wrong with the grammar's files. They are read first, and loaded only
%   if there is nothing in them that must not be run.

grammar_problems(Files, Json) :-
    file_problems(Files, Read),
    ( Read == [] -> load_grammar(Files, Problems) ; Problems = Read ),
    findall([F,L,C,T], member(problem(F,L,C,T), Problems), List),
    as_json(List, Json).

%!  grammar_lengths(+Furniture, +Names, -Json) is det.
%
%   Furniture is a list of furniture(Type,Pieces). Json gives the named lengths, and for each type the extremes of
%   the room and of each of its pieces: a list of numbers, null where the grammar has no clause, or a text that
%   says why the clause is of no use.

grammar_lengths(Furniture, Names, Json) :-
    maplist(named, Names, Lengths),
    maplist(furnished_type, Furniture, Types),
    as_json(_{lengths:Lengths, types:Types}, Json),
    forall(member(furniture(Type,_), Furniture), ignore(catch(warm(Type), _, true))).

%   What SWI-Prolog loads at first use counts as inferences: an empty room spares the first house that.

warm(Type) :- placed(layout([room(0,Type,north,[],1)],[],1,quick), 1 000 000, _).

named(Name, [Name,Report]) :- length_report(Name, Report).

furnished_type(furniture(Type,Pieces), [Type,Room,Reports]) :-
    room_report(Type, Room),
    maplist(piece_of(Type), Pieces, Reports).

piece_of(Type, Piece, [Piece,Report]) :- piece_report(Type, Piece, Report).

%!  placed(+Layout, +Limit, -Json) is det.
%
%   Layout is layout(Rooms,Corners,Seed,Proof): Rooms are room(R,Type,Side,Atoms,Seed) in clockwise order. Json is the
%   plan, or {"refuted": [[R,Reasons]..]} for rooms that no sizes and places satisfy, each with a clash (least or
%   quick: see furnish.pl): lists of [holds,Atom], [fails,Atom] and [clause,Clause]; or {"limit": true} past so many
%   inferences.

placed(Layout, Limit, Json) :-
    statistics(inferences, Before),
    call_with_inference_limit(house(Layout, Answer), Limit, Result),
    statistics(inferences, After),
    Inferences is After - Before,
    ( Result == inference_limit_exceeded -> Reply = _{limit:true} ; Reply = Answer.put(inferences, Inferences) ),
    as_json(Reply, Json).

house(layout(Rooms,Corners,Seed,Proof), Answer) :-
    maplist(furnished_room(Proof), Rooms, Furnished, Clashes),
    append(Clashes, Refuted),
    retractall(kept(_,_)),
    (   Refuted == []
    ->  maplist(rigid, Furnished, Rigid),
        placed_around(Rigid, Corners, Furnished, Seed, Answer)
    ;   maplist(keep, Rooms, Furnished),
        Answer = _{refuted:Refuted} ).

%   kept(?Seed, ?Room): where some rooms of a house are refuted, the others wait for the next try.

:- dynamic kept/2.

keep(stays(_,_,_,_,_,_,_), _).
keep(room(_,_,_,_,Seed), _-Room) :- ( var(Room) -> true ; assertz(kept(Seed, Room)) ).

furnished_room(_, stays(_,Side,W,D,Door,Along,Wall), Side-kept(W,D,Door,stays(Along,Wall)), []) :- !.
furnished_room(_, room(_,_,Side,_,Seed), Side-Room, []) :- kept(Seed, Room), !.
furnished_room(Proof, room(R,Type,Side,Layout,Seed), Side-Room, Clashes) :-
    call(furnished(Type, Layout, Proof, Answer), Seed, _),
    (   Answer = clash(Reasons)
    ->  maplist(reason, Reasons, Told), Clashes = [[R,Told]]
    ;   Room = Answer, Clashes = [] ).

rigid(Side-room(_,W,D,Door,_,_,_), r(Side,W,D,Door,free)).
rigid(Side-kept(W,D,Door,Place), r(Side,W,D,Door,Place)).

%   Where rooms of another house stay, Answer has the corner of the main room too; or says that the rooms do not fit
%   between them, and if that is so whatever their sizes.

placed_around(Rigid, Corners, Furnished, Seed, Answer) :-
    memberchk(r(_,_,_,_,stays(_,_)), Rigid), !,
    (   call(around_kept(Rigid, Corners, Main, at(West,North), Starts), Seed, _)
    ->  plan(Main, Starts, Furnished, Plan),
        Answer = Plan.put(corner, [West,North])
    ;   maplist(narrowest, Rigid, Narrow),
        ( hopeless(Narrow, Corners) -> Hopeless = true ; Hopeless = false ),
        Answer = _{cramped:Hopeless} ).
placed_around(Rigid, Corners, Furnished, Seed, Answer) :-
    call(around(Rigid, Corners, Main, Starts), Seed, _),
    plan(Main, Starts, Furnished, Answer).

narrowest(r(Side,_,D,Door,free), r(Side,Least,D,Door,free)) :- !,
    findall(W, ( clause(grammar:room_size(Type,_,_), _), room_extent(Type, W, _, _, _) ), Ws),
    min_list(Ws, Least).
narrowest(Room, Room).

reason(not(Atom), [fails,Text])     :- !, term_string(Atom, Text).
reason(length(Name), [clause,Text]) :- !, term_string(length(Name), Text).
reason(Clause, [clause,Text])       :- functor(Clause, size, _), !, term_string(Clause, Text).
reason(Atom, [holds,Text])          :- term_string(Atom, Text).

%!  grammar_origins(+Clauses, -Json) is det.
%
%   Json lists [Clause,File,Line], see origins.pl.

grammar_origins(Clauses, Json) :-
    origins(Clauses, Origins),
    as_json(Origins, Json).

%!  grammar_sized(-Json) is det.
%
%   Json lists [Predicate,Name,File,Line] of the clauses that give sizes, see origins.pl.

grammar_sized(Json) :- sized(Clauses), as_json(Clauses, Json).

%!  room_clash(+Type, +Layout, +Without, -Json) is det.
%
%   Json is a least clash, as in placed/3, of a room with this furniture where the clauses Without are left out; or null
%   where there is none.

room_clash(Type, Layout, Without, Json) :-
    (   least_clash(Type, Layout, Without, Reasons)
    ->  maplist(reason, Reasons, Told)
    ;   Told = null ),
    as_json(Told, Json).

%!  room_system(+Type, +Layout, -Json) is det.
%
%   Json lists the rows of the linear system of one room (linear.pl), all sizes unknown.

room_system(Type, Layout, Json) :-
    linear_system(Type, Layout, Rows),
    as_json(Rows, Json).

as_json(Value, Text) :-
    with_output_to(string(Text), json_write_dict(current_output, Value, [width(0)])).
