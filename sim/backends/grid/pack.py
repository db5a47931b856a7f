"""Data layout of the grid backend: for each cell, the possible moves of a body and the hits of its rays.

Walls lie on the edges of cells and furniture fills cells. Rays are cast once, from the middle of each cell
that a body can be in and in every direction; after that they are looked up.

    numbers   for each such cell the distance in each direction, and if it is seen what is hit there
    indices   H x header | for each cell: number of its row << 10 | stands << 8 | a bit for each heading: open
    header    first cell, columns, rows
"""

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np

from vitruvius.logic import House
from vitruvius.sim.backends.backend import Bank
from vitruvius.sim.backends.body import Body
from vitruvius.sim.backends.grid.cells import Cells
from vitruvius.sim.backends.piece_kinds import codes
from vitruvius.sim.backends.rays import EXACT, OVERLAP, Rays, directions
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import geometry
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, start, ti

HEADER = 3
FIRST_CELL, COLUMNS, ROWS = range(HEADER)

ROW = 10
"""First bit of a cell's row number, after the bits of its moves."""

MOST_CELLS = 1 << (31 - ROW)
"""Largest number of free cells in all houses of a bank. A cell holds its number in the bits from ``ROW``
on."""


def pack(houses: Sequence[House], config: Config) -> Bank:
    """Copy houses to the device: the possible moves and the hits of rays in each cell."""
    shapes = [geometry(house) for house in houses]
    parts = [
        Cells(shape, config.step, codes(house, shape, config.kinds))
        for shape, house in zip(shapes, houses, strict=True)
    ]
    header = np.zeros((len(parts), HEADER), np.int32)
    cells, row, at = [], 0, header.size
    for k, part in enumerate(parts):
        header[k] = at, *part.size
        stands = part.stands.T.ravel()  # row by row, the order of look-ups
        numbers = row + np.cumsum(stands) - 1
        cells.append(np.where(stands, part.moves.T.ravel() | numbers << ROW, 0))
        row, at = row + int(stands.sum()), at + stands.size
    if row > MOST_CELLS:
        raise ValueError(
            f"these houses have {row:,} free cells, more than the grid backend's {MOST_CELLS:,}: use fewer"
        )
    indices = np.concatenate([header.ravel(), *cells]).astype(np.int32)
    count = len(directions(config))
    arrays = {
        "numbers": Array(ti.f32, row * count * (1 + config.notes_hits)),
        "jobs": Array.of(np.concatenate([_jobs(k, part) for k, part in enumerate(parts)]).ravel()),
        "lines": Array.of(np.concatenate([line for part in parts for line in part.lines]).astype(np.float32)),
        "origins": Array.of(np.concatenate([part.origin for part in parts])),
        "houses": Array.of(_houses(parts)),
        "upright": Array.of(np.concatenate([part.upright.ravel() for part in parts])),
        "level": Array.of(np.concatenate([part.level.ravel() for part in parts])),
    }
    Launch(_kernel(start(), config), arrays)()
    return Bank(shapes, arrays["numbers"], Array.of(indices))


def _jobs(k: int, part: Cells) -> np.ndarray:
    """Return (house, column, row) of each cell that a body can be in, (n, 3) int32, in row order."""
    rows, columns = np.nonzero(part.stands.T)
    return np.column_stack([np.full(len(rows), k), columns, rows]).astype(np.int32)


def _houses(parts: list[Cells]) -> np.ndarray:
    """Return six numbers of each house, (H x 6,) int32.

    They are columns, rows, first upright edge, first level edge, and first lines along x and along y.
    """
    found = np.zeros((len(parts), 6), np.int32)
    found[:, :2] = [part.size for part in parts]
    found[1:, 2] = np.cumsum([part.upright.size for part in parts])[:-1]
    found[1:, 3] = np.cumsum([part.level.size for part in parts])[:-1]
    ends = np.cumsum([len(line) for part in parts for line in part.lines])
    found[:, 4:] = np.concatenate([[0], ends[:-1]]).reshape(-1, 2)
    return found.ravel()


@cache
def _kernel(program: Any, config: Config) -> Any:
    """Return a kernel that casts rays from the middles of cells."""
    rays, cell, furthest, notes_hits = Rays(config, 1), config.step, config.range, config.notes_hits
    body = Body(config)
    count = rays.count

    @ti.func
    def edge(edges: ti.template(), first, columns, rows, column, row):
        """Return what is on an edge; 0 outside the house."""
        kind = 0
        if column >= 0 and column < columns and row >= 0 and row < rows:
            kind = edges[first + column * rows + row]
        return kind

    @ti.kernel
    def cast(
        numbers: Floats,
        jobs: Ints,
        origins: Floats,
        lines: Floats,
        houses: Ints,
        upright: Ints,
        level: Ints,
    ):
        for job in range(jobs.shape[0] // 3):
            house, column, row = jobs[3 * job], jobs[3 * job + 1], jobs[3 * job + 2]
            at = 6 * house
            columns, rows = houses[at], houses[at + 1]
            origin = ti.Vector([origins[2 * house], origins[2 * house + 1]])
            eye = body.eye(origin, ti.Vector([column, row, 0]))
            for k in range(count):
                nearest, kind = ti.f32(furthest), 0
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
                        # The crossing, in cells; near a corner the edges of both sides count.
                        aside, slack = eye[1 - axis] + ahead * slope, ti.f32(OVERLAP / cell)
                        across = (aside - lines[houses[at + 5 - axis]]) * (1 / cell)
                        for part in ti.static((EXACT, 2 * EXACT)):  # see ``overlap``
                            if ti.max(ti.abs(ahead + eye[axis]), ti.abs(aside)) > part:
                                slack *= 2.0
                        other = ti.cast(across - slack, ti.i32)
                        after = ti.cast(across + slack, ti.i32) + 1
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
                if ti.static(notes_hits):
                    numbers[jobs.shape[0] // 3 * count + job * count + k] = ti.cast(kind, ti.f32)

    return cast
