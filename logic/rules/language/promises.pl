:- module(promises, [promised_metres/4]).

/** <module> The lengths and areas that houses promise: those of the grammar's clauses, whatever the grid of a house */

:- use_module(library(apply)).
:- use_module(library(lists)).
:- use_module('../answers').
:- use_module('../linear/grid').
:- use_module('../linear/linear').
:- use_module(grammar_files).
:- use_module(lengths).
:- use_module(sizes).

%!  promised_metres(+Names, +Types, +Pieces, -Json) is det.
%
%   Json gives [Name,Metres] of the lengths of these Names; [Type,Least,Most] of the stated `areas` of rooms of these Types, in square
%   metres, and the same of `wholes` with their parts; the `total` area of the house, [Least,Most] or null; [Type,Metres] of the free
%   squares; [Piece,Along,Out] of `shares`, of Pieces whose sides depend on those of the room (piece_shares/3); [Type,Other,Metres] of
%   `doors`; the thickness of `walls`, [Inner,Outer] or null. Relations of two lengths are rows/2 of linear.pl, with the first length as
%   variable 0: all rows of the width and the depth of the `house`, and [Name,Rows] of the width and the depth of `rooms` and of the
%   length and the depth of Pieces.

promised_metres(Names, Types, Pieces, Json) :-
    findall([N,M], ( member(N, Names), once(stated_length(N, M)) ), Lengths),
    findall([T,Least,Most], ( member(T, Types), stated_area(room_area(T, Least, Most), Least, Most) ), Areas),
    findall([T,Least,Most], ( member(T, Types), stated_area(whole_area(T, Least, Most), Least, Most) ), Wholes),
    findall([T,M], ( member(T, Types), once(turning_side(T, M)), number(M) ), Turning),
    findall([T,U,M], ( clause(grammar:door_width(T,U,M), true), ground(T-U-M), number(M) ), Doors),
    findall([T,Rows], ( member(T, Types), both_rows(room_size(T, A, B), A, B, Rows) ), Rooms),
    findall([P,Rows], ( member(P, Pieces), piece_rows(P, Rows) ), Sizes),
    findall([P,Along,Out], ( member(P, Pieces), piece_shares(P, Along, Out) ), Shares),
    total_stated(Total),
    walls_stated(Walls),
    house_rows(House),
    as_json(_{lengths:Lengths, areas:Areas, wholes:Wholes, total:Total, turning:Turning, walls:Walls, doors:Doors,
              shares:Shares, house:House, rooms:Rooms, pieces:Sizes}, Json).

stated_area(Head, Least, Most) :- once(grammar:Head), number(Least), number(Most).

%   total_stated(-Total), walls_stated(-Walls): null where nothing is stated. They are predicates of their own so that they share no
%   variable with a template of findall/3 above.

total_stated([Least,Most]) :- stated_area(house_area(Least, Most), Least, Most), !.
total_stated(null).

walls_stated([Inner,Outer]) :- maplist(stated_length, [inner_wall,outer_wall], [Inner,Outer]), number(Inner), number(Outer), Inner > 0, !.
walls_stated(null).

house_rows(Rows) :- size_rows(house_size(W, D), W, D, Rows), !.
house_rows([]).

%   piece_rows(+Piece, -Rows) is semidet: fails for a piece with several clauses, as the wall decides which one holds.

piece_rows(Piece, Rows) :-
    findall(x, clause(grammar:piece_size(Piece,_,_,_), _), [_]),
    given_walls(Piece, _-_, Walls),
    both_rows(piece_size(Piece, L, D, Walls), L, D, Rows).

%   piece_shares(+Piece, -Along, -Out) is semidet: Along is [Least,Most], the fractions of the wall between which the piece's length lies, and Out
%   those of the room's other side for its depth; null where its clause states none. Fails for a piece with several clauses, or without any.

piece_shares(Piece, Along, Out) :-
    findall(x, clause(grammar:piece_size(Piece,_,_,_), _), [_]),
    given_walls(Piece, Wall-Across, Given),
    Head = piece_size(Piece, L, D, Given),
    share(Head, L, Wall, Along),
    share(Head, D, Across, Out),
    [Along,Out] \== [null,null].

%   share(+Head, ?Side, ?Whole, -Share): a row F*Side + G*Whole =< 0 bounds Side by the fraction -G/F of Whole. Without a lower bound the least
%   is 0, without an upper one the most is 1, as no piece is longer than its wall. Rows with a constant state no fraction.

share(Head, Side, Whole, [Least,Most]) :-
    both_rows(Head, Side, Whole, Rows),
    findall(B, bound(least, Rows, B), Lows),
    findall(B, bound(most, Rows, B), Highs),
    [Lows,Highs] \== [[],[]], !,
    max_list([0.0|Lows], Least),
    min_list([1.0|Highs], Most).
share(_, _, _, null).

bound(Which, Rows, Fraction) :-
    member([[[0,F],[1,G]],Constant,Relation], Rows), abs(Constant) < 1.0e-9,
    bounds(Relation, F, Which),
    Fraction is -G/F.

bounds("=", _, _).
bounds("=<", F, Which) :- ( F > 0 -> Which = most ; Which = least ).

%   both_rows(+Head, ?A, ?B, -Rows) is semidet: the rows that have both lengths, at least one. Fails on a grid, where each length is
%   rounded by itself.

both_rows(Head, A, B, Rows) :- \+ on_grid, size_rows(Head, A, B, All), include(of_both, All, Rows), Rows = [_|_].

of_both([[_,_],_,_]).

%   size_rows(+Head, ?A, ?B, -Rows) is semidet: Rows are the relations of A and B that the clause of this Head states.

size_rows(Head, A, B, Rows) :-
    sized(Head),
    projected_system([V,W], [A,B], stated, System),
    rows([(V =< V)-first,(W =< W)-second|System], [_,_|Rows]).
