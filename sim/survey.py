# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""What a body can do at each place of a lattice, by the very arithmetic of its moves."""

from functools import cache
from typing import Any

import numpy as np

from sim.backend import Backend, Bank, Lattice
from sim.runtime import Array, Launch, start, ti

STRAIGHT, DIAGONAL = 1 << 8, 1 << 9
"""Bits of a survey: the body can be at this place with a heading along an axis, on a diagonal."""

Numbers, Indices = ti.types.ndarray(ti.f32, 1), ti.types.ndarray(ti.i32, 1)


def survey(backend: Backend, bank: Bank, houses: list[int], lattices: list[Lattice]) -> list[np.ndarray]:
    """What the body can do at each place of lattices over some houses: (X, Y) uint16 for each.

    Bit h: ``forward`` at heading h is not blocked; bits 8 and 9: ``STRAIGHT`` and ``DIAGONAL``.
    """
    columns = [lattice.shape[0] for lattice in lattices]
    sizes = np.array([lattice.shape[0] * lattice.shape[1] for lattice in lattices])
    ends = np.concatenate([[0], sizes.cumsum()])
    rows = [
        (house, *lattice.first, lattice.shape[1], end)
        for house, lattice, end in zip(houses, lattices, ends, strict=False)
    ]
    # A task for each column: which lattice it is of, and its number there.
    tasks = np.column_stack(
        [np.repeat(np.arange(len(lattices)), columns), np.concatenate([*map(np.arange, columns)])]
    )
    arrays = {
        "numbers": bank.numbers,
        "indices": bank.indices,
        "origins": Array.of(np.concatenate([lattice.origin for lattice in lattices]).astype(np.float32)),
        "rows": Array.of(np.array(rows, np.int32).ravel()),
        "tasks": Array.of(tasks.astype(np.int32).ravel()),
        "table": Array(ti.u16, int(ends[-1])),
    }
    Launch(_kernel(start(), backend), arrays)()
    table = arrays["table"].numpy()
    return [
        table[first:last].reshape(lattice.shape)
        for first, last, lattice in zip(ends, ends[1:], lattices, strict=False)
    ]


@cache
def _kernel(program: Any, backend: Backend) -> Any:
    @ti.kernel
    def run(
        numbers: Numbers,
        indices: Indices,
        origins: Numbers,
        rows: Indices,
        tasks: Indices,
        table: ti.types.ndarray(ti.u16, 1),
    ):
        for task in range(tasks.shape[0] // 2):
            k = tasks[2 * task]
            house, i, j, count, at = (
                rows[5 * k], rows[5 * k + 1] + tasks[2 * task + 1], rows[5 * k + 2],
                rows[5 * k + 3], rows[5 * k + 4],
            )  # fmt: skip
            origin = ti.Vector([origins[2 * k], origins[2 * k + 1]])
            for row in range(count):
                ways = 0
                for heading in range(2):
                    cell = ti.Vector([i, j + row, heading])
                    ways |= backend.stands(numbers, indices, house, origin, cell) << (8 + heading)
                for heading in range(8):
                    cell = ti.Vector([i, j + row, heading])
                    _, blocked = backend.move(numbers, indices, house, origin, cell, 2)
                    ways |= (1 - blocked) << heading
                table[at + tasks[2 * task + 1] * count + row] = ti.cast(ways, ti.u16)

    return run
