:- module(lengths, [load_grammar/2, set_cell/1, metres/2, length_of/2, room_extent/5, piece_extent/6,
                    piece_range/6, rounded/4, room_law/2, piece_law/3, room_system/4, piece_system/6,
                    length_report/2, room_report/2, piece_report/3]).

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
:- table room_extent/5, piece_extent/6, room_law/2, piece_law/3, clause_system/4.   % a few simplex runs each, asked for in every room
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
% All in metres, or in cells where houses stand on a grid: then fixed lengths and least ones are rounded up, greatest
% ones down, and what is left between them is a whole number of cells.

:- dynamic cell/1.

%!  set_cell(+Cell) is det.
%
%   Cell is the side of a cell in metres, or 0 for none.

set_cell(Cell) :-
    retractall(cell(_)), retractall(draw:lattice(_)),
    abolish_all_tables,
    ( Cell > 0 -> assertz(cell(Cell)), assertz(draw:lattice(whole)) ; assertz(draw:lattice(real)) ).

%!  metres(+Length, -Metres) is det.

metres(Length, Metres) :- ( cell(Cell) -> Metres is Length*Cell ; Metres is float(Length) ).

up(M, X)   :- ( cell(Cell) -> X is ceiling(M/Cell - 1.0e-9) ; X = M ).
down(M, X) :- ( cell(Cell) -> X is floor(M/Cell + 1.0e-9)   ; X = M ).

rounded(M, MM, Low, High) :- up(M, Low), down(MM, Most), High is max(Low, Most).

%!  length_of(+Name, -Length) is det.

length_of(Name, Length) :- stated(Name, M), up(M, Length).

stated(door_width,     M) :- grammar:door_width(M).
stated(door_clearance, M) :- grammar:door_clearance(M).
stated(passage,        M) :- grammar:passage(M).
stated(room_gap,       M) :- grammar:room_gap(M).

%!  room_extent(+Type, -W, -WW, -D, -DD) is semidet.
%
%   A room of this type is W to WW wide and D to DD deep.

room_extent(Type, W, WW, D, DD) :-
    room_range(Type, W1, W2, D1, D2),
    rounded(W1, W2, W, WW), rounded(D1, D2, D, DD).

room_range(Type, W1, W2, D1, D2) :-
    once(grammar:room_size(Type, Width, Depth)),
    extremes(Width, W1, W2),
    extremes(Depth, D1, D2).

%!  piece_extent(+Type, +Piece, -L, -LL, -D, -DD) is semidet.
%
%   In a room of this type, a piece takes L to LL of a wall and stands D to DD out from it.

piece_extent(Type, Piece, L, LL, D, DD) :-
    room_range(Type, W1, W2, D1, D2),
    Least is min(W1, D1), Most is max(W2, D2),
    { Wall >= Least, Wall =< Most },
    piece_range(Piece, Wall, L1, L2, DD1, DD2),
    rounded(L1, L2, L, LL), rounded(DD1, DD2, D, DD).

piece_range(Piece, Wall, L1, L2, D1, D2) :-
    once(grammar:piece_size(Piece, Length, Depth, Wall)),
    extremes(Length, L1, L2),
    extremes(Depth, D1, D2).

extremes(X, X, X)      :- number(X), !.
extremes(X, Low, High) :- inf(X, Low), sup(X, High).

%!  room_law(+Type, -Law) is det.
%!  piece_law(+Type, +Piece, -Law) is det.
%
%   How two sizes, in metres, depend on each other: box(A,AA,B,BB), not at all; line(A,AA,B,BB), from (A,B) to
%   (AA,BB); or clause, in a way that only the clause itself tells. Each number is one, or on(Wall1,Y1,Slope): Y1 where
%   the wall is Wall1 long, and so on in a straight line.

room_law(Type, Law) :-
    once(grammar:room_size(Type, W, D)),
    law(W, D, Law).

piece_law(Type, Piece, Law) :-
    room_range(Type, W1, W2, D1, D2),
    Short is min(W1, D1), Long is max(W2, D2), Middle is (Short+Long)/2,
    once(grammar:piece_size(Piece, L, D, Wall)),
    (   \+ attvar(Wall)
    ->  law(L, D, Law)
    ;   maplist(law_at(Piece), [Short,Middle,Long], [Law1,Law2,Law3]),
        Law1 =.. [Kind|As], Law2 =.. [Kind|Bs], Law3 =.. [Kind|Cs],
        straight(As, Bs, Cs, Short, Long, Straight)
    ->  Law =.. [Kind|Straight]
    ;   Law = clause ).

law_at(Piece, Wall, Law) :- once(grammar:piece_size(Piece, L, D, Wall)), law(L, D, Law).

%   The least and the greatest of a linear program are convex and concave in what is given: what lies on the straight
%   line in the middle lies on it throughout.

