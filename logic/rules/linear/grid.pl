:- module(grid, [set_cell/1, lattice/1, metres/2, in_unit/2, rounded_up/2, rounded_range/2, inner_range/2, on_grid/0]).

/** <module> Metres, or the cells of a grid

All lengths of a house are in metres, or in cells where houses stand on a grid: then fixed lengths and least ones are
rounded up, greatest ones down, and what lies between them is a whole number of cells.
*/

:- dynamic cell/1, lattice/1.

%!  lattice(-Kind) is det.
%
%   Kind is `real`, or `whole` where all lengths are whole numbers of cells.

lattice(real).

%!  set_cell(+Cell) is det.
%
%   Cell is the side of a cell in metres, or 0 for no grid. What was tabled for another cell is forgotten.

set_cell(Cell) :-
    retractall(cell(_)), retractall(lattice(_)),
    abolish_all_tables,
    ( Cell > 0 -> assertz(cell(Cell)), assertz(lattice(whole)) ; assertz(lattice(real)) ).

%!  on_grid is semidet.
%
%   Houses stand on a grid.

on_grid :- cell(_).

%!  metres(+Length, -Metres) is det.
%
%   Metres is a Length of this house, a float.

metres(Length, Metres) :- ( cell(Cell) -> Metres is Length*Cell ; Metres is float(Length) ).

%!  in_unit(+Metres, -Length) is det.
%
%   Length is the same, in the house's unit, whole or not.

in_unit(M, X) :- ( cell(Cell) -> X is M/Cell ; X = M ).

%!  rounded_up(+Metres, -Length) is det.
%
%   Length is the least of the grid that is no shorter than Metres.

rounded_up(M, X) :- ( cell(Cell) -> X is ceiling(M/Cell - 1.0e-9) ; X = M ).

%!  rounded_range(+Metres, -Range) is det.
%
%   Range is Low-High, the lengths of the grid within a range of metres; the one above it where there is none.

rounded_range(M-MM, Range) :-
    (   cell(Cell)
    ->  Low is ceiling(M/Cell - 1.0e-9), Most is floor(MM/Cell + 1.0e-9)
    ;   Low = M, Most = MM ),
    High is max(Low, Most),
    Range = Low-High.

%!  inner_range(+Range, -Inner) is det.
%
%   Inner is the part of a range of Low-High in the house's unit that the grid allows: all, or between whole cells.

inner_range(Low-High, Inner) :-
    ( on_grid -> L is ceiling(Low - 1.0e-6), H is floor(High + 1.0e-6), Inner = L-H ; Inner = Low-High ).
