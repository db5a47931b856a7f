:- module(plans, [answer_record/2, plan_placed/3, unit_extremes/3, unit_depths/1, plan_lengths/3, brief_lengths/3, plan_conflict/3,
                  plan_system/2, wall_thicknesses/1]).

/** <module> Plans where rooms share walls: the goals that Python asks

Atoms are those of stage 1. Answers are JSON.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module('../answers').
:- use_module(areas).
:- use_module('../brief/brief').
:- use_module('../brief/thorough').
:- use_module(contacts).
:- use_module('../linear/exact').
:- use_module('../language/grammar_files').
:- use_module('../linear/grid').
:- use_module('../linear/linear').
:- use_module('../language/lengths').
:- use_module(opening_sizes).
:- use_module(totals).
:- use_module(walls).

%!  plan_placed(+Plan, +Limit, -Json) is det.
%
%   Plan is plan(Atoms,Given,Seed,Proof), Given as in walls.pl. Json is one of these, in metres, with "inferences":
%
%       {"rooms": [..], "doors": [..], "windows": [..]}    rooms by number; "between" and "room" are numbers of rooms
%       {"infeasible": Reasons}                            as in placed/3, minimal or quick, as Proof is
%       {"limit": true}                                    that takes more inferences than Limit

plan_placed(plan(Atoms,Given,Seed,Proof), Limit, Json) :-
    answer_within(Limit, walls_placed(Atoms, Given, Proof, Answer, Seed, _), Answer, answer_record, Json).

%!  unit_extremes(+Unit, +Limit, -Json) is det.
%
%   Unit is unit(Atoms,Axis,Depth,Proof). Json is as in plan_placed/3, or {"range": [Low,High]}, see unit_range/5.

unit_extremes(unit(Atoms,Axis,Depth,Proof), Limit, Json) :-
    answer_within(Limit, unit_range(Atoms, Axis, Depth, Proof, Answer), Answer, answer_record, Json).

%!  unit_depths(-Json) is det.
%
%   Json is [Least,Greatest], how deep a unit may be away from its public room, in metres; null where no clause says so.

unit_depths(Json) :-
    ( sized(unit_depth(D)), extremes(D, Low-High) -> Range = [Low,High] ; Range = null ),
    as_json(Range, Json).

answer_record(infeasible(Why), _{infeasible:Reasons}) :- maplist(reason_record, Why, Reasons).
answer_record(open(Why), _{infeasible:Reasons, open:true}) :- maplist(reason_record, Why, Reasons).
answer_record(range(Low,High), _{range:[Low,High]}).
answer_record(plan(Rooms,Doors,Windows), _{rooms:Rs, doors:Ds, windows:Ws}) :-
    maplist(room_record, Rooms, Rs),
    maplist(door_record, Doors, Ds),
    maplist(window_record, Windows, Ws).

room_record(room(R,Type,Box), Record)  :- box_record(Box, Rect), Record = Rect.put(_{number:R, type:Type}).
door_record(door(Box,R,Q), Record)     :- box_record(Box, Rect), Record = Rect.put(between, [R,Q]).
door_record(opening(Box,R,Q), Record)  :- door_record(door(Box,R,Q), Door), Record = Door.put(opening, true).
window_record(window(Box,R), Record)   :- box_record(Box, Rect), Record = Rect.put(room, R).

box_record(box(X,Y,W,H), _{x:MX, y:MY, width:MW, height:MH}) :- maplist(metres, [X,Y,W,H], [MX,MY,MW,MH]).

%!  plan_lengths(+Types, +Openings, -Json) is det.
%
%   Json is [Doorway,Contact,Openings,Extremes,Thickness,Doors]: the wall that a door takes with its margins, what rooms share at least that share
%   a wall, [Type,Other,Wall,Clauses] of each of the Openings, opening(Type,Other): the wall that it takes, for these clauses; and [Type,[LeastWidth,GreatestWidth,LeastDepth,GreatestDepth],Uppers,Lowers], what size and area leave to a room of the type.
%   It is at most W wide or at most D deep for each [W,D] of the Uppers, at least so for each of the Lowers. Thickness is that of inner walls, Doors
%   are the clauses of door_width/3; Doorway is by the least width.

plan_lengths(Types, Openings, Json) :- lengths_as_json(type_extremes, Types, Openings, Json).

:- meta_predicate lengths_as_json(2, +, +, -).

lengths_as_json(Extremes, Types, Openings, Json) :-
    length_of(door_width, Stated), length_of(door_margin, Margin),
    findall(W, ( clause(grammar:door_width(_,_,M), true), rounded_up(M, W) ), Others), min_list([Stated|Others], Width),
    metres(Width + 2*Margin, Doorway),
    maplist(Extremes, Types, Records),
    maplist(opening_record, Openings, Open),
    least_contact(Contact),
    length_of(inner_wall, Inner), metres(Inner, Thickness),
    findall(Text, ( clause(grammar:door_width(T,U,_), _), ground(T-U), term_string(door_width(T,U), Text) ), Doors),
    as_json([Doorway,Contact,Open,Records,Thickness,Doors], Json).

%!  wall_thicknesses(-Json) is det.
%
%   Json is [Inner,Outer], how thick walls are, metres.

wall_thicknesses(Json) :-
    maplist(length_of, [inner_wall,outer_wall], Lengths), maplist(metres, Lengths, Thicknesses),
    as_json(Thicknesses, Json).

opening_record(opening(T,U), [T,U,Wall,Texts]) :-
    opening_wall(T, U, Least, Clauses), metres(Least, Wall), maplist(term_string, Clauses, Texts).

type_extremes(Type, [Type,Reach,Uppers,Lowers]) :-
    room_system(Type, W, D, System),
    findall(A-B, ( posted(System), extremes(W, A), extremes(D, B) ), [(W1-W2)-(D1-D2)]), !,
    maplist(metres, [W1,W2,D1,D2], Reach),
    findall(Upper, ( within(System, {D >= D2}, W, _-Wide), step(Wide, W2, At), within(System, {W >= At}, D, _-Most), maplist(metres, [At,Most], Upper) ), Uppers),
    findall(Lower, ( within(System, {D =< D1}, W, Narrow-_), step(W1, Narrow, At), within(System, {W =< At}, D, Least-_), maplist(metres, [At,Least], Lower) ), Lowers).

type_extremes(Type, [Type,[1,0,1,0],[],[]]).        % on this grid no room of the type has a size

within(System, Constraint, X, Range) :- findall(R, ( posted(System), Constraint, extremes(X, R) ), [Range]).

%   step(+From, +To, -At): some places between them, where there is a distance.

step(From, To, At) :- To - From > 0.01, between(1, 3, K), At is From + K*(To-From)/4.

%!  brief_lengths(+Types, +Openings, -Json) is det.
%
%   As plan_lengths/3, of sizes and areas as they are stated: what loses no size that is right.

brief_lengths(Types, Openings, Json) :- lengths_as_json(stated_extremes, Types, Openings, Json).

stated_extremes(Type, [Type,Reach,Uppers,Lowers]) :-
    room_extent(Type, W1-W2, D1-D2),
    maplist(metres, [W1,W2,D1,D2], Reach),
    (   grammar:room_area(Type, Least, Most)
    ->  metres(W1, From), metres(W2, To),
        findall([At,Deep], ( step(From, To, At), Deep is Most/At ), Uppers),
        findall([At,Deep], ( step(From, To, At), Deep is Least/At ), Lowers)
    ;   Uppers = [], Lowers = [] ), !.
stated_extremes(Type, [Type,[1,0,1,0],[],[]]).

%!  plan_conflict(+Atoms, +Without, -Json) is det.
%
%   Json lists the reasons of a minimal conflict of these walls where the clauses Without are left out; null if there is
%   none, as where a topology lacks some walls.

plan_conflict(Atoms, Without, Json) :-
    (   once(conflicting(Atoms, Without, Conflict))
    ->  findall(Reason, ( member(_-Why, Conflict), member(Reason, Why) ), Found),
        sort(Found, Sorted), maplist(reason_record, Sorted, Reasons)
    ;   Reasons = null ),
    as_json(Reasons, Json).

conflicting(Atoms, Without, Conflict) :-
    memberchk(thorough, Atoms), !,
    exact_system(Atoms, plan(Lines,Rooms), System, Items),
    exclude(resting_on(Without), System, Rest),
    exclude(item_resting_on(Without), Items, Others),
    thoroughly_decided(Lines, Rooms, Rest, Others, refuted(Conflict), 0, _).
conflicting(Atoms, Without, Conflict) :-
    of_brief(Atoms), !,
    brief_system(Atoms, plan(Lines,Rooms), System, Items),
    exclude(resting_on(Without), System, Rest),
    exclude(item_resting_on(Without), Items, Others),
    items_decided(minimal, Lines, Rooms, Rest, Others, Answer, 0, Seed),
    ( Answer == open -> thoroughly_decided(Lines, Rooms, Rest, Others, refuted(Conflict), Seed, _) ; Answer = refuted(Conflict) ).
conflicting(Atoms, Without, Conflict) :-
    whole_system(Atoms, [], Plan, System),
    exclude(resting_on(Without), System, Rest),
    (   exact_conflict(minimal, Rest, Conflict)
    ->  true
    ;   Without == [], unsampled(Atoms, Plan, System), Conflict = System ).

item_resting_on(Without, item(_,_,_,Why,_,_)) :- resting_on(Without, _-Why).

resting_on(Without, _-Why) :- member(Reason, Why), memberchk(Reason, Without), !.

%!  plan_system(+Atoms, -Json) is det.
%
%   Json is the linear system of these walls, rows as in linear.pl, and what CLP(R) and CLP(Q) say: whether there is a
%   solution. That of a brief has what its areas leave of lengths; in the place of CLP(R) it is what refutes a layout (brief.pl).

plan_system(Atoms, Json) :-
    of_brief(Atoms), !,
    brief_system(Atoms, _, System, Items),
    outer_system(System, Items, All),
    solver_verdicts(All, Record),
    ( middle(All, impossible(_)) -> Real = false ; Real = true ),
    as_json(Record.put(real, Real), Json).
plan_system(Atoms, Json) :-
    wall_system(Atoms, [], _, System),
    solver_verdicts(System, Record),
    as_json(Record, Json).
