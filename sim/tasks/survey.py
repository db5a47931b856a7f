"""Possible moves of a body at each place of a lattice, computed with the backend's own moves."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.actions import FORWARD, HEADINGS
from vitruvius.sim.backends.backend import Backend, Bank, Lattice
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, Shorts, kernel, start, ti

STRAIGHT, DIAGONAL = 1 << 8, 1 << 9
"""Bits of a survey: the body can be at this place with a heading along an axis, or with a diagonal
heading."""

HOUSE, FIRST_I, FIRST_J, COLUMNS, LINES, AT = range(6)
"""Indices of a lattice's row: its house, its first place (i, j), its places east and south, and the index of
its survey."""

Rows = ti.types.ndarray(ti.types.vector(6, ti.i32), 1)


@dataclass(frozen=True)
class Survey:
    """Possible moves of a body at the places of a lattice."""

    moves: np.ndarray
    """(X, Y) uint16; bit h: ``forward`` at heading h is not blocked; then ``STRAIGHT`` and ``DIAGONAL``."""
    part: np.ndarray
    """(X, Y) int32: equal for places that moves join, if the body can be there with any heading; 0 at
    others."""


def survey(backend: Backend, bank: Bank, houses: list[int], lattices: list[Lattice]) -> list[Survey]:
    """Return surveys of lattices over some houses."""
    columns = [lattice.shape[0] for lattice in lattices]
    ends = np.cumsum([0, *(lattice.shape[0] * lattice.shape[1] for lattice in lattices)])
    rows = [
        (house, *lattice.first, *lattice.shape, end)
        for house, lattice, end in zip(houses, lattices, ends, strict=False)
    ]
    # A task for each column: its lattice, and its number in the lattice.
    tasks = [np.repeat(np.arange(len(lattices)), columns), np.concatenate([*map(np.arange, columns)])]
    arrays = {
        "numbers": bank.numbers,
        "indices": bank.indices,
        "origins": Array.of(np.concatenate([lattice.origin for lattice in lattices]).astype(np.float32)),
        "rows": Array(ti.i32, len(rows), 6),
        "tasks": Array.of(np.stack(tasks, axis=1).astype(np.int32).ravel()),
        "moves": Array(ti.u16, int(ends[-1])),
        "part": Array(ti.i32, int(ends[-1])),
        "stack": Array(ti.i32, int(ends[-1])),
    }
    arrays["rows"].fill(np.array(rows, np.int32))
    look, join = _kernels(start(), backend)
    Launch(look, arrays)()
    Launch(join, arrays)()
    moves, part = arrays["moves"].numpy(), arrays["part"].numpy()
    return [
        Survey(moves[first:last].reshape(lattice.shape), part[first:last].reshape(lattice.shape))
        for first, last, lattice in zip(ends, ends[1:], lattices, strict=False)
    ]


@cache
def _kernels(program: Any, backend: Backend) -> tuple[Any, Any]:
    """Return a kernel that finds the possible moves, and one that joins the places."""
    anywhere = STRAIGHT | DIAGONAL

    @kernel
    def look(numbers: Floats, indices: Ints, origins: Floats, rows: Rows, tasks: Ints, moves: Shorts):
        for task in range(tasks.shape[0] // 2):
            k, column = tasks[2 * task], tasks[2 * task + 1]
            row = rows[k]
            at = row[AT] + column * row[LINES]
            origin = ti.Vector([origins[2 * k], origins[2 * k + 1]])
            for line in range(row[LINES]):
                i, j, found = row[FIRST_I] + column, row[FIRST_J] + line, 0
                for heading in range(2):
                    cell = ti.Vector([i, j, heading])
                    found |= backend.stands(numbers, indices, row[HOUSE], origin, cell) << (8 + heading)
                for heading in range(8):
                    cell = ti.Vector([i, j, heading])
                    _, blocked = backend.move(numbers, indices, row[HOUSE], origin, cell, FORWARD)
                    found |= (1 - blocked) << heading
                moves[at + line] = ti.cast(found, ti.u16)

    @kernel
    def join(rows: Rows, moves: Shorts, part: Ints, stack: Ints):
        for k in range(rows.shape[0]):
            number, columns, count, at = 0, rows[k][COLUMNS], rows[k][LINES], rows[k][AT]
            for seed in range(columns * count):
                if moves[at + seed] & anywhere == anywhere and part[at + seed] == 0:
                    number += 1
                    part[at + seed], stack[at], height = number, seed, 1
                    while height > 0:
                        height -= 1
                        place = stack[at + height]
                        for heading in ti.static(range(8)):
                            i = place // count + ti.static(HEADINGS[heading][0])
                            j = place % count + ti.static(HEADINGS[heading][1])
                            open_ = moves[at + place] >> heading & 1 != 0
                            if open_ and i >= 0 and i < columns and j >= 0 and j < count:
                                there = at + i * count + j
                                if moves[there] & anywhere == anywhere and part[there] == 0:
                                    part[there], stack[at + height] = number, i * count + j
                                    height += 1

    return look, join
