"""Houses on a grid as cells: walls lie on the edges of cells, furniture fills cells."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.backends.backend import PIECE, WALL
from vitruvius.sim.geometry import TOLERANCE, Geometry, geometry

STANDS = 8
"""Bit of a cell's moves for "a body can be there", after the bits of the eight headings."""


def cell_side(houses: Sequence[House]) -> float:
    """Return the side, in metres, of the cells that houses were made for.

    If the houses state no cell, it is the side of the largest cells that fit all edges. Raises ``ValueError``
    if the houses were made for different cells.
    """
    cells = {_cell(house) for house in houses}
    if len(cells) > 1:
        raise ValueError(
            f"the houses lie on grids with different cells, {sorted(cells)} m: give houses with one cell size"
        )
    cell = cells.pop()
    if cell:
        return cell
    side = 0.0
    for house in houses:
        for lines in _edges(geometry(house)):
            for low, high in pairwise(np.unique(lines)):
                side = _common(side, high - low)
    return side


def _cell(house: House) -> float:
    """Return the side of the cells that a house states, in metres; 0 if it states none."""
    if house.occupancy:
        return house.occupancy.cell
    return house.provenance.request.get("cell", 0.0) if house.provenance else 0.0


def _common(a: float, b: float) -> float:
    """Return the greatest common divisor of two lengths (Euclid), up to the tolerance."""
    while b > TOLERANCE:
        a, b = b, a % b
        if a - b < TOLERANCE:
            b = 0.0
    return a


def _edges(shape: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Return the coordinates of edges, along x and along y."""
    boxes = np.vstack([shape.solids, shape.rooms, shape.floor, shape.doors])
    low, high = boxes[:, :2] - boxes[:, 2:], boxes[:, :2] + boxes[:, 2:]
    x, y = np.concatenate([low, high]).T
    return x, y


def off_grid(shape: Geometry, cell: float) -> float | None:
    """Return the coordinate of the first edge off the grid, or ``None`` if all edges are on it.

    Edges on the grid are whole cells away from the house's corner.
    """
    for lines, corner in zip(_edges(shape), shape.bounds[:2], strict=True):
        steps = (lines - corner) / cell
        stray = np.abs(steps - np.round(steps)) * cell > 10 * TOLERANCE
        if stray.any():
            return float(lines[stray][0])
    return None


def middle(shape: Geometry, cell: float) -> np.ndarray:
    """Return the middle of a house's cell furthest north-west, (2,) float32."""
    west, north, _, _ = shape.bounds
    return np.array([west + cell / 2, north + cell / 2], np.float32)


class Cells:
    """A house as cells: which cells are free, and what is on their edges.

    ``size``: columns and rows. ``stands``, ``filled``: (columns, rows) bool, True if a body can be in the
    cell, and if something solid fills it. ``moves``: (columns, rows) int64, the possible moves in the cell.
    ``upright`` (columns + 1, rows) and ``level`` (columns, rows + 1) int32: the things on the edges across x,
    at the cell's west end, and across y. They are 0, ``WALL``, ``PIECE`` or the code of a named kind.
    """

    def __init__(self, shape: Geometry, cell: float, kinds: Sequence[int] | None = None) -> None:
        """Divide a house whose edges all lie on the grid: see ``off_grid``.

        ``cell``: side of a cell, metres. ``kinds``: the code on the edges of each piece, by default
        ``PIECE``.
        """
        west, north, east, south = shape.bounds
        self.side, self.corner, self.origin = cell, (west, north), middle(shape, cell)
        columns, rows = round((east - west) / cell), round((south - north) / cell)
        self.size = columns, rows
        self.upright = np.zeros((columns + 1, rows), np.int32)
        self.level = np.zeros((columns, rows + 1), np.int32)
        # Coordinates from the house itself: those computed from a corner would be rounded differently.
        self.lines = west + cell * np.arange(columns + 1), north + cell * np.arange(rows + 1)
        inside, self.filled = np.zeros((columns, rows), bool), np.zeros((columns, rows), bool)
        for box in [shape.floor, *shape.rooms, *shape.doorways]:
            x, y, x_end, y_end = self._span(box)
            inside[x:x_end, y:y_end] = True
        kinds = kinds or [PIECE] * len(shape.pieces) + [WALL] * len(shape.blocks)
        for box, kind in zip([*shape.pieces, *shape.blocks], kinds, strict=True):
            x, y, x_end, y_end = self._span(box)
            self.filled[x:x_end, y:y_end] = True
            self.upright[[x, x_end], y:y_end] = kind
            self.level[x:x_end, [y, y_end]] = kind
        for box in shape.filled:
            x, y, x_end, y_end = self._span(box)
            self.filled[x:x_end, y:y_end] = True
        for box in shape.verticals:
            x, y, _, y_end = self._span(box)
            self.upright[x, y:y_end] = WALL
        for box in shape.horizontals:
            x, y, x_end, _ = self._span(box)
            self.level[x:x_end, y] = WALL
        self.stands = inside & ~self.filled
        self.moves = self._moves()

    def _span(self, box: np.ndarray) -> tuple[int, int, int, int]:
        """Return a box (x, y, half width, half height), metres, in cells: (west, north, east, south)."""
        low = np.round((box[:2] - box[2:] - self.corner) / self.side).astype(int)
        high = np.round((box[:2] + box[2:] - self.corner) / self.side).astype(int)
        for axis in range(2):
            ends = box[axis] - box[axis + 2], box[axis] + box[axis + 2]
            self.lines[axis][[low[axis], high[axis]]] = ends
        return low[0], low[1], high[0], high[1]

    def _moves(self) -> np.ndarray:
        """Return the possible moves in each cell (columns, rows): bits of the open headings, and ``STANDS``.

        A diagonal step needs both cells beside its path, and no wall in between.
        """
        # go[d][i, j]: from a cell to its neighbour east, north, west or south.
        columns, rows = self.size
        free = np.pad(self.stands, 1)
        go = []
        for east, south in HEADINGS[::2]:
            there = free[1 + east : 1 + east + columns, 1 + south : 1 + south + rows]
            if east:
                edge = self.upright[1:] if east > 0 else self.upright[:-1]
            else:
                edge = self.level[:, 1:] if south > 0 else self.level[:, :-1]
            go.append(self.stands & there & (edge == 0))
        moves = self.stands.astype(np.int64) << STANDS | self.stands.astype(np.int64) << (STANDS + 1)
        for heading in range(8):
            if heading % 2 == 0:
                open_ = go[heading // 2]
            else:
                one, two = heading // 2, (heading // 2 + 1) % 4
                open_ = (
                    go[one]
                    & _after(go[two], HEADINGS[2 * one])
                    & go[two]
                    & _after(go[one], HEADINGS[2 * two])
                )
            moves |= open_.astype(np.int64) << heading
        return moves


def _after(go: np.ndarray, step: tuple[int, int]) -> np.ndarray:
    """Return a table of cells as read from the neighbour one ``step`` away, False outside."""
    columns, rows = go.shape
    around = np.pad(go, 1)
    return around[1 + step[0] : 1 + step[0] + columns, 1 + step[1] : 1 + step[1] + rows]
