:- module(core, [grammar_problems/4, grammar_problems/5, grammar_typical/1, grammar_lengths/3, grammar_origins/2, grammar_sized/1, placed/3,
                 room_conflict/4, room_system/3, room_pieces/4, room_lengths/7,
                 main_lengths/4, layout_area_conflict/5, solver_version/1]).

/** <module> Stage 2: from a layout to a house

The one goal that Python asks for a house is placed/3: terms in, JSON out.

    language/          what a grammar's .pl files state
        written.pl         as they are written: read once, as terms
        lint.pl            what must not be in them; braces.pl: in constraints
        grammar_files.pl   the same terms, stated as clauses
        origins.pl         where their clauses stand
        lengths.pl         the grammar's lengths, and the extremes of its sizes
        reports.pl         whether they can be used
        faults.pl          why not, in the words of their author: paths.pl: a clause step by step; nonlinear.pl
        laws.pl, sizes.pl  how two sizes depend on each other: to be sampled; as linear constraints
        promises.pl        what houses promise of the lengths, as the grammar writes them
    linear/            constraints and random numbers
        grid.pl            metres, or cells of a grid
        sample.pl          random numbers
        linear.pl          linear constraints as data: posted to CLP(R), or searched for a conflict
        exact.pl           what CLP(R) refutes, confirmed in rational arithmetic
        chain.pl           things in a row, at least a gap apart: furniture along a wall, rooms along a side
        regions.pl         sizes of some area, as linear constraints
    room/              a room's furniture
        records.pl         what a room consists of; record_access.pl: its fields, compiled to unifications
        reasons.pl         why a constraint binds
        room.pl            as a linear system
        links.pl           what stands along a wall; stretch.pl: as a chain; island.pl: what stands in the middle
        shape.pl           the stretches of wall that a room's doors leave
        filled.pl          how long a wall can be that furniture fills
        furnish.pl         a random solution for a room, or why it has none
        solution.pl        the same where every size is unknown
        given_rooms.pl     the same where sizes and doors are given
        plan.pl            from the rooms' frames to the house's plan
    star/main_room.pl  the rooms around the main room
    star/fixed_rooms.pl    the same where some stay where they are
    star/star_areas.pl     the area of the whole house
    shared_walls/      plans where rooms share walls
        plans.pl           what Python asks for them
        walls.pl           where the walls are; areas.pl, totals.pl; openings.pl: doors and windows in them; contacts.pl
        lines.pl           a random solution of them
        own_plan.pl        doors and windows in rooms that a user gives; moved.pl: the least change of these
    brief/             briefs, and all sizes that areas allow
        brief.pl           lengths and areas as constraints, and a search for a solution; thorough.pl: the same at their limits
    why/bounds.pl      why a solution is as it is: what else it could be, and which constraints bind
    why/plan_bounds.pl the same of walls that rooms share
    agreement.pl       whether all lengths together can be used
    answers.pl         answers as JSON
*/

% Arithmetic is compiled in all that core.pl loads, CLP(R) too, and not in a grammar's files: the flag ends with the file.
:- set_prolog_flag(optimise, true).

:- use_module(library(apply)).
:- use_module(library(lists)).
:- reexport(agreement).
:- use_module(answers).
:- use_module(why/bounds).
:- use_module(linear/exact).
:- use_module(language/faults).
:- use_module(room/furnish).
:- use_module(language/grammar_files).
:- use_module(linear/grid).
:- use_module(language/lengths).
:- reexport(room/given_rooms).
:- use_module(star/fixed_rooms).
:- use_module(star/main_room).
:- use_module(star/star_areas).
:- reexport(shared_walls/totals, [house_areas/2]).
:- use_module(shared_walls/areas).
:- use_module(shared_walls/totals, [total_area/1]).
:- use_module(language/origins).
:- use_module(room/plan).
:- reexport(language/promises).
:- reexport(shared_walls/moved).
:- reexport(shared_walls/own_plan).
:- reexport(shared_walls/plans).
:- reexport(why/plan_bounds).
:- use_module(room/record_access).
:- use_module(room/records).
:- use_module(language/reports).
:- use_module(room/solution).