straight([], [], [], _, _, []).
straight([A|As], [B|Bs], [C|Cs], Short, Long, [Y|Ys]) :-
    abs(B - (A+C)/2) < 1.0e-9,
    ( abs(A-C) < 1.0e-9 -> Y = A ; Slope is (C-A)/(Long-Short), Y = on(Short,A,Slope) ),
    straight(As, Bs, Cs, Short, Long, Ys).

law(A, B, Law) :-
    extremes(A, A1, A2), extremes(B, B1, B2),
    (   ( cell(_) ; A \== B, independent(A, B) )
    ->  Law = box(A1,A2,B1,B2)
    ;   at_end(A, A1, B, V1), at_end(A, A2, B, V2)
    ->  Law = line(A1,A2,V1,V2)
    ;   Law = clause ).

independent(A, B) :-
    copy_term(A-B, _, Goals),
    forall(member({Goal}, Goals), ( term_variables(Goal, Variables), length(Variables, 1) )).

at_end(A, V, B, W) :- findall(B, {A = V}, [W]), number(W).

%!  room_system(+Type, ?W, ?D, -Constraints) is det.
%!  piece_system(+Type, +Piece, ?L, ?D, ?Wall, -Constraints) is det.
%
%   The linear constraints that a size's clause states, as data (linear.pl).

room_system(Type, W, D, Constraints) :-
    cell(_), !,
    room_extent(Type, A, AA, B, BB),
    maplist(reasoned(size(Type)), [A =< W, W =< AA, B =< D, D =< BB], Constraints).
room_system(Type, W, D, Constraints) :-
    once(grammar:room_size(Type, W0, D0)),
    size_system([W,D], [W0,D0], size(Type), Constraints).

piece_system(Type, Piece, L, D, Wall, Constraints) :-
    cell(_), !,
    (   number(Wall)
    ->  metres(Wall, Metres), piece_range(Piece, Metres, L1, L2, D1, D2),
        rounded(L1, L2, A, AA), rounded(D1, D2, B, BB)
    ;   piece_extent(Type, Piece, A, AA, B, BB) ),
    maplist(reasoned(size(Type,Piece)), [A =< L, L =< AA, B =< D, D =< BB], Constraints).
piece_system(Type, Piece, L, D, Wall, Constraints) :-
    clause_system(Type, Piece, Sizes, Constraints),     % a table of this call, whatever the wall
    Sizes = [L,D,Wall].

clause_system(Type, Piece, Sizes, Constraints) :-
    once(grammar:piece_size(Piece, L, D, Wall)),
    size_system(Sizes, [L,D,Wall], size(Type,Piece), Constraints).

size_system(Sizes, Solved, Reason, Constraints) :-
    copy_term(Solved, Plain, Goals),
    equated(Sizes, Plain, Equations),
    phrase(described(Goals), Described),
    append(Equations, Described, All),
    maplist(reasoned(Reason), All, Constraints).

reasoned(Reason, Constraint, Constraint-[Reason]).

equated([], [], []).
equated([S|Ss], [P|Ps], Equations) :-
    ( number(P) -> Equations = [S = P|Others] ; S = P, Equations = Others ),
    equated(Ss, Ps, Others).

described([])             --> [].
described([{Goal}|Goals]) --> conjuncts(Goal), described(Goals).

conjuncts((A,B)) --> !, conjuncts(A), conjuncts(B).
conjuncts(A >= B) --> !, [B =< A].
conjuncts(A > B)  --> !, [B =< A].
conjuncts(A < B)  --> !, [A =< B].
conjuncts(A =:= B) --> !, [A = B].
conjuncts(C)      --> [C].

% - reports ------------------------------------------------------------------

%!  length_report(+Name, -Report) is det.
%
%   Report is the length, or says in words why it is of no use, or is null where it is not stated.

length_report(Name, Report) :-
    findall(M, stated(Name, M), Stated),
    length_judged(Stated, Report).

length_judged([], null).
length_judged([_,_|_], "is stated more than once").
length_judged([M], Metres) :- number(M), M >= 0, !, up(M, Length), metres(Length, Metres).
length_judged([_], "is not a number of metres, 0 or more").

%!  room_report(+Type, -Report) is det.
%!  piece_report(+Type, +Piece, -Report) is det.
%
%   Report lists the four extremes, or says in words why the clause is of no use, or is null without a clause.

room_report(Type, Report) :-
    report([W,D], [], grammar:room_size(Type, W, D), Report),
    ( is_list(Report) -> room_extent(Type, _, _, _, _) ; true ).

piece_report(Type, Piece, Report) :-
    (   room_range(Type, W1, W2, D1, D2)
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
judged(Sizes, _, Report) :-
    maplist(extremes, Sizes, [A,B], [AA,BB]),
    rounded(A, AA, L, LL), rounded(B, BB, D, DD),
    maplist(metres, [L,LL,D,DD], Report).

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
