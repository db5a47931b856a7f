:- module(agreement, [grammar_disagreements/4]).

/** <module> Whether a grammar's lengths agree with each other, as far as that is known before a house is made

reports.pl judges the lengths that every grammar states. Here are those that only some state, and what two clauses say together:
then the text names both.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(answers).
:- use_module(shared_walls/areas).
:- use_module(language/faults).
:- use_module(language/grammar_files).
:- use_module(language/lengths).
:- use_module(linear/regions).
:- use_module(language/reports).
:- use_module(star/star_areas).
:- use_module(language/sizes).
:- use_module(shared_walls/totals).

%!  grammar_disagreements(+Topology, +Types, +Openings, -Json) is det.
%
%   Json lists [File,Line,Column,Text]. Topology is topology(Walls,Units,Rooms): shared or apart, true where houses have units, and how many
%   rooms they have at most.
%   Types are room(Type,Lit), Lit is true where such rooms have windows; each has a size. Openings are opening(Type,Other),
%   and part(Type,Whole).

grammar_disagreements(Topology, Types, Openings, Json) :-
    findall([File,Line,Column,Text],
            ( disagreement(Topology, Types, wrong(File,Line,Column,Text))
            ; Topology = topology(shared,_,_), opening_wrong(Types, Openings, wrong(File,Line,Column,Text))
            ; Topology = topology(shared,Units,_), whole_wrong(Units, Types, Openings, wrong(File,Line,Column,Text)) ),
            Found),
    as_json(Found, Json).

disagreement(topology(Walls,_,_), Types, Wrong) :- narrow_walls(Walls, Types, Wrong).
disagreement(topology(Walls,Units,Most), Types, Wrong) :- stated(house_area(_,_)), total_wrong(Walls-Units, Most, Types, Wrong).
disagreement(_, Types, Wrong) :- idle_piece(Types, Wrong).
disagreement(_, Types, Wrong) :- member(room(Type,_), Types), stated_for(turning(Type,_)), turning_wrong(Type, Wrong).
disagreement(topology(shared,Units,_), Types, Wrong) :-
    (   member(Name, [door_margin,window_margin]), length_report(Name, Wrong), Wrong = wrong(_,_,_,_)
    ;   stated_length(room_gap, Gap), number(Gap), Gap > 0,
        clash(room_gap(_), "rooms share walls in this topology: state room_gap(0.0)", [], Wrong)
    ;   member(room(Type,_), Types), stated_for(room_area(Type,_,_)), area_wrong(Type, Wrong)
    ;   member(room(Type,Lit), Types), window_wrong(Type, Lit, Wrong)
    ;   stated(house_size(_,_)), house_wrong(Types, Wrong)
    ;   stated(unit_depth(_)), unit_wrong(Units, Types, Wrong)
    ;   stated(door_width(_,_,_)), once(pair_wrong(Units, Types, Wrong))
    ;   stated(wall_thickness(_,_)), once(thickness_wrong(Types, Wrong)) ).

stated(Head) :- \+ \+ clause(grammar:Head, _).

%   narrow_walls(+Walls, +Types, -Wrong): a door takes more of a wall than some rooms have. Around a main room it stands in the
%   width of its room.

narrow_walls(Walls, Types, Wrong) :-
    stated_length(door_width, Width), stated_length(door_margin, Margin), number(Width), number(Margin), Width < 1 000 000 000, Margin < 1 000 000 000, Door is Width + 2*Margin,
    findall(Long-Type, ( member(room(Type,_), Types), longest_wall(Walls, Type, Long), Long < Door - 1.0e-9 ), Found),
    sort(Found, [Long-Type|Others]),
    ( Margin > 0 -> Margins = [" with ",clause(door_margin(_))] ; Margins = ["",""] ),
    ( Walls == apart -> Where = "the width" ; Where = "a wall" ),
    (   Others == [], Types = [_,_|_]
    ->  append([metres(Door),Where,clause(door_width(_))|Margins], [metres(Long)], Said),
        clash(room_size(Type,_,_), "a door needs ~w m of ~w by ~w~w~w, but this allows at most ~w m", Said, Wrong)
    ;   append([metres(Door),Where|Margins], [clause(room_size(Type,_,_)),metres(Long)], Said),
        clash(door_width(_), "a door needs ~w m of ~w~w~w, but ~w allows at most ~w m", Said, Wrong) ).

%   idle_piece(+Types, -Wrong): of several clauses for a piece, one holds at no wall of any room.

idle_piece(Types, Wrong) :-
    findall(Short-Long, ( member(room(Type,_), Types), shortest_wall(Type, Short), longest_wall(shared, Type, Long) ), Walls),
    pairs_keys_values(Walls, Shorts, Longs), min_list(Shorts, Least), max_list(Longs, Most),
    findall(Piece, ( clause(grammar:piece_size(Piece,_,_,_), _), atom(Piece) ), Named), sort(Named, Pieces),
    member(Piece, Pieces),
    Head = piece_size(Piece,_,_,Wall),
    findall(Head-Body, clause(grammar:Head, Body), Clauses), Clauses = [_,_|_],
    nth0(Number, Clauses, Head-Body),
    \+ ( member(Short-Long, Walls), \+ \+ may_hold(Body, Wall, Short, Long) ),
    clash_at(Number, piece_size(Piece,_,_,_), "no wall satisfies this clause: walls of rooms are ~w to ~w m long"-[metres(Least),metres(Most)], Wrong).

%   may_hold(+Body, ?Wall, +Short, +Long): or it is at fault in another way.

may_hold(Body, Wall, Short, Long) :-
    {Wall >= Short, Wall =< Long},
    catch(call_with_inference_limit(once(grammar:Body), 300 000, _), error(_,_), true).

longest_wall(apart,  Type, Long) :- room_range(Type, _-Long, _).
longest_wall(shared, Type, Long) :- room_range(Type, _-W, _-D), Long is max(W, D).

shortest_wall(Type, Short) :- room_range(Type, W-_, D-_), Short is min(W, D).

% - areas -------------------------------------------------------------------------------------------------------

area_wrong(Type, Wrong) :-
    Head = room_area(Type,Least,Most),
    judged(areas_found(Head, Least, Most, Found), Found, []-room_area(Type,_,_), Report),
    (   Report = L-M
    ->  sized(room_size(Type, W0, D0)), size_system([W,D], [W0,D0], size(Type), System), corners(System, W, D, Corners),
        least_and_greatest_area(Corners, Low-_, High-_),
        (   L > High + 1.0e-9
        ->  clash(room_area(Type,_,_), "~w m2 at least, but ~w allows at most ~w m2", [metres(L),clause(room_size(Type,_,_)),metres(High)], Wrong)
        ;   M < Low - 1.0e-9,
            clash(room_area(Type,_,_), "~w m2 at most, but ~w allows at least ~w m2", [metres(M),clause(room_size(Type,_,_)),metres(Low)], Wrong) )
    ;   Wrong = Report ).

areas_found(Head, Least, Most, Found) :-
    findnsols(2, Least-Most, grammar:Head, Stated), !,
    (   Stated = [] -> Found = fault(empty)
    ;   Stated = [_,_] -> Found = fault(several)
    ;   Stated = [L-M], number(L), number(M), L >= 0, M > 0, L =< M
    ->  ( M < 1 000 000 000 -> Found = L-M ; Found = fault(too_large) )
    ;   Found = fault(no_areas) ).

% - windows -----------------------------------------------------------------------------------------------------

%   window_wrong(+Type, +Lit, -Wrong): of a type without windows, where a clause names it.

window_wrong(Type, Lit, Wrong) :-
    stated_length(window_margin, Margin), number(Margin),
    longest_wall(shared, Type, Long), shortest_wall(Type, Short),
    Left is Long - 2*Margin,
    (   Lit == true, Left < 1.0e-6
    ->  clash(window_margin(_), "no window fits with this margin on both sides in ~w, whose walls are at most ~w m", [clause(room_size(Type,_,_)),metres(Long)], Wrong)
    ;   stated_for(window_size(Type,_,_)), ( Lit == true -> true ; named(window_size(Type,_,_)) ),
        format(string(Above), "~~w >= ~3g (in ~w)", [Short,Type]), format(string(Below), "~~w =< ~3g (in ~w)", [Long,Type]),
        Given = [(Wall >= Short)-said(Above,[3]),(Wall =< Long)-said(Below,[3])],
        judged(window_found(Type, Short-Long, Found), Found, Given-window_size(Type,_,Wall), Report),
        (   Report = wrong(_,_,_,_)
        ->  Wrong = Report
        ;   \+ window_fits(Type, Margin, Long),
            clash(window_size(Type,_,_), "with ~w on both sides no such window fits in ~w, whose walls are at most ~w m",
                  [clause(window_margin(_)),clause(room_size(Type,_,_)),metres(Long)], Wrong) ) ).

named(Head) :-
    arg(1, Head, Type), functor(Head, Name, Arity), functor(Any, Name, Arity),
    clause(grammar:Any, _), arg(1, Any, Named), Named == Type, !.

window_found(Type, Short-Long, Found) :-
    { Wall >= Short, Wall =< Long },
    sizes_found(window_size(Type,Length,Wall), [Length], [Wall], Found).

window_fits(Type, Margin, Long) :- \+ \+ ( grammar:window_size(Type, Length, Wall), {Wall =< Long, Length + 2*Margin =< Wall} ).

% - doors by the types of both ends ---------------------------------------------------------------------------------

%   pair_wrong(+Units, +Types, -Wrong): of a type that there is not, no width, stated twice, or wider than the walls of such rooms.

pair_wrong(true, _, Wrong) :- clash(door_width(_,_,_), "all doors of units have one width: state only door_width/1", [], Wrong).
pair_wrong(false, Types, Wrong) :-
    findall(A/B/W, ( clause(grammar:door_width(A,B,W0), Body), ( Body == true -> W = W0 ; W = none ) ), Pairs),
    nth0(Number, Pairs, A/B/W),
    (   member(End, [A,B]), \+ ( End == outside ; member(room(Type,_), Types), Type == End )
    ->  ( var(End) -> Said = "give the names of two room types"-[] ; Said = "no room has the type ~w"-[End] )
    ;   A-B == outside-outside
    ->  Said = "a door needs a room on one side"-[]
    ;   \+ ( number(W), W > 0 )
    ->  Said = "must be a number of metres more than 0"-[]
    ;   nth0(Other, Pairs, C/D/_), Other < Number, memberchk(C-D, [A-B,B-A])
    ->  Said = "these doors already have a width: keep one"-[]
    ;   stated_length(door_margin, Margin), number(Margin), Door is W + 2*Margin,
        member(End, [A,B]), End \== outside, longest_wall(shared, End, Long), Long < Door - 1.0e-9,
        Said = "such a door needs ~w m of a wall with its margins, but ~w allows at most ~w m"-[metres(Door),clause(room_size(End,_,_)),metres(Long)] ), !,
    clash_at(Number, door_width(_,_,_), Said, Wrong).

% - walls -------------------------------------------------------------------------------------------------------

%   thickness_wrong(+Types, -Wrong): of no walls that there are, no thickness, an outer one less than an inner one, or more than a room.

thickness_wrong(_, Wrong) :-
    findall(Kind, clause(grammar:wall_thickness(Kind,_), _), Kinds),
    nth0(Number, Kinds, Kind), \+ ( member(Known, [inner,outer]), Kind == Known ),
    clash_at(Number, wall_thickness(_,_), "write inner or outer, not ~w"-[Kind], Wrong).
thickness_wrong(_, Wrong) :-
    member(Kind, [inner,outer]),
    judged(thickness_found(Kind, Found), Found, []-wall_thickness(Kind,_), Wrong), Wrong = wrong(_,_,_,_).
thickness_wrong(_, Wrong) :-
    \+ stated(wall_thickness(inner,_)),
    clash(wall_thickness(outer,_), "inner walls have no thickness: also state wall_thickness(inner, 0.1)", [], Wrong).
thickness_wrong(_, Wrong) :-
    maplist(stated_length, [inner_wall,outer_wall], [Inner,Outer]), ( Outer < Inner ; Inner =:= 0, Outer > 0 ),
    clash(wall_thickness(outer,_), "outer walls must be at least as thick as inner walls (~w: ~w m), and inner walls must have a thickness if outer walls do",
          [clause(wall_thickness(inner,_)),metres(Inner)], Wrong).
thickness_wrong(Types, Wrong) :-
    member(Kind-Name, [inner-inner_wall,outer-outer_wall]), stated(wall_thickness(Kind,_)), stated_length(Name, Thick),
    smallest(Types, Least), shortest_wall(Least, Short), Thick > Short,
    clash(wall_thickness(Kind,_), "a wall may not be thicker than a room: ~w allows rooms of ~w m", [clause(room_size(Least,_,_)),metres(Short)], Wrong).

thickness_found(Kind, Found) :-
    findnsols(2, M, grammar:wall_thickness(Kind, M), Stated), !,
    (   Stated = [] -> Found = fault(empty)
    ;   Stated = [_,_] -> Found = fault(several)
    ;   Stated = [M], number(M), M >= 0
    ->  ( M < 1 000 000 000 -> Found = M ; Found = fault(too_large) )
    ;   Found = fault(not_metres) ).

% - a free square -----------------------------------------------------------------------------------------------

turning_wrong(Type, Wrong) :-
    judged(turning_found(Type, Found), Found, []-turning(Type,_), Report),
    (   number(Report)
    ->  room_range(Type, _-W, _-D), Most is min(W, D), Report > Most + 1.0e-9,
        clash(turning(Type,_), "no such room is large enough: ~w allows at most ~w m in one direction", [clause(room_size(Type,_,_)),metres(Most)], Wrong)
    ;   Wrong = Report ).

turning_found(Type, Found) :-
    findnsols(2, M, grammar:turning(Type, M), Stated), !,
    (   Stated = [] -> Found = fault(empty)
    ;   Stated = [_,_] -> Found = fault(several)
    ;   Stated = [M], number(M), M >= 0
    ->  ( M < 1 000 000 000 -> Found = M ; Found = fault(too_large) )
    ;   Found = fault(not_metres) ).

% - rooms of several parts -----------------------------------------------------------------------------------------

%   whole_wrong(+Units, +Types, +Openings, -Wrong): an area of rooms that have no parts, or that one of them has by itself already.

whole_wrong(Units, Types, Openings, Wrong) :-
    member(room(Type,_), Types), stated_for(whole_area(Type,_,_)),
    Head = whole_area(Type,Least,Most), Said = whole_area(Type,_,_),
    judged(areas_found(Head, Least, Most, Found), Found, []-Said, Report),
    (   Report = wrong(_,_,_,_)
    ->  Wrong = Report
    ;   Units == true
    ->  clash(Said, "houses of units have no areas of rooms with their parts: state room_area/3 of each room", [], Wrong)
    ;   \+ memberchk(part(_,Type), Openings)
    ->  clash(Said, "no room is a part of a room of type ~w: state which is by part/2 in a .lp file, or state room_area/3", [Type], Wrong)
    ;   Report = _-M, type_ranges(Type, ranges(_,_,Low-_)), square_metres(Low, Alone), M < Alone - 1.0e-9,
        ( grammar:room_area(Type, _, _) -> Clause = room_area(Type,_,_) ; Clause = room_size(Type,_,_) ),
        clash(Said, "~w m2 at most, but ~w allows at least ~w m2 without a part", [metres(M),clause(Clause),metres(Alone)], Wrong) ).

% - openings ----------------------------------------------------------------------------------------------------

%   opening_wrong(+Types, +Openings, -Wrong): a clause that is for no opening, or that leaves long walls without one.

opening_wrong(_, Openings, Wrong) :-
    findall(A-B, ( clause(grammar:opening_size(A,B,_,_), _), atom(A), atom(B) ), Pairs), sort(Pairs, Stated),
    member(A-B, Stated),
    \+ ( member(opening(T,U), Openings), memberchk(A-B, [T-U,U-T]) ),
    clash(opening_size(A,B,_,_), "no opening joins such rooms: state opening(~w,~w) in a .lp file", [A,B], Wrong).
opening_wrong(Types, Openings, Wrong) :-
    member(opening(T,U), Openings), memberchk(room(T,_), Types), memberchk(room(U,_), Types),
    \+ \+ clause(grammar:opening_size(_,_,_,_), _),
    stated_length(door_width, Width), number(Width),
    longest_wall(shared, T, LongT), longest_wall(shared, U, LongU), Long is min(LongT, LongU), Long >= Width,
    once(( member(A-B, [T-U,U-T]), \+ \+ clause(grammar:opening_size(A,B,_,_), _) )),
    Head = opening_size(A,B,L,Wall),
    format(string(Above), "~~w >= ~3g (a door)", [Width]), format(string(Below), "~~w =< ~3g (the longest wall that these rooms share)", [Long]),
    Given = [(Wall >= Width)-said(Above,[4]),(Wall =< Long)-said(Below,[4]),(L =< Wall)-said("~w =< Wall",[3])],
    copy_term(Head, Tried),  % What is posted about it is Given, where it is to be explained.
    judged(opening_found(Tried, Width-Long, Found), Found, Given-Head, Report),
    (   Report = wrong(_,_,_,_)
    ->  Wrong = Report
    ;   \+ \+ ( grammar:Head, {Wall = Long, L >= Width, L =< Wall} )
    ->  fail
    ;   clash(Head, "such rooms may share a wall of ~w m, but no opening in it is as wide as ~w",
              [metres(Long),clause(door_width(_))], Wrong) ).

opening_found(opening_size(A,B,L,Wall), Short-Long, Found) :-
    { Wall >= Short, Wall =< Long, L =< Wall },
    sizes_found(opening_size(A,B,L,Wall), [L], [Wall], Found).

% - the house, and its units --------------------------------------------------------------------------------------

house_wrong(Types, Wrong) :-
    Given = [(W > 0)-said("~w > 0",[1]),(D > 0)-said("~w > 0",[2])],
    judged(house_found(Found), Found, Given-house_size(W,D), Report),
    (   Report = wrong(_,_,_,_)
    ->  Wrong = Report
    ;   \+ ( member(room(Type,_), Types), in_house(Type) ),
        smallest(Types, Least),
        clash(house_size(_,_), "no room fits in a house of this size, not even ~w", [clause(room_size(Least,_,_))], Wrong) ).

house_found(Found) :-
    { W > 0, D > 0 },
    (   \+ grammar:house_size(W, D) -> Found = fault(empty)
    ;   findnsols(2, x, grammar:house_size(W, D), [_,_]) -> Found = fault(several)
    ;   grammar:house_size(W, D), suspended([W,D]) -> Found = fault(nonlinear)
    ;   Found = [] ).

in_house(Type) :-
    sized(room_size(Type, W, D)),
    member(X-Y, [W-D,D-W]),
    \+ \+ ( grammar:house_size(HW, HD), {X =< HW, Y =< HD} ), !.

smallest(Types, Least) :- findall(Short-Type, ( member(room(Type,_), Types), shortest_wall(Type, Short) ), Found), sort(Found, [_-Least|_]).

%   total_wrong(+Topology, +Rooms, +Types, -Wrong): what one room must have, or what the house may have, is out of its area.

total_wrong(shared-true, _, _, Wrong) :-
    clash(house_area(_,_), "houses of units have no stated area: state unit_depth/1, and room_area/3 of the rooms", [], Wrong).
total_wrong(Walls-false, Rooms, Types, Wrong) :-
    judged(areas_found(house_area(Least,Most), Least, Most, Found), Found, []-house_area(_,_), Report),
    (   Report = L-M
    ->  maplist(square, [L,M], [Low,High]), findall(Ranges-Type, ( member(room(Type,_), Types), type_ranges(Type, Ranges) ), Sized),
        once(total_disagrees(Walls, Low-High, Rooms, Sized, Wrong))
    ;   Wrong = Report ).

total_disagrees(Walls, _-Most, _, Sized, Wrong) :-
    findall(A-Type, member(ranges(_,_,A-_)-Type, Sized), Areas), min_member(Least-Type, Areas),
    ( Walls == shared -> Whole = Least ; Whole is 2*Least ), Most < Whole - 1.0e-9,
    ( Walls == shared, grammar:room_area(Type, _, _) -> Clause = room_area(Type,_,_) ; Clause = room_size(Type,_,_) ),
    maplist(square_metres, [Most,Least], [M,A]),
    (   Walls == shared
    ->  clash(house_area(_,_), "~w m2 at most, but no room is smaller than ~w allows: ~w m2", [metres(M),clause(Clause),metres(A)], Wrong)
    ;   clash(house_area(_,_), "~w m2 at most, but neither the main room nor another is smaller than ~w allows: ~w m2", [metres(M),clause(Clause),metres(A)], Wrong) ).
total_disagrees(shared, Least-_, _, _, Wrong) :-
    stated(house_size(_,_)), house_system(W, D, System), corners([(0 =< W)-[],(0 =< D)-[]|System], W, D, Corners),
    least_and_greatest_area(Corners, _, High-_), Least > High + 1.0e-9,
    maplist(square_metres, [Least,High], [L,H]),
    clash(house_area(_,_), "~w m2 at least, but ~w allows at most ~w m2", [metres(L),clause(house_size(_,_)),metres(H)], Wrong).
total_disagrees(Walls, Least-_, Rooms, Sized, Wrong) :-
    findall(A, member(ranges(_,_,_-A)-_, Sized), Areas), max_list(Areas, Largest),
    findall(W, member(ranges(_-W,_,_)-_, Sized), Ws), max_list(Ws, Widest),
    ( Walls == shared -> High is Rooms*Largest ; greatest_star(Rooms, Widest, Largest, High) ), Least > High + 1.0e-9,
    maplist(square_metres, [Least,High], [L,H]),
    clash(house_area(_,_), "~w m2 at least, but a house of ~w rooms, the largest number, has at most ~w m2", [metres(L),Rooms,metres(H)], Wrong).

unit_wrong(false, _, Wrong) :- clash(unit_depth(_), "houses of this topology have no units: remove the clause, or state topology(building)", [], Wrong).
unit_wrong(true, Types, Wrong) :-
    judged(sizes_found(unit_depth(D), [D], [], Found), Found, []-unit_depth(_), Report),
    (   Report = wrong(_,_,_,_)
    ->  Wrong = Report
    ;   Report = [_,High], smallest(Types, Least), shortest_wall(Least, Short), High < Short,
        clash(unit_depth(_), "units are at most ~w m deep, which is too little even for the smallest room: ~w", [metres(High),clause(room_size(Least,_,_))], Wrong) ).