%!  grammar_problems(+Files, +Walls, +Cell, -Json) is det.
%
%   Json lists [File,Line,Column,Text,Name] for what is wrong with the grammar's files; Name is that of a predicate that is
%   not known, or "". Files are as in written.pl. Where nothing is wrong they are loaded, for houses on a grid of
%   such cells (m) if not 0.0. The last lies at the top of the grammar's folder. Walls are shared or apart, as the grammar's topology has them.
%   Of a grammar loaded before nothing is left.

grammar_problems(Files, Walls, Cell, Json) :- grammar_problems(Files, [], Walls, Cell, Json).

%!  grammar_problems(+Files, +LeftOut, +Walls, +Cell, -Json) is det.
%
%   The same without typical clauses that are LeftOut: see load_grammar/3.

grammar_problems(Files, LeftOut, Walls, Cell, Json) :-
    nb_setval(grammar_walls, Walls),
    nb_setval(grammar_files, Files),
    load_grammar(Files, LeftOut, Problems),
    set_cell(Cell),
    findall([F,L,C,T,N], member(problem(F,L,C,T,N), Problems), List),
    as_json(List, Json).

%!  grammar_typical(-Json) is det.
%
%   Json lists [File,Line] of the clauses that give way to what is stated of rooms.

grammar_typical(Json) :-
    typical_places(Places),
    findall([File,Line], member(File-Line, Places), List),
    as_json(List, Json).

%!  grammar_lengths(+Furniture, +Names, -Json) is det.
%
%   Furniture is a list of furniture(Type,Pieces), with piece(Type,Turns): whether it may stand turned. Json gives the named lengths, with the window's margin if it is stated and rooms share walls, [Type,Metres] of free squares, and for each type the extremes of
%   the room and of each of its pieces: a list of numbers; null where the grammar has no clause; or
%   {"wrong": [File,Line,Column,Text]} where the clause cannot be used.

grammar_lengths(Furniture, Names, Json) :-
    maplist(name_report, Names, Named),
    findall([window_margin,M], ( nb_getval(grammar_walls, shared), clause(grammar:window_margin(_), _), stated_length(window_margin, M), number(M) ), Margin),
    append(Named, Margin, Lengths),
    maplist(type_report, Furniture, Types),
    findall([T,M], ( member(furniture(T,_), Furniture), catch(once(turning_side(T, M)), _, fail), number(M) ), Turning),
    as_json(_{lengths:Lengths, types:Types, turning:Turning}, Json),
    forall(( member([Type,Room,_], Types), is_list(Room) ), ignore(catch(warm_up(Type), _, true))).

%   What SWI-Prolog loads at first use counts as inferences: an empty room keeps them out of the first house's.

warm_up(Type) :- placed(layout([room(0,Type,north,[],1)],[],1,quick), 1 000 000, _).

name_report(Name, [Name,Record]) :- length_report(Name, Report), report_record(Report, Record).

%   Of the pieces in a room that is wrong itself nothing is said.

type_report(furniture(Type,Pieces), [Type,Room,Records]) :-
    ended(room_report(Type, Report), Report), report_record(Report, Room),
    ( is_list(Report) -> maplist(type_piece_report(Type), Pieces, Records) ; Records = [] ).

type_piece_report(Type, piece(Piece,Turns), [Piece,Record]) :-
    ended(piece_report(Type, Piece, Turns, Report), Report),
    report_record(Report, Record).

%   ended(:Goal, -Report): Goal, or the report of a clause that does not end for it, see sized/1.

ended(Goal, Report) :- catch(Goal, endless(Head), endless_report(Head, Report)).

endless_report(Head, Report) :-
    Head =.. [Name,Type|Given], same_length(Given, Any), Call =.. [Name,Type|Any],
    fault_report(endless, []-Call, Report).

report_record(wrong(File,Line,Column,Text), _{wrong:[File,Line,Column,Text]}) :- !.
report_record(Report, Report).

%!  placed(+Layout, +Limit, -Json) is det.
%
%   Layout is layout(Rooms,Corners,Seed,Proof): Rooms are, in clockwise order, room(R,Type,Side,Atoms,Seed) or
%   fixed(R,Side,size(Width,Depth,Door),at(Along,Wall)), see main_room.pl. Json is one of these, with "inferences":
%
%       {"floor":.., "rooms":..}            the plan, with "corner" where rooms are fixed, and "sizes", [R,Width,Depth] of rooms
%                                           that were furnished once more for the area of the house
%       {"infeasible": [[R,Reasons]..]}     no sizes and places satisfy these rooms. Reasons are those of a conflict
%                                           (minimal or quick, as Proof is): [holds,Atom], [fails,Atom], [clause,Clause]
%       {"misfit": Any}                     the rooms do not fit between the fixed ones, Any: nor with any other sizes; or leave
%                                           the main room no area
%       {"limit": true}                     that takes more inferences than Limit
%       {"wrong": [File,Line,Column,Text]}  a clause of the grammar's does not end for these rooms

