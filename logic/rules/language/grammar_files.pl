:- module(grammar_files, [load_grammar/2, load_grammar/3, typical_places/1, state_grammar/1, drop_grammar/0, grammar_terms/1]).

/** <module> A grammar's .pl files, loaded

The clauses that were read (written.pl) and judged (lint.pl) are added to the module `grammar`: SWI-Prolog's own loader never
reads the files, which would run directives and expand terms. A grammar may state its clauses in any order, in one file
or several.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module(library(sandbox)).
:- use_module(library(yall)).
:- use_module(lint).
:- use_module(written).

%!  room_size(?Type, -Width, -Depth)
%
%   Size of rooms of this Type, in metres: Width along the wall with the door, Depth away from it.
%
%       room_size(cellar, W, D) :- { W >= 2.4, W =< 4.0, D >= 2.4, D =< W }.

%!  room_area(?Type, -Least, -Most)
%
%   Floor area of rooms of this Type, in square metres, if rooms share walls. Without it, room_size/3 alone bounds the area.
%
%       room_area(cellar, 6.0, 14.0).

%!  door_margin(-Distance)
%
%   Least distance of a door from the corners of its rooms, in metres, in a shared wall; 0 by default.
%
%       door_margin(0.1).

%!  window_margin(-Distance)
%
%   Least distance of a window from the corners of its room, in metres; 0 by default.
%
%       window_margin(0.65).

%!  whole_area(?Type, -Least, -Most)
%
%   Area of a room of this Type together with its parts (part/2), in square metres. room_area/3 and room_size/3 apply to each
%   by itself. Not for houses of units.
%
%       whole_area(cellar, 18.0, 24.0).

%!  wall_thickness(?Kind, -Thickness)
%
%   Thickness of walls, in metres, if rooms share walls. Kind is inner, between rooms, or outer, which is at least as thick, and by
%   default as thick. All sizes and areas are measured within the walls. Without it, walls have no thickness.
%
%       wall_thickness(inner, 0.1). wall_thickness(outer, 0.3).

%!  house_size(-Width, -Depth)
%
%   Size of a whole plan, in metres, if rooms share walls: Width from west to east, Depth from north to south. In houses of
%   units the size applies to each unit, not to all units together.
%
%       house_size(W, D) :- { W =< 2*D, D =< 2*W }.

%!  house_area(-Least, -Most)
%
%   Floor area of all rooms of a house together, in square metres; in a star including the main room. Not for houses of
%   units: state unit_depth/1 and room_area/3 there.
%
%       house_area(60.0, 80.0).

%!  unit_depth(-Depth)
%
%   Depth of a unit, in metres, away from the public room from which one enters it.
%
%       unit_depth(D) :- { D >= 7.0, D =< 11.0 }.

%!  window_size(?Type, -Length, +Wall)
%
%   Length of a window of a room of this Type, in metres, in an outer wall of length Wall.
%
%       window_size(cellar, L, Wall) :- { L >= 0.4, L =< 0.3*Wall, L =< 1.0 }.

%!  opening_size(?Type, ?Other, -Length, +Wall)
%
%   Width of an opening between rooms of these types, in metres, in a shared part of a wall of length Wall. From some length on,
%   every wall must allow one. Without it, all of that part is open.
%
%       opening_size(cellar, hall, L, Wall) :- { L >= 1.2, L =< 0.8*Wall }.

%!  piece_size(?Piece, -Length, -Depth, +Wall)
%
%   Size of such pieces or companions, in metres: Length along the wall behind them, Depth away from it. Wall is the
%   length of that wall from corner to corner; in the middle of a room, the room's width. With Wall-Across in its place, Across is
%   the room's other side; in the middle, the room's depth.
%
%       piece_size(rack,  L, D, Wall) :- { L >= 0.8, L =< 0.5*Wall, D = 0.4 }.
%       piece_size(keg,   L, D, Wall-Across) :- { L >= 0.1*Wall, L =< 0.2*Wall, D = 0.1*Across }.
%       piece_size(crate, L, D, _)    :- { L >= 0.3, L =< 0.5, D = L }.
%       piece_size(stool, L, D, _)    :- { L = 0.4, D = L }.

%!  door_width(-Width)
%
%   Width of every door, in metres, and least width of an opening (opening_size/4).
%
%       door_width(0.762).

%!  door_width(?Type, ?Other, -Width)
%
%   Width of a door between rooms of these types, in either order, in metres, if rooms share walls. For an entrance one of them is
%   `outside`. door_width/1 applies to other doors. Not for given plans.
%
%       door_width(cellar, hall, 0.7). door_width(hall, outside, 1.0).

%!  door_clearance(-Distance)
%
%   Least distance of furniture from a door, in metres, on either side of the wall.
%
%       door_clearance(0.45).

%!  passage(-Width)
%
%   Least width of a way between furniture, in metres.
%
%       passage(0.42).

%!  turning(?Type, -Side)
%
%   Side of a free square in rooms of this Type, in metres, in which a wheelchair turns. Nothing stands in the middle of such
%   rooms.
%
%       turning(cellar, 1.5).

%!  room_gap(-Distance)
%
%   Least distance between neighbouring rooms, in metres.
%
%       room_gap(0.6).

:- dynamic grammar:room_size/3, grammar:piece_size/4.
:- dynamic grammar:door_width/1, grammar:door_clearance/1, grammar:passage/1, grammar:room_gap/1.
:- dynamic grammar:turning/2.

:- dynamic grammar:room_area/3, grammar:whole_area/3, grammar:house_size/2, grammar:house_area/2, grammar:unit_depth/1, grammar:window_size/3, grammar:opening_size/4, grammar:door_margin/1, grammar:window_margin/1, grammar:wall_thickness/2, grammar:door_width/3.

% Nothing but what a body may call is visible to a grammar.
:- set_module(grammar:base(system)).
:- grammar:use_module(library(clpr), [{}/1]).
:- grammar:use_module(library(lists), [member/2,memberchk/2]).

:- dynamic file_text/2, written/3, stated/1, typical_place/1.

%!  load_grammar(+Files, -Problems) is det.
%
%   Files are as in written.pl. Problems are those of the files' terms (lint.pl). Where there are none, these terms are
%   the grammar, and what was loaded before is dropped.

load_grammar(Files, Problems) :- load_grammar(Files, [], Problems).

%!  load_grammar(+Files, +LeftOut, -Problems) is det.
%
%   As load_grammar/2, without the typical clauses that are LeftOut: each is File-Line, where it begins.

load_grammar(Files, LeftOut, Problems) :-
    drop_grammar,
    written_terms(Files, Written),
    maplist(plain_term, Written, Terms, Kinds),
    term_problems(Terms, Problems),
    ( Problems == [] -> pairs_keys_values(Pairs, Kinds, Terms), settled(Pairs, LeftOut, Settled), state_grammar(Settled) ; true ).

%   plain_term(+Written, -Term, -Kind): of a limit, limit(Head) :- Body, Term is the clause Head :- Body.

plain_term(term(Source,P,clause(limit(Head),Body,term_position(_,_,_,_,[At]),B,Names,Single)),
           term(Source,P,clause(Head,Body,At,B,Names,Single)), limit) :- nonvar(Head), !.
plain_term(Term, Term, other).

%   settled(+Pairs, +LeftOut, -Terms): a clause is typical where there is a limit for the same, which stands in its place if it is LeftOut.
%   Where the typical clauses stand is kept.

settled(Pairs, LeftOut, Terms) :-
    findall(About, ( member(limit-Term, Pairs), about(Term, About) ), Limits),
    findall(Place, ( member(other-Term, Pairs), about(Term, About), memberchk(About, Limits), line(Term, Place) ), Typical),
    exclude(is_left_out(LeftOut), Pairs, Kept),
    findall(About, ( member(other-Term, Kept), about(Term, About) ), Stated),
    exclude(is_no_limit(Stated), Kept, Settled),
    pairs_values(Settled, Terms),
    maplist([P]>>assertz(typical_place(P)), Typical).

is_left_out(LeftOut, other-Term) :- line(Term, Place), memberchk(Place, LeftOut).

is_no_limit(Stated, limit-Term) :- about(Term, Of-Type), once(( memberchk(Of-Type, Stated) ; memberchk(Of-'', Stated) )).

line(term(Source,Position,_), File-Line) :- Source = source(File,_), place(Source, Position, Line, _).

%!  typical_places(-Places) is det.
%
%   Where the typical clauses of the grammar stand, each as File-Line.

typical_places(Places) :- findall(Place, typical_place(Place), Places).

%   about(+Term, -About): Name/Arity-Type of a clause's head, where Type is the first argument, if that is a name.

about(term(_,_,clause(Head,_,_,_,_,_)), Name/Arity-Type) :-
    functor(Head, Name, Arity),
    ( compound(Head), arg(1, Head, First), atom(First) -> Type = First ; Type = '' ).

%!  state_grammar(+Terms) is det.
%
%   The grammar is the clauses among these Terms, as they are: no other reader sees them. library(sandbox) holds once more
%   that whatever they call is harmless; it raises an error, and the grammar is dropped, if not.

state_grammar(Terms) :-
    maplist(state, Terms),
    convlist(generic_head, Terms, Heads), list_to_set(Heads, Distinct),
    catch(forall(member(Name/Arity, Distinct), safe(Name/Arity)), Error, ( drop_grammar, throw(Error) )).

state(term(source(File,Text),Position,Kind)) :-
    ( file_text(File, _) -> true ; assertz(file_text(File, Text)) ),
    assertz(written(File, Position, Kind)),
    (   Kind = clause(Head,Body,_,_,_,_)
    ->  ( Body == true -> Clause = Head ; Clause = (Head :- Body) ),
        assertz(grammar:Clause, Reference), assertz(stated(Reference))
    ;   true ).

generic_head(term(_,_,clause(Head,_,_,_,_,_)), Name/Arity) :- functor(Head, Name, Arity).

safe(Name/Arity) :- functor(Head, Name, Arity), safe_goal(grammar:Head).

%!  drop_grammar is det.
%
%   The grammar has no clause.

drop_grammar :-
    forall(retract(stated(Reference)), erase(Reference)),
    retractall(file_text(_,_)), retractall(written(_,_,_)), retractall(typical_place(_)).

%!  grammar_terms(-Terms) is det.
%
%   Terms are those that are stated, as they are written.

grammar_terms(Terms) :-
    findall(File-Text, file_text(File, Text), Texts),
    findall(File-term(_,Position,Kind), written(File, Position, Kind), Found),
    maplist(term_in(Texts), Found, Terms).

term_in(Texts, File-Term, Term) :- memberchk(File-Text, Texts), Term = term(source(File,Text),_,_).
