"""Houses as the grid backend holds them: for each cell what a body can do there, and what its rays hit.

Walls lie on the edges of cells and pieces fill cells. Rays are cast once, from the middle of each cell that
a body can be in and in every direction, and looked up from then on.

    numbers   for each such cell the distance in each direction, and if it is seen what is hit there
    indices   H x header | for each cell: number of its row << 10 | stands << 8 | a bit for each heading: open
    header    first cell, columns, rows
"""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from logic import House
from sim.backend import PIECE, WALL, Bank
from sim.body import HEADINGS, Body
from sim.config import Config
from sim.geometry import TOLERANCE, Geometry, geometry
from sim.rays import SEAM, Rays, directions
from sim.runtime import Array, Launch, start, ti

HEADER = 3
FIRST_CELL, COLUMNS, ROWS = range(HEADER)

STANDS, ROW = 8, 10
"""Bits of a cell: whether a body can be there; where the number of its row begins."""

Numbers, Indices = ti.types.ndarray(ti.f32, 1), ti.types.ndarray(ti.i32, 1)


def cell_side(houses: Sequence[House]) -> float:
    """The side of the cells that houses were made for, metres, or the largest that fits all their edges.

    Raises ``ValueError`` where they were made for different ones.
    """
    cells = {house.provenance.request.get("cell", 0.0) if house.provenance else 0.0 for house in houses}
    if len(cells) > 1:
        raise ValueError(f"houses on grids of different cells, {sorted(cells)} m: one bank has one")
    cell = cells.pop()
    if cell:
        return cell
    side = 0.0
    for house in houses:
        for lines in _edges(geometry(house)):
            for low, high in pairwise(np.unique(lines)):
                side = _common(side, high - low)
    return side


def _common(a: float, b: float) -> float:
    """The greatest length that both are multiples of, by Euclid; lengths within the tolerance are equal."""
    while b > TOLERANCE:
        a, b = b, a % b
        if a - b < TOLERANCE:
            b = 0.0
    return a