placed(Layout, Limit, Json) :-
    answer_within(Limit, ended(house_answer(Layout, Answer), Answer), Answer, report_record, Json).

house_answer(layout(Rooms,Corners,Seed,Proof), Answer) :-
    maplist(finished_room(Proof), Rooms, Finished, Conflicts),
    append(Conflicts, Infeasible),
    retractall(finished(_,_)),
    (   Infeasible == []
    ->  rooms_in_area(Rooms, Corners, Finished, Resized, Sizes),
        maplist(outline, Resized, Outlines),
        placed_around(Outlines, Corners, Seed, Resized, Placed),
        maplist(size_record, Sizes, Records),
        Answer = Placed.put(sizes, Records)
    ;   maplist(store_finished, Rooms, Finished),
        Answer = _{infeasible:Infeasible} ).

%   finished(?Seed, ?Room): where some rooms of a house are infeasible, the others wait for the next try.

:- dynamic finished/2.

store_finished(fixed(_,_,_,_), _).
store_finished(room(_,_,_,_,Seed), _-Room) :- ( var(Room) -> true ; assertz(finished(Seed, Room)) ).

%   finished_room(+Proof, +Room, -Finished, -Conflicts): Finished is Side-Room, and Conflicts is empty or [[R,Reasons]].

finished_room(_, fixed(_,Side,Size,Place), Side-fixed(Size,Place), []) :- !.
finished_room(_, room(_,_,Side,_,Seed), Side-Room, []) :- finished(Seed, Room), !.
finished_room(Proof, room(R,Type,Side,Layout,Seed), Side-Room, Conflicts) :-
    call(furnished(Type, Layout, Proof, Answer), Seed, _),
    (   Answer = infeasible(Why)
    ->  maplist(reason_record, Why, Reasons), Conflicts = [[R,Reasons]]
    ;   Room = Answer, Conflicts = [] ).

size_record(R-size(W0,D0), [R,W,D]) :- maplist(metres, [W0,D0], [W,D]).

placed_around(Outlines, Corners, Seed, Finished, Answer) :-
    memberchk(outline(_,_,_,_,fixed(_,_)), Outlines), !,
    (   call(main_room_between(Outlines, Corners, Main, at(West,North), Starts), Seed, _)
    ->  house_plan(Main, Starts, Finished, Plan),
        Answer = Plan.put(corner, [West,North])
    ;   maplist(narrowest, Outlines, Narrow),
        ( infeasible_between(Narrow, Corners) -> Any = true ; Any = false ),
        Answer = _{misfit:Any} ).
placed_around(Outlines, Corners, Seed, Finished, Answer) :-
    call(main_room_around(Outlines, Corners, Main, Starts), Seed, _), !,
    house_plan(Main, Starts, Finished, Answer).
placed_around(_, _, _, _, _{misfit:false}) :- total_area(_).

narrowest(outline(Side,_,D,Door,free), outline(Side,Least,D,Door,free)) :- !,
    findall(W, ( clause(grammar:room_size(Type,_,_), _), room_extent(Type, W-_, _) ), Ws),
    min_list(Ws, Least).
narrowest(Fixed, Fixed).

%!  layout_area_conflict(+Rooms, +Corners, +Types, +Without, -Json) is det.
%
%   Json lists the reasons, as in placed/3, why no such rooms make a house of the area that the grammar states, see area_conflict/5, with
%   fixed(I,R,Side,Width,Depth) in metres; or is null where they may.

layout_area_conflict(Rooms, Corners, Types, Without, Json) :-
    maplist(in_house_unit, Rooms, Measured),
    (   area_conflict(Measured, Corners, Types, Without, Why)
    ->  maplist(reason_record, Why, Reasons)
    ;   Reasons = null ),
    as_json(Reasons, Json).

