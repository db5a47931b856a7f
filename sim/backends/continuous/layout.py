"""Data layout of the continuous backend: boxes and lines, and for each cell lists of the relevant ones.

A house is divided into cells of ``CELL`` metres. Each cell has a list of the boxes that a body in it may
touch by one action. For each heading it has two lists of the lines that an eye in it may see: lines across x,
and lines across y. A list omits only what is certainly irrelevant: lines out of range, out of the field of
view, facing away, or hidden behind one wall from every place of the cell. So results are exact, and a step
tests about a sixth of a house.

    numbers   H x (west, north) | boxes (west, north, east, south) | lines (at, middle, half, kind), where
              half of a line's length is more by ``OVERLAP`` | by house: the floor and where a body
              astride a room's boundary must be, then each room and its door (x, y, half width, half height)
    indices   H x header | for each cell where its block is | blocks; all cells out of doors share the first
    header    first box, boxes, first piece, floor, rooms, first cell, columns, rows, first line
    block     how many numbers the lists have up to the end of each | lists; numbers of 16 bits, two in each
"""

from collections.abc import Mapping

import numpy as np

from vitruvius.sim.backends.blocks import CELL, COLUMNS, FIRST_CELL, HEADER, half_word
from vitruvius.sim.runtime import ti

FIRST_BOX, BOXES, FIRST_PIECE, FLOOR, ROOMS = range(FIRST_CELL)
FIRST_LINE = HEADER - 1

LISTS = 17
"""Number of a cell's lists: near boxes, then for each heading the lines across x and the lines across y."""

ENDS = LISTS // 2 + 1
"""Number of words of a block before its lists."""


@ti.func
def listed(indices: ti.template(), block, k):
    """Return the k-th number in a cell's lists."""
    return half_word(indices, block + ENDS, k)


def lines_listed(tables: Mapping[str, np.ndarray], house: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Return the number of lines (E,) int that a look tests.

    The lines are those listed for the cell and the heading of an eye, at each of the poses (E, 3) in houses
    (E,). ``tables``: ``numbers`` and ``indices`` of a bank.
    """
    indices = tables["indices"]
    header = indices[: HEADER * (house.max() + 1)].reshape(-1, HEADER)[house]
    corner = np.column_stack([tables["numbers"][2 * house], tables["numbers"][2 * house + 1]])
    column, row = ((pose[:, :2] - corner) / CELL).astype(int).T
    block = indices[header[:, FIRST_CELL] + row * header[:, COLUMNS] + column]
    first = 1 + 2 * np.round(pose[:, 2] / (np.pi / 4)).astype(int) % 16
    ends = indices.view(np.uint16)
    return ends[2 * block + first + 2].astype(int) - ends[2 * block + first]
