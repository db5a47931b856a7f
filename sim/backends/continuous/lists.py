"""Computation of the continuous backend's lists on the device.

A cell's lists have the boxes that bodies in the cell may touch, and the lines that eyes in it may see.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.backends.blocks import (
    COLUMNS,
    FIRST_CELL,
    ROWS,
    empty_blocks,
    end_of,
    mark,
    marked,
    put,
)
from vitruvius.sim.backends.continuous.layout import BOXES, ENDS, FIRST_PIECE, LISTS
from vitruvius.sim.backends.continuous.relevance import LINES, Relevance
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti


def listed_arrays(
    numbers: np.ndarray, header: np.ndarray, lines: np.ndarray, config: Config
) -> tuple[Array, Array]:
    """Return the two arrays of a bank, with its lists.

    ``numbers`` (n,) has the numbers of the bank, ``header`` (H, 9) the header of each house, and ``lines``
    (H, 2) the number of all its lines and of those across x. Raises ``ValueError`` for a house with too many
    lines or boxes.
    """
    owner = np.repeat(np.arange(len(header)), header[:, COLUMNS] * header[:, ROWS])
    arrays = {
        "numbers": Array.of(numbers),
        "houses": Array.of(np.column_stack([header, lines]).astype(np.int32).ravel()),
        "owner": Array.of(owner.astype(np.int32)),
        "visible": Array(ti.i32, len(owner) * (int(lines[:, 0].max()) // 32 + 1)),
        "nearby": Array(ti.i32, len(owner) * (int(header[:, BOXES].max()) // 32 + 1)),
        "counts": Array(ti.i32, len(owner) * LISTS),
    }
    find, fill = _kernels(start(), config)
    Launch(find, arrays)()
    counts = arrays["counts"].numpy().reshape(-1, LISTS)
    used, most = counts.sum(axis=1) > 0, np.maximum(header[:, BOXES], lines[:, 0])
    arrays["indices"] = Array.of(empty_blocks(header, most, owner, used, counts[used]))
    Launch(fill, arrays)()
    return arrays["numbers"], arrays["indices"]


@cache
def _kernels(program: Any, config: Config) -> tuple[Any, Any]:
    """Return a kernel that finds and counts the visible lines of each cell, and one that fills the lists."""
    relevance = Relevance(config)

    @kernel
    def find(numbers: Floats, houses: Ints, owner: Ints, visible: Ints, nearby: Ints, counts: Ints):
        for c in range(owner.shape[0]):
            words, of_boxes = visible.shape[0] // owner.shape[0], nearby.shape[0] // owner.shape[0]
            at, cell = relevance.square(numbers, houses, owner, c)
            if relevance.indoors(numbers, houses, at, cell):
                # touch
                for k in range(houses[at + BOXES]):
                    box = relevance.box(houses, at, k)
                    if relevance.near(numbers, box, cell):
                        counts[c * LISTS] += 1
                    if (box < houses[at + FIRST_PIECE]) & relevance.in_range(numbers, box, cell):
                        mark(nearby, c * of_boxes, k)
                # see
                for k in range(houses[at + LINES]):
                    axis, place = relevance.axis(houses, at, k), relevance.line(houses, at, k)
                    line = relevance.line_at(numbers, place)
                    if relevance.seen(numbers, houses, nearby, c * of_boxes, at, place, line, axis, cell):
                        mark(visible, c * words, k)
                        for heading in range(8):
                            ahead = relevance.ahead(heading, line, axis, cell)
                            counts[c * LISTS + 1 + 2 * heading + axis] += ahead

    @kernel
    def fill(numbers: Floats, houses: Ints, owner: Ints, visible: Ints, counts: Ints, indices: Ints):
        for c in range(owner.shape[0]):
            words = visible.shape[0] // owner.shape[0]
            at, cell = relevance.square(numbers, houses, owner, c)
            block = indices[houses[FIRST_CELL] + c]
            first, free = block + ENDS, ti.Vector([0 for _ in range(LISTS)])
            for k in ti.static(range(LISTS)):
                free[k] = end_of(indices, block, k)
            # touch
            if counts[c * LISTS] > 0:
                for k in range(houses[at + BOXES]):
                    if relevance.near(numbers, relevance.box(houses, at, k), cell):
                        put(indices, first, free[0], k)
                        free[0] += 1
            # see
            for k in range(houses[at + LINES]):
                if marked(visible, c * words, k):
                    axis = relevance.axis(houses, at, k)
                    line = relevance.line_at(numbers, relevance.line(houses, at, k))
                    for heading in range(8):
                        if relevance.ahead(heading, line, axis, cell):
                            row = 1 + 2 * heading + axis
                            put(indices, first, free[row], k)
                            free[row] += 1

    return find, fill