in_house_unit(fixed(I,R,Side,W0,D0), fixed(I,R,Side,W,D)) :- !, maplist(rounded_up, [W0,D0], [W,D]).
in_house_unit(Room, Room).

%!  grammar_origins(+Clauses, -Json) is det.
%
%   Json lists [Clause,File,Line], see origins.pl.

grammar_origins(Clauses, Json) :-
    clause_origins(Clauses, Origins),
    as_json(Origins, Json).

%!  grammar_sized(-Json) is det.
%
%   Json lists [Predicate,Name,File,Line,Column] of the clauses that give sizes, see origins.pl.

grammar_sized(Json) :- size_clauses(Clauses), as_json(Clauses, Json).

%!  room_conflict(+Type, +Layout, +Without, -Json) is det.
%
%   Json lists the reasons, as in placed/3, of a minimal conflict of a room with this furniture where the clauses Without are
%   left out; or is null where there is none.

room_conflict(Type, Layout, Without, Json) :-
    (   conflict_without(Type, Layout, Without, Why)
    ->  maplist(reason_record, Why, Reasons)
    ;   Reasons = null ),
    as_json(Reasons, Json).

%!  room_system(+Type, +Layout, -Json) is det.
%
%   Json is the linear system of one room, all sizes unknown, and whether it has a solution: see solver_verdicts/2.

room_system(Type, Layout, Json) :-
    whole_system(Type, Layout, _, System),
    solver_verdicts(System, Record),
    as_json(Record, Json).

%!  room_pieces(+Type, +Layout, +Given, -Json) is det.
%
%   Json lists [Type,Atom] of the pieces and companions in a room with this furniture, in the order of a house file.

room_pieces(Type, Layout, Given, Json) :-
    given_shape(Given, Shape),
    room_parts(Type, Layout, Shape, Parts),
    findall([F,Text], ( member(F-Atom, Parts), term_string(Atom, Text) ), Pieces),
    as_json(Pieces, Json).

%!  room_lengths(+Type, +Layout, +Given, +Taken, +Seed, +Target, -Json) is det.
%
%   Json is what room_bounds/8 says of a Target in the room of this Seed: bounds_json/3. Given is `any`, or what is given of
%   the room, see given_shape/2. Taken is the area of all other rooms of a star, in square metres, or `any`.

room_lengths(Type, Layout, Given, Taken, Seed, Target, Json) :-
    given_shape(Given, Shape),
    (   number(Taken), total_area(Least-Most)
    ->  square(Taken, Others), Low is Least - Others, High is Most - Others, Left = Low-High
    ;   Left = any ),
    room_bounds(Type, Layout, Shape, Left, Seed, Target, Lengths, Binding),
    bounds_json(Lengths, Binding, Json).

%!  main_lengths(+Outlines, +Corners, +Width, -Json) is det.
%
%   Json is what main_room_ranges/7 says of rooms outline(Side,Width,Depth,Door), all in metres: "walls", "width",
%   "height", and "law", the file and line of the clause that states it; "any", both where the house had any area.

main_lengths(Outlines, Corners, Width, Json) :-
    maplist(free_outline, Outlines, Rooms),
    rounded_up(Width, W),
    main_room_ranges(Rooms, Corners, W, left, Walls, Widths, Heights),
    main_room_ranges(Rooms, Corners, W, any, _, AnyWidths, AnyHeights),
    maplist(metre_range, [Widths,Heights,AnyWidths,AnyHeights], [Width0,Height0,AnyWidth,AnyHeight]),
    maplist(metres, Walls, [North,East,South,West]),
    predicate_property(main_room:width_range(_,_,_), file(File)),
    predicate_property(main_room:width_range(_,_,_), line_count(Line)),
    as_json(_{walls:_{north:North,east:East,south:South,west:West}, width:Width0, height:Height0,
              any:_{width:AnyWidth, height:AnyHeight}, law:[File,Line]}, Json).

metre_range(Range, [Low,High]) :- inner_range(Range, L-H), maplist(metres, [L,H], [Low,High]).

free_outline(outline(Side,W0,D0,Door0), outline(Side,W,D,Door,free)) :- maplist(rounded_up, [W0,D0,Door0], [W,D,Door]).

%!  solver_version(-Json) is det.
%
%   Json is SWI-Prolog's version as a number, 90004 for 9.0.4.

solver_version(Json) :- current_prolog_flag(version, Version), as_json(Version, Json).
