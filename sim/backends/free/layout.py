"""Houses as the free backend holds them: solids that bodies meet, lines that rays meet, and lists of them.

A house is divided into cells of ``CELL`` metres. Each has a list of the solids that a body in it may touch in
one step, and for each of ``SECTORS`` of headings three lists of the lines that an eye in it may see: those
across x, those across y, and those at an angle. A list leaves out only what it surely may.

    numbers   H x (west, north) | by house: solids (x, y, east, south, half length, half width), with the unit
              vector of the length; lines (x, y, east, south, half, kind), where half of the length is more by
              ``OVERLAP``, and the kind is negative where both sides can be seen
    indices   H x header | for each cell where its block is | blocks; cells without lists share the first
    header    first solid, solids, first line, lines, those across x, first cell, columns, rows, those
              across x or y
    block     how many numbers the lists have up to the end of each | lists; numbers of 16 bits, two in each
"""

from sim.backends.blocks import FIRST_CELL, HEADER, half_word
from sim.runtime import ti

SECTORS = 8
"""Of headings: a list is for those within half a sector of its own."""

ROW = 6
"""Numbers of a solid, and of a line."""

FIRST_SOLID, SOLIDS, FIRST_LINE, LINES, ACROSS_X = range(FIRST_CELL)
ACROSS = HEADER - 1

LISTS = 1 + 3 * SECTORS
"""A cell's lists: near solids, then for each sector the lines across x, across y and at an angle."""

ENDS = LISTS // 2 + 1
"""Words of a block before its lists."""


@ti.func
def listed(indices: ti.template(), block, k):
    """The k-th number in a cell's lists."""
    return half_word(indices, block + ENDS, k)
