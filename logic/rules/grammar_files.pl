:- module(grammar_files, [load_grammar/2, drop_grammar/0, grammar_terms/1]).

/** <module> A grammar's .pl files, loaded

They are loaded into the module `grammar`: the predicates that are declared here. A grammar may state its clauses in any
order, in one file or several.
*/

:- use_module(library(apply)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(written).

%!  room_size(?Type, -Width, -Depth)
%
%   how large rooms of this Type are, in metres: Width along the wall with the door, Depth away from it.
%
%       room_size(cellar, W, D) :- { W >= 2.4, W =< 4.0, D >= 2.4, D =< W }.

%!  room_area(?Type, -Least, -Most)
%
%   how large the floor of rooms of this Type is, in square metres, in plans where rooms share walls; without it, what
%   room_size/3 allows.
%
%       room_area(cellar, 6.0, 14.0).

%!  house_size(-Width, -Depth)
%
%   how large a whole plan is, in metres, where rooms share walls: Width from west to east, Depth from north to south.
%
%       house_size(W, D) :- { W =< 2*D, D =< 2*W }.

%!  window_size(?Type, -Length, +Wall)
%
%   how long a window of a room of this Type is, in metres, in an outer wall as long as Wall.
%
%       window_size(cellar, L, Wall) :- { L >= 0.4, L =< 0.3*Wall, L =< 1.0 }.

%!  piece_size(?Piece, -Length, -Depth, +Wall)
%
%   how large such pieces or companions are, in metres: Length along the wall behind them, Depth out from it. Wall is the
%   length of that wall from corner to corner; in the middle of a room, the room's width.
%
%       piece_size(rack,  L, D, Wall) :- { L >= 0.8, L =< 0.5*Wall, D = 0.4 }.
%       piece_size(keg,   L, D, _)    :- { L = 1.0, D = L }.
%       piece_size(crate, L, D, _)    :- { L >= 0.3, L =< 0.5, D = L }.
%       piece_size(stool, L, D, _)    :- { L = 0.4, D = L }.

%!  door_width(-Width)
%
%   how wide every door is, in metres.
%
%       door_width(0.762).

%!  door_clearance(-Distance)
%
%   how far furniture stands from a door at least, in metres, on either side of the wall.
%
%       door_clearance(0.45).

%!  passage(-Width)
%
%   how wide a way between furniture is at least, in metres.
%
%       passage(0.42).

%!  room_gap(-Distance)
%
%   how far apart neighbouring rooms stand at least, in metres.
%
%       room_gap(0.6).

:- dynamic grammar:room_size/3, grammar:piece_size/4.
:- multifile grammar:room_size/3, grammar:piece_size/4.
:- discontiguous grammar:room_size/3, grammar:piece_size/4.
:- dynamic grammar:door_width/1, grammar:door_clearance/1, grammar:passage/1, grammar:room_gap/1.
:- multifile grammar:door_width/1, grammar:door_clearance/1, grammar:passage/1, grammar:room_gap/1.

:- dynamic grammar:room_area/3, grammar:house_size/2, grammar:window_size/3.
:- multifile grammar:room_area/3, grammar:house_size/2, grammar:window_size/3.
:- discontiguous grammar:room_area/3, grammar:house_size/2, grammar:window_size/3.

:- dynamic loaded/1, problem/4.
:- dynamic user:message_hook/3.
:- multifile user:message_hook/3.

%!  load_grammar(+Files, -Problems) is det.
%
%   Problems are problem(File,Line,Column,Text) for all that SWI-Prolog remarks while it loads the files: it
%   would otherwise drop a clause with a syntax error and go on.

load_grammar(Files, Problems) :-
    retractall(problem(_,_,_,_)),
    grammar:use_module(library(clpr)),
    setup_call_cleanup(
        asserta((user:message_hook(Term, Kind, Lines) :- grammar_files:noted(Term, Kind, Lines)), Hook),
        forall(member(File, Files), ( assertz(loaded(File)), load_files(grammar:File, [if(true),encoding(utf8)]) )),
        erase(Hook)),
    findall(problem(F,L,C,T), problem(F,L,C,T), Problems).

%!  drop_grammar is det.
%
%   The files that load_grammar/2 has loaded are unloaded.

drop_grammar :- forall(retract(loaded(File)), unload_file(File)).

%!  grammar_terms(-Terms) is det.
%
%   Terms are those of the loaded files, as they are written.

grammar_terms(Terms) :-
    findall(File, ( loaded(File), exists_file(File) ), Files),
    written_terms(Files, Terms).

%   noted(+Term, +Kind, +Lines) is semidet: a message is a problem, and SWI-Prolog prints it no more.

noted(Term, Kind, Lines) :-
    memberchk(Kind, [error, warning]),
    message_place(Term, File, Line, Column),
    message_text(Term, Lines, Text),
    assertz(problem(File, Line, Column, Text)).

message_place(error(_, file(File,Line,Before,_)), File, Line, Column) :- !, Column is Before + 1.
message_place(_, File, Line, 1) :- source_location(File, Line), !.
message_place(_, File, 1, 1)    :- prolog_load_context(source, File), !.
message_place(_, '', 1, 1).

message_text(error(syntax_error(Which), _), _, Text) :- !,
    format(string(Text), "syntax error: ~w", [Which]).
message_text(_, Lines, Text) :-
    with_output_to(string(Raw), print_message_lines(current_output, '', Lines)),
    split_string(Raw, "\n", " \t", Parts),
    exclude(==(""), Parts, Said),
    atomic_list_concat(Said, ' ', Atom),
    atom_string(Atom, Text).
