"""Computation of the free backend's lists on the device.

A cell's lists have the solids that bodies in the cell may touch, and the lines that eyes in it may see.
"""

from functools import cache
from typing import Any

import numpy as np

from vitruvius.sim.backends.blocks import (
    COLUMNS,
    FIRST_CELL,
    HEADER,
    ROWS,
    empty_blocks,
    end_of,
    mark,
    marked,
    put,
)
from vitruvius.sim.backends.free.layout import ENDS, LINES, LISTS, SECTORS, SOLIDS
from vitruvius.sim.backends.free.relevance import Relevance
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti


def listed_arrays(
    numbers: np.ndarray, header: np.ndarray, used: np.ndarray, config: Config
) -> tuple[Array, Array]:
    """Return the two arrays of a bank, with its lists.

    ``numbers`` (n,) has the numbers of the bank, ``header`` (H, 9) the header of each house. ``used`` (c,)
    bool is True for the cells of all houses that a body may be in. Raises ``ValueError`` for a house with too
    many lines or solids.
    """
    sizes = header[:, COLUMNS] * header[:, ROWS]
    owner, place = np.repeat(np.arange(len(header)), sizes), np.concatenate([*map(np.arange, sizes)])
    house, place = owner[used], place[used]
    columns = header[house, COLUMNS]
    cells = np.column_stack([house, place % columns, place // columns]).astype(np.int32)
    arrays = {
        "numbers": Array.of(numbers),
        "header": Array.of(header.ravel()),
        "cells": Array.of(cells.ravel()),
        "visible": Array(ti.i32, len(cells) * (int(header[:, LINES].max()) // 32 + 1)),
        "nearby": Array(ti.i32, len(cells) * (int(header[:, SOLIDS].max()) // 32 + 1)),
        "counts": Array(ti.i32, len(cells) * LISTS),
    }
    find, fill = _kernels(start(), config)
    Launch(find, arrays)()
    counts, most = (
        arrays["counts"].numpy().reshape(-1, LISTS),
        np.maximum(header[:, SOLIDS], header[:, LINES]),
    )
    arrays["indices"] = Array.of(empty_blocks(header, most, owner, used, counts))
    Launch(fill, arrays)()
    return arrays["numbers"], arrays["indices"]


@cache
def _kernels(program: Any, config: Config) -> tuple[Any, Any]:
    """Return a kernel that finds and counts the visible lines of each cell, and one that fills the lists."""
    relevance = Relevance(config)

    @kernel
    def find(numbers: Floats, header: Ints, cells: Ints, visible: Ints, nearby: Ints, counts: Ints):
        for c in range(cells.shape[0] // 3):
            words = visible.shape[0] // (cells.shape[0] // 3)
            here = c * (nearby.shape[0] // (cells.shape[0] // 3))
            at, cell = HEADER * cells[3 * c], relevance.square(numbers, cells, c)
            # touch
            for k in range(header[at + SOLIDS]):
                solid = relevance.solid(numbers, header, at, k)
                counts[c * LISTS] += ti.cast(relevance.near(solid, cell), ti.i32)
                if relevance.in_range(solid, cell):
                    mark(nearby, here, k)
            # see
            for k in range(header[at + LINES]):
                line = relevance.line(numbers, header, at, k)
                if relevance.seen(numbers, header, nearby, here, at, line, cell):
                    mark(visible, c * words, k)
                    kind = relevance.kind_of(header, at, k)
                    for sector in range(SECTORS):
                        counts[c * LISTS + 1 + 3 * sector + kind] += relevance.ahead(sector, line, cell)

    @kernel
    def fill(numbers: Floats, header: Ints, cells: Ints, visible: Ints, indices: Ints):
        for c in range(cells.shape[0] // 3):
            words = visible.shape[0] // (cells.shape[0] // 3)
            at, cell = HEADER * cells[3 * c], relevance.square(numbers, cells, c)
            place = cells[3 * c + 2] * header[at + COLUMNS] + cells[3 * c + 1]
            block = indices[header[at + FIRST_CELL] + place]
            first, free = block + ENDS, ti.Vector([0 for _ in range(LISTS)])
            for k in ti.static(range(LISTS)):
                free[k] = end_of(indices, block, k)
            # touch
            for k in range(header[at + SOLIDS]):
                if relevance.near(relevance.solid(numbers, header, at, k), cell):
                    put(indices, first, free[0], k)
                    free[0] += 1
            # see
            for k in range(header[at + LINES]):
                if marked(visible, c * words, k):
                    line = relevance.line(numbers, header, at, k)
                    for sector in range(SECTORS):
                        if relevance.ahead(sector, line, cell):
                            row = 1 + 3 * sector + relevance.kind_of(header, at, k)
                            put(indices, first, free[row], k)
                            free[row] += 1

    return find, fill
