:- module(core, [grammar_problems/2, grammar_lengths/3, placed/4]).

/** <module> Stage 2: from a layout to a house

The one goal that Python asks for a house is placed/4: terms in, JSON out.

    grammar.pl     the grammar's clauses and their extremes
    room.pl        a room's furniture, as linear constraints
    main_room.pl   the rooms around the main room
    draw.pl        a random solution of a solved store
    plan.pl        from the rooms' frames to the house's plan
*/

:- use_module(library(apply)).
:- use_module(library(http/json)).
:- use_module(library(lists)).
:- use_module(grammar).
:- use_module(main_room).
:- use_module(plan).
:- use_module(room).

%!  grammar_problems(+Files, -Json) is det.
%
%   Loads the grammar's files; Json lists [File,Line,Column,Text] of what is wrong with them.

grammar_problems(Files, Json) :-
    load_grammar(Files, Problems),
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

warm(Type) :-
    length(Zeros, 100), maplist(=(0.0), Zeros),
    placed(layout([room(0,Type,north,[])],[]), Zeros, 1 000 000, _).

named(Name, [Name,Report]) :- length_report(Name, Report).

furnished_type(furniture(Type,Pieces), [Type,Room,Reports]) :-
    room_report(Type, Room),
    maplist(piece_of(Type), Pieces, Reports).

piece_of(Type, Piece, [Piece,Report]) :- piece_report(Type, Piece, Report).

%!  placed(+Layout, +Uniforms, +Limit, -Json) is det.
%
%   Layout is layout(Rooms,Corners): Rooms are room(R,Type,Side,Atoms) in clockwise order. Json is the plan,
%   or {"refuted": [R..]} where no sizes and places satisfy the rules for those rooms, or {"limit": true}
%   past so many inferences.

placed(layout(Rooms,Corners), Uniforms, Limit, Json) :-
    statistics(inferences, Before),
    call_with_inference_limit(house(Rooms, Corners, Uniforms, Answer), Limit, Result),
    statistics(inferences, After),
    Inferences is After - Before,
    ( Result == inference_limit_exceeded -> Reply = _{limit:true} ; Reply = Answer.put(inferences, Inferences) ),
    as_json(Reply, Json).

house(Rooms, Corners, Uniforms, Answer) :-
    maplist(posted, Rooms, Sided, Refuted),
    append(Refuted, Refutations),
    (   Refutations == []
    ->  drawn(Sided, Corners, Answer, Uniforms, _)
    ;   Answer = _{refuted:Refutations} ).

posted(room(_,Type,Side,Layout), Side-Room, []) :- furnished(Type, Layout, Room), !.
posted(room(R,_,Side,_), Side-none, [R]).

drawn(Sided, Corners, Plan) -->
    draw_rooms(Sided),
    { maplist([Side-room(_,W,D,Door,_,_,_), r(Side,W,D,Door)]>>true, Sided, Rigid),
      once(around(Rigid, Corners, Main, Chains)) },
    draw_main_room(Rigid, Main, Chains),
    { plan(Main, Chains, Sided, Plan) }.

draw_rooms([])               --> [].
draw_rooms([_-Room|Rooms])   --> draw_room(Room), draw_rooms(Rooms).

as_json(Value, Text) :-
    with_output_to(string(Text), json_write_dict(current_output, Value, [width(0)])).
