:- module(reports, [length_report/2, room_report/2, piece_report/4, judged/4, sizes_found/4, suspended/1]).

/** <module> Whether the grammar's clauses give lengths that can be used, and the extremes of those that do

A report is a length in metres or a list of four extremes; or wrong(File,Line,Column,Text) where the clause cannot be
used; or null where the grammar has no clause.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(faults).
:- use_module(grammar_files).
:- use_module('../linear/grid').
:- use_module(lengths).
:- use_module(nonlinear).

:- meta_predicate judged(0, ?, +, -).

%!  length_report(+Name, -Report) is det.
%
%   Report is the named length, or is wrong or null.

length_report(Name, Report) :-
    Head =.. [Name,_],
    judged(length_found(Name, Found), Found, []-Head, Report).

length_found(Name, Found) :-
    once(findnsols(2, M, stated_length(Name, M), Stated)),
    stated(Stated, Name, Found).

stated([],    _, fault(empty)).
stated([_,_], _, fault(several)) :- !.
stated([M], Name, Found) :-
    (   number(M), \+ catch(_ is float(M), _, fail)
    ->  Found = fault(too_large)
    ;   number(M), M >= 0
    ->  ( Name == door_width, M =:= 0 -> Found = fault(no_width) ; rounded_up(M, Length), metres(Length, Found) )
    ;   Found = fault(not_metres) ).

%!  room_report(+Type, -Report) is det.
%
%   Report lists the least and greatest width and depth, or is wrong or null.

room_report(Type, Report) :-
    judged(room_found(Type, Found), Found, []-room_size(Type,_,_), Report),
    ( is_list(Report) -> room_extent(Type, _, _) ; true ).

room_found(Type, Found) :- sizes_found(room_size(Type,W,D), [W,D], [], Found).

%!  piece_report(+Type, +Piece, +Turns, -Report) is det.
%
%   Report lists the least and greatest length and depth in a room of this type, which has a size, or is wrong or null.
%   Turns says whether the piece may stand with its side to the wall.

piece_report(Type, Piece, Turns, Report) :-
    \+ \+ clause(grammar:piece_size(Piece,_,_,_), _), !,
    room_range(Type, W1-W2, D1-D2),
    Least is min(W1, D1), Most is max(W2, D2),
    Head = piece_size(Piece,L,D,Called), given_walls(Piece, Wall-Across, Called),
    (   Called == Wall
    ->  Name = "~w", At = [4], Others = []
    ;   Name = "its wall", At = [], Others = [ (Across >= Least)-said("",[]), (Across =< Most)-said("",[]) ] ),
    clause_line(piece_size(Piece,_,_,_), room_size(Type,_,_), Line), format(string(In), "in ~w, ~w", [Type,Line]),
    format(string(Short), "~s >= ~3g (~s)", [Name,Least,In]),
    format(string(Long), "~s =< ~3g (~s)", [Name,Most,In]),
    format(string(Within), "~~w =< ~s", [Name]),
    format(string(Deep), "~~w =< ~3g (~s)", [Most,In]),
    Walls = [ (Wall >= Least)-said(Short,At), (Wall =< Most)-said(Long,At), (Wall > 0)-said("",[])|Others ],
    Inside = [ (D =< Most)-said(Deep,[3]), (L =< Wall)-said(Within,[2|At]) ],
    judged(piece_found(Piece, Least-Most, Found), Found, Walls-Head, Report0),
    (   is_list(Report0), \+ fits(Type, Piece, Turns)
    ->  append(Inside, Walls, Given),
        (   explained_fault(empty, Given-Head, Report)
        ->  true
        ;   clash(piece_size(Piece,_,_,_), "it fits in no room of ~w", [clause(room_size(Type,_,_))], Report) )
    ;   Report = Report0 ),
    ( is_list(Report) -> piece_extent(Type, Piece, _, _) ; true ).

piece_report(_, _, _, null).

piece_found(Piece, Least-Most, Found) :-
    { Wall >= Least, Wall =< Most, Across >= Least, Across =< Most },
    given_walls(Piece, Wall-Across, Given),
    sizes_found(piece_size(Piece,L,D,Given), [L,D], [Wall,Across], Found).

%   fits(+Type, +Piece, +Turns) is semidet: the piece can stand within the walls of some room of this type.

fits(Type, Piece, Turns) :-
    sized(room_size(Type, W, D)),
    member(Wall-Other, [W-D,D-W]),
    piece_sized(Piece, Length, Depth, Wall-Other),
    ( Along-Out = Length-Depth ; Turns == true, Along-Out = Depth-Length ),
    \+ \+ {Along =< Wall, Out =< Other}, !.

%!  judged(:Goal, ?Found, +Call, -Report) is det.
%
%   Report of what Goal has Found for the Call (see faults.pl).

judged(_, _, _-Head, null) :- \+ clause(grammar:Head, _), !.
judged(Goal, Found, Call, Report) :-
    call_with_inference_limit(catch(Goal, error(Error,_), found_error(Error, Found)), 300 000, Result),
    (   Result == inference_limit_exceeded
    ->  fault_report(endless, Call, Report)
    ;   Found = fault(Kind)
    ->  fault_report(Kind, Call, Report)
    ;   Report = Found ).

found_error(resource_error(_), fault(endless)) :- !.
found_error(_, fault(raised)).

%!  sizes_found(:Clause, +Sizes, +Given, -Found) is det.
%
%   Found are the least and the greatest of each of the Sizes, or a fault, under the one solution of Clause, which may use the Given.

sizes_found(Clause, _, _, fault(empty)) :- \+ grammar:Clause, !.
sizes_found(Clause, _, _, fault(several)) :- findnsols(2, x, grammar:Clause, [_,_]), !.
sizes_found(Clause, Sizes, Given, Found) :-
    once(grammar:Clause),
    append(Sizes, Given, All),
    once(size_found(Sizes, All, Found)).

size_found(_, All, fault(nonlinear)) :- suspended(All).
size_found(Sizes, _, fault(unbounded))    :- \+ maplist(extremes, Sizes, _).
size_found(Sizes, _, fault(not_positive)) :- member(X, Sizes), extremes(X, Low-_), Low =< 0.
size_found(Sizes, _, Found) :-
    maplist(extremes, Sizes, Ranges),
    maplist(rounded_range, Ranges, Rounded),
    findall(M, ( member(L-H, Rounded), member(X, [L,H]), metres(X, M) ), Found).

%!  suspended(+Sizes) is semidet.
%
%   CLP(R) waits with a constraint of these, since it is not linear.

suspended(Sizes) :-
    copy_term(Sizes, _, Goals),
    member({Conjunction}, Goals),
    conjunct(Constraint, Conjunction),
    nonlinear(Constraint, _), !.

conjunct(G, (A,B)) :- !, ( conjunct(G, A) ; conjunct(G, B) ).
conjunct(G, G).