def _edges(shape: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Where edges lie, along x and along y."""
    boxes = np.vstack([shape.solids, shape.rooms, shape.floor, shape.doors])
    low, high = boxes[:, :2] - boxes[:, 2:], boxes[:, :2] + boxes[:, 2:]
    x, y = np.concatenate([low, high]).T
    return x, y


def off_grid(shape: Geometry, cell: float) -> float | None:
    """Where the first edge lies that is not whole cells away from the corner; ``None`` if there is none."""
    for lines, corner in zip(_edges(shape), shape.bounds[:2], strict=True):
        steps = (lines - corner) / cell
        stray = np.abs(steps - np.round(steps)) * cell > 10 * TOLERANCE
        if stray.any():
            return float(lines[stray][0])
    return None


def pack(houses: Sequence[House], config: Config) -> Bank:
    """Bring houses to the device: what can be done and seen in each cell."""
    shapes = [geometry(house) for house in houses]
    parts = [_Part(shape, config.step) for shape in shapes]
    header = np.zeros((len(parts), HEADER), np.int32)
    cells, row, at = [], 0, header.size
    for k, part in enumerate(parts):
        header[k] = at, *part.size
        stands = part.stands.T.ravel()  # a row of cells after the other, as they are looked up
        numbers = row + np.cumsum(stands) - 1
        cells.append(np.where(stands, part.moves.T.ravel() | numbers << ROW, 0))
        row, at = row + int(stands.sum()), at + stands.size
    indices = np.concatenate([header.ravel(), *cells]).astype(np.int32)
    count = len(directions(config))
    arrays = {
        "numbers": Array(ti.f32, row * count * (1 + config.sees_kind)),
        "jobs": Array.of(np.concatenate([_jobs(k, part) for k, part in enumerate(parts)]).ravel()),
        "lines": Array.of(np.concatenate([line for part in parts for line in part.lines]).astype(np.float32)),
        "origins": Array.of(np.concatenate([part.origin for part in parts])),
        "houses": Array.of(_houses(parts)),
        "upright": Array.of(np.concatenate([part.upright.ravel() for part in parts])),
        "level": Array.of(np.concatenate([part.level.ravel() for part in parts])),
    }
    Launch(_kernel(start(), config), arrays)()
    return Bank(shapes, arrays["numbers"], Array.of(indices))


def middle(shape: Geometry, cell: float) -> np.ndarray:
    """The middle of a house's cell furthest north-west, (2,) float32."""
    west, north, _, _ = shape.bounds
    return np.array([west + cell / 2, north + cell / 2], np.float32)


class _Part:
    """A house as cells: which are free, and what is on their edges."""

    def __init__(self, shape: Geometry, cell: float) -> None:
        west, north, east, south = shape.bounds
        self.corner, self.origin = (west, north), middle(shape, cell)
        columns, rows = round((east - west) / cell), round((south - north) / cell)
        self.size = columns, rows
        # Edges across x, at their west end, and across y: 0, WALL or PIECE.
        self.upright = np.zeros((columns + 1, rows), np.int32)
        self.level = np.zeros((columns, rows + 1), np.int32)
        # Where they lie, as the house says it: what is computed from a corner would be rounded otherwise.
        self.lines = west + cell * np.arange(columns + 1), north + cell * np.arange(rows + 1)
        inside, filled = np.zeros((columns, rows), bool), np.zeros((columns, rows), bool)

        def span(box: np.ndarray) -> tuple[int, int, int, int]:
            low = np.round((box[:2] - box[2:] - self.corner) / cell).astype(int)
            high = np.round((box[:2] + box[2:] - self.corner) / cell).astype(int)
            for axis in range(2):
                self.lines[axis][[low[axis], high[axis]]] = (
                    box[axis] - box[axis + 2],
                    box[axis] + box[axis + 2],
                )
            return low[0], low[1], high[0], high[1]

        for box in [shape.floor, *shape.rooms]:
            x, y, x_end, y_end = span(box)
            inside[x:x_end, y:y_end] = True
        for box in shape.pieces:
            x, y, x_end, y_end = span(box)
            filled[x:x_end, y:y_end] = True
            self.upright[[x, x_end], y:y_end] = PIECE
            self.level[x:x_end, [y, y_end]] = PIECE
        for box in shape.verticals:
            x, y, _, y_end = span(box)
            self.upright[x, y:y_end] = WALL
        for box in shape.horizontals:
            x, y, x_end, _ = span(box)
            self.level[x:x_end, y] = WALL
        self.stands = inside & ~filled
        self.moves = self._moves()

    def _moves(self) -> np.ndarray:
        """What a body can do in each cell (columns, rows): bits of the headings that are open, and STANDS.

        On a diagonal it needs both cells beside its path, and no wall in between.
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


def _after(go: np.ndarray, step: np.ndarray) -> np.ndarray:
    """A table of cells as read from the neighbour one ``step`` away, False outside."""
    columns, rows = go.shape
    around = np.pad(go, 1)
    return around[1 + step[0] : 1 + step[0] + columns, 1 + step[1] : 1 + step[1] + rows]


def _jobs(k: int, part: _Part) -> np.ndarray:
    """(n, 3) int32: house, column and row of each cell that a body can be in, in the order of their rows."""
    rows, columns = np.nonzero(part.stands.T)
    return np.column_stack([np.full(len(rows), k), columns, rows]).astype(np.int32)


def _houses(parts: list[_Part]) -> np.ndarray:
    """(H x 6,) int32: columns, rows, where its upright and its level edges begin, and lines along x and y."""
    found = np.zeros((len(parts), 6), np.int32)
    found[:, :2] = [part.size for part in parts]
    found[1:, 2] = np.cumsum([part.upright.size for part in parts])[:-1]
    found[1:, 3] = np.cumsum([part.level.size for part in parts])[:-1]
    ends = np.cumsum([len(line) for part in parts for line in part.lines])
    found[:, 4:] = np.concatenate([[0], ends[:-1]]).reshape(-1, 2)
    return found.ravel()


@cache
def _kernel(program: Any, config: Config) -> Any:
    """A kernel that casts rays from the middles of cells."""
    rays, cell, reach, sees_kind = Rays(config, 1), config.step, config.range, config.sees_kind
    body = Body(config)
    count = rays.count

    @ti.func
    def edge(edges: ti.template(), first, columns, rows, column, row):
        """What is on an edge; nothing outside."""
        kind = 0
        if column >= 0 and column < columns and row >= 0 and row < rows:
            kind = edges[first + column * rows + row]
        return kind

    @ti.kernel
    def cast(
        numbers: Numbers,
        jobs: Indices,
        origins: Numbers,
        lines: Numbers,
        houses: Indices,
        upright: Indices,
        level: Indices,
    ):
        for job in range(jobs.shape[0] // 3):
            house, column, row = jobs[3 * job], jobs[3 * job + 1], jobs[3 * job + 2]
            at = 6 * house
            columns, rows = houses[at], houses[at + 1]
            origin = ti.Vector([origins[2 * house], origins[2 * house + 1]])
            eye = body.eye(origin, ti.Vector([column, row, 0]))
            for k in range(count):
                nearest, kind = ti.f32(reach), 0
                for axis in ti.static(range(2)):
                    over, slope = rays.table[2 * axis * count + k], rays.table[(2 * axis + 1) * count + k]
                    place, last = (column, columns) if ti.static(axis == 0) else (row, rows)
                    sign = ti.select(over > 0, 1, -1)
                    line = place + ti.select(over > 0, 1, 0)
                    searching = 1
                    while searching and line >= 0 and line <= last:
                        ahead = lines[houses[at + 4 + axis] + line] - eye[axis]
                        distance = ahead * over
                        searching = ti.cast(distance < nearest, ti.i32)
                        # Where it crosses, in cells; near a corner the edges of both sides count.
                        across = (eye[1 - axis] + ahead * slope - lines[houses[at + 5 - axis]]) * (1 / cell)
                        other = ti.cast(across - ti.static(SEAM / cell), ti.i32)
                        after = ti.cast(across + ti.static(SEAM / cell), ti.i32) + 1
                        while searching and other < after:
                            met = 0
                            if ti.static(axis == 0):
                                met = edge(upright, houses[at + 2], columns + 1, rows, line, other)
                            else:
                                met = edge(level, houses[at + 3], columns, rows + 1, other, line)
                            if met != 0 and (distance < nearest or met < kind):
                                nearest, kind, searching = distance, met, 0
                            other += 1
                        line += sign
                numbers[job * count + k] = nearest
                if ti.static(sees_kind):
                    numbers[jobs.shape[0] // 3 * count + job * count + k] = ti.cast(kind, ti.f32)

    return cast
