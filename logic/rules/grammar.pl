:- module(lengths, [load_grammar/2, metres/2, room_extent/5, piece_extent/6, length_report/2,
                    room_report/2, piece_report/3]).

/** <module> A grammar's lengths

The `.pl` files of a grammar are loaded into the module `grammar`: room_size/3, piece_size/4 and the named
lengths. They are the single source of lengths; what stage 1 needs of them is derived here.
*/

:- use_module(library(apply)).
:- use_module(library(yall)).
:- use_module(library(clpr)).
:- use_module(library(lists)).
:- use_module(library(solution_sequences)).

:- dynamic problem/4.
:- table room_extent/5, piece_extent/6.      % each is a few simplex runs, and asked for in every room
% A grammar may state its clauses in any order, in one file or several.
:- dynamic grammar:room_size/3, grammar:piece_size/4.
:- multifile grammar:room_size/3, grammar:piece_size/4.
:- discontiguous grammar:room_size/3, grammar:piece_size/4.
:- dynamic grammar:door_width/1, grammar:door_clearance/1, grammar:passage/1, grammar:room_gap/1.
:- multifile grammar:door_width/1, grammar:door_clearance/1, grammar:passage/1, grammar:room_gap/1.
:- dynamic user:message_hook/3.
:- multifile user:message_hook/3.

% - loading ------------------------------------------------------------------

%!  load_grammar(+Files, -Problems) is det.
%
%   Problems are problem(File,Line,Column,Text) for all that SWI-Prolog remarks while it loads the files: it
%   would otherwise drop a clause with a syntax error and go on.

load_grammar(Files, Problems) :-
    retractall(problem(_,_,_,_)),
    grammar:use_module(library(clpr)),
    setup_call_cleanup(
        asserta((user:message_hook(Term, Kind, Lines) :- lengths:noted(Term, Kind, Lines)), Hook),
        forall(member(File, Files), load_files(grammar:File, [if(true),encoding(utf8)])),
        erase(Hook)),
    findall(problem(F,L,C,T), problem(F,L,C,T), Problems).

noted(Term, Kind, Lines) :-
    memberchk(Kind, [error, warning]),
    place(Term, File, Line, Column),
    message_text(Term, Lines, Text),
    assertz(problem(File, Line, Column, Text)).

place(error(_, file(File,Line,Before,_)), File, Line, Column) :- !, Column is Before + 1.
place(_, File, Line, 1) :- source_location(File, Line), !.
place(_, File, 1, 1)    :- prolog_load_context(source, File), !.
place(_, '', 1, 1).

message_text(error(syntax_error(Which), _), _, Text) :- !,
    format(string(Text), "syntax error: ~w", [Which]).
message_text(_, Lines, Text) :-
    with_output_to(string(Raw), print_message_lines(current_output, '', Lines)),
    split_string(Raw, "\n", " \t", Parts),
    exclude(==(""), Parts, Said),
    atomic_list_concat(Said, ' ', Atom),
    atom_string(Atom, Text).

% - lengths ------------------------------------------------------------------

%!  metres(+Name, -Metres) is det.

metres(door_width,     M) :- grammar:door_width(M).
metres(door_clearance, M) :- grammar:door_clearance(M).
metres(passage,        M) :- grammar:passage(M).
metres(room_gap,       M) :- grammar:room_gap(M).

%!  room_extent(+Type, -W, -WW, -D, -DD) is semidet.
%
%   A room of this type is W to WW wide and D to DD deep.

room_extent(Type, W, WW, D, DD) :-
    once(grammar:room_size(Type, Width, Depth)),
    extremes(Width, W, WW),
    extremes(Depth, D, DD).

%!  piece_extent(+Type, +Piece, -L, -LL, -D, -DD) is semidet.
%
%   In a room of this type, a piece takes L to LL of a wall and stands D to DD out from it.

piece_extent(Type, Piece, L, LL, D, DD) :-
    room_extent(Type, W1, W2, D1, D2),
    Least is min(W1, D1), Most is max(W2, D2),
    { Wall >= Least, Wall =< Most },
    once(grammar:piece_size(Piece, Length, Depth, Wall)),
    extremes(Length, L, LL),
    extremes(Depth, D, DD).

extremes(X, X, X)      :- number(X), !.
extremes(X, Low, High) :- inf(X, Low), sup(X, High).

% - reports ------------------------------------------------------------------

%!  length_report(+Name, -Report) is det.
%
%   Report is the length, or says in words why it is of no use, or is null where it is not stated.

length_report(Name, Report) :-
    findall(M, metres(Name, M), Stated),
    length_judged(Stated, Report).

length_judged([], null).
length_judged([_,_|_], "is stated more than once").
length_judged([M], M) :- number(M), M >= 0, !.
length_judged([_], "is not a number of metres, 0 or more").

%!  room_report(+Type, -Report) is det.
%!  piece_report(+Type, +Piece, -Report) is det.
%
%   Report lists the four extremes, or says in words why the clause is of no use, or is null without a clause.

room_report(Type, Report) :-
    report([W,D], [], grammar:room_size(Type, W, D), Report),
    ( is_list(Report) -> room_extent(Type, _, _, _, _) ; true ).

piece_report(Type, Piece, Report) :-
    (   room_extent(Type, W1, W2, D1, D2)
    ->  Least is min(W1, D1), Most is max(W2, D2),
        { Wall >= Least, Wall =< Most },
        report([L,D], [Wall], grammar:piece_size(Piece, L, D, Wall), Report),
        ( is_list(Report) -> piece_extent(Type, Piece, _, _, _, _) ; true )
    ;   Report = [0,0,0,0] ).

%   report(+Sizes, +Given, :Clause, -Report): of Sizes under the one solution of Clause, which may use the Given.

report(Sizes, Given, Clause, Report) :-
    call_with_inference_limit(reported(Sizes, Given, Clause, Found), 1 000 000, Result),
    ( Result == inference_limit_exceeded -> Report = "recurs without end" ; Report = Found ).

reported(_, _, Clause, null) :- \+ Clause, !.
reported(_, _, Clause, "has more than one solution: state one") :-
    findall(x, limit(2, Clause), [_,_]), !.
reported(Sizes, Given, Clause, Report) :-
    once(Clause),
    append(Sizes, Given, All),
    once(judged(Sizes, All, Report)).

judged(_, All, Report) :-
    nonlinear(All, Constraint),
    format(string(Report), "has the nonlinear constraint ~p, and CLP(R) decides linear ones", [Constraint]).
judged(Sizes, _, "is not bounded on both sides") :- \+ maplist([X]>>extremes(X, _, _), Sizes).
judged(Sizes, _, "allows a size that is not positive") :- member(X, Sizes), extremes(X, Low, _), Low =< 0.
judged(Sizes, _, [A,AA,B,BB]) :- maplist(extremes, Sizes, [A,B], [AA,BB]).

nonlinear(Sizes, Constraint) :-
    copy_term(Sizes, _, Goals),
    member({Conjunction}, Goals),
    conjunct(Constraint, Conjunction),
    Constraint =.. [_, A, B],
    \+ ( linear(A), linear(B) ).

conjunct(G, (A,B)) :- !, ( conjunct(G, A) ; conjunct(G, B) ).
conjunct(G, G).

linear(X)   :- var(X), !.
linear(X)   :- number(X).
linear(A+B) :- linear(A), linear(B).
linear(A-B) :- linear(A), linear(B).
linear(-A)  :- linear(A).
linear(A*B) :- ( number(A) -> linear(B) ; number(B), linear(A) ).
