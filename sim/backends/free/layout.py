"""Data layout of the free backend: solids that bodies meet, lines that rays meet, and lists of both.

A house is divided into cells of ``CELL`` metres. Each cell has a list of the solids that a body in it may
touch in one step. For each of ``SECTORS`` headings it has three lists of the lines that an eye in it may see:
lines across x, lines across y, and lines at an angle. A list omits only what is certainly irrelevant.

    numbers   H x (west, north) | by house: solids (x, y, east, south, half length, half width), with the unit
              vector of the length; lines (x, y, east, south, half, kind), where half of the length is more by
              ``OVERLAP``, and the kind is negative where both sides can be seen
    indices   H x header | for each cell where its block is | blocks; cells without lists share the first
    header    first solid, solids, first line, lines, those across x, first cell, columns, rows, those
              across x or y
    block     how many numbers the lists have up to the end of each | lists; numbers of 16 bits, two in each
"""

from vitruvius.sim.backends.blocks import FIRST_CELL, HEADER, half_word
from vitruvius.sim.runtime import ti

SECTORS = 8
"""Number of sectors of headings. A sector's lists serve the headings within half a sector of its own."""

ROW = 6
"""Number of values of a solid, and of a line."""

FIRST_SOLID, SOLIDS, FIRST_LINE, LINES, ACROSS_X = range(FIRST_CELL)
ACROSS = HEADER - 1

LISTS = 1 + 3 * SECTORS
"""Number of a cell's lists: near solids, then for each sector the lines across x, across y and at an
angle."""

ENDS = LISTS // 2 + 1
"""Number of words of a block before its lists."""


@ti.func
def listed(indices: ti.template(), block, k):
    """Return the k-th number in a cell's lists."""
    return half_word(indices, block + ENDS, k)
