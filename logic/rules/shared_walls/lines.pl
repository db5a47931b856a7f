:- module(lines, [lines_sample//4, lines_sample//5, places_sample//3, sampling_order/3]).

/** <module> A random solution of a plan's walls */

:- use_module(library(apply)).
:- use_module(library(assoc)).
:- use_module(library(clpr)).
:- use_module(library(clpq), []).
:- use_module(library(lists)).
:- use_module(library(pairs)).
:- use_module('../linear/exact').
:- use_module('../linear/grid').
:- use_module('../linear/linear').
:- use_module('../linear/sample').

%!  lines_sample(+Arithmetic, ?Lines, +Rooms, +System)// is semidet: every line is a number, sampled in the projection that
%   those before it leave: first the outline, then line by line from the west and from the north. Lines that are still to
%   come up to the outline share the slack, as in chain.pl. Arithmetic is real, or rational and slow.

lines_sample(Arithmetic, Lines, Rooms, System) -->
    { sampling_order(Lines, Rooms, Order) },
    lines_sample(Arithmetic, Order, System, [], []).

%!  lines_sample(+Arithmetic, ?Order, +System, +Then, ?Others)// is semidet.
%
%   Order and Others are Gaps-Place. Once those of the Order are numbers, what holds Then is linear in the Others.

lines_sample(Arithmetic, Order, System, Then, Others, S0, S) :-
    append(Order, Others, All), pairs_values(All, Places),
    lattice(Kind),
    findall(Places-S1, once(sampled(Arithmetic-Kind, System, Order, Then, Others, S0, S1)), [Found-S]),
    ( Kind == whole -> maplist(nearest_cell, Found, Places) ; Places = Found ).

%!  places_sample(+Order, +System, -Places)// is semidet: such numbers, and what is in the Order stays unknown.

places_sample(Order, System, Places, S0, S) :-
    pairs_values(Order, Xs),
    findall(Xs-S1, once(sampled(real-real, System, Order, [], [], S0, S1)), [Places-S]).

nearest_cell(X, Cell) :- ( X =:= 0 -> Cell = X ; Cell is round(X) ).

sampled(Way, System, Order, Then, Others) -->
    { stated(Way, System) }, each_sampled(Way, Order),
    { stated(Way, Then) }, each_sampled(Way, Others).

stated(real-_, System)     :- posted(System).
stated(rational-_, System) :- exactly_posted(System).

each_sampled(real-real, Order)      --> all_sampled(Order).
each_sampled(rational-real, Order)  --> exactly_sampled(Order).
each_sampled(real-whole, Order)     --> all_whole_sampled(Order, clpr).
each_sampled(rational-whole, Order) --> all_whole_sampled(Order, clpq).

all_sampled([]) --> [].
all_sampled([Gaps-X|Order]) -->
    (   { number(X) }
    ->  []
    ;   { inf(X, Low), sup(X, High) },
        interval_sample(Low, High, Gaps, V),
        { {X = V} } ),
    all_sampled(Order).

%   all_whole_sampled(+Order, +Solver)// is nondet: whole numbers, each sampled in its projection, then those next to it.

all_whole_sampled([], _) --> [].
all_whole_sampled([Gaps-X|Order], Solver) -->
    (   { number(X) }
    ->  { abs(X - round(X)) < 1.0e-6 }
    ;   { Solver:inf(X, Low), Solver:sup(X, High), First is ceiling(Low - 1.0e-6), Last is floor(High + 1.0e-6), First =< Last },
        interval_sample(First, Last, Gaps, V),
        { findall(Away-N, ( between(First, Last, N), Away is abs(N-V) ), Numbers),
          keysort(Numbers, Nearest),
          member(_-N1, Nearest),
          Solver:{X = N1} } ),
    all_whole_sampled(Order, Solver).

%!  sampling_order(+Lines, +Rooms, -Order) is semidet: Gaps-Place of the outline and then of the other lines, where Gaps is the
%   most rooms in a row between the line and the outline's east or south side. Fails where a row leads back to its line, as
%   with rules of a topology left out: such lines have no places.

sampling_order(Lines, Rooms, [1-Width,1-Depth|Order]) :-
    memberchk(outline(east)-Width, Lines), memberchk(outline(south)-Depth, Lines),
    findall(A-B, ( member(room(_,_,_,edges(edge(_,_,W),edge(_,_,E),edge(_,_,N),edge(_,_,S))), Rooms),
                   ( A = W, B = E ; A = N, B = S ) ), Steps0),
    sort(Steps0, Steps),
    findall(Line-0, member(Line-_, Lines), Zeros),
    list_to_assoc(Zeros, Gaps0),
    length(Lines, Longest),
    farthest(Longest, Steps, Gaps0, Gaps),
    findall(N-Line, ( member(Line-_, Lines), \+ Line = outline(_), get_assoc(Line, Gaps, N) ), Ranks0),
    sort(1, @>=, Ranks0, Ranks),
    maplist(ranked(Lines), Ranks, Order).

% From a line that leads to no outline there is one gap.
ranked(Lines, N-Line, Gaps-Place) :- memberchk(Line-Place, Lines), Gaps is max(1, N).

farthest(Left, Steps, Gaps0, Gaps) :-
    foldl(farther, Steps, Gaps0, Gaps1),
    ( Gaps1 == Gaps0 -> Gaps = Gaps0 ; Left > 0, Fewer is Left - 1, farthest(Fewer, Steps, Gaps1, Gaps) ).

farther(A-B, Gaps0, Gaps) :-
    get_assoc(A, Gaps0, N), get_assoc(B, Gaps0, M),
    ( M + 1 > N -> N1 is M + 1, put_assoc(A, Gaps0, N1, Gaps) ; Gaps = Gaps0 ).
