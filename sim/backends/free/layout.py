"""Houses as the free backend holds them: solids that bodies meet, lines that rays meet, and lists of them.

A house is divided into cells of ``CELL`` metres. Each has a list of the solids that a body in it may touch in
one step, and for each of ``SECTORS`` of headings three lists of the lines that an eye in it may see: those
across x, those across y, and those at an angle. A list leaves out only what it surely may.

    numbers   H x (west, north) | by house: solids (x, y, east, south, half length, half width), with the unit
              vector of the length; lines (x, y, east, south, half, kind), where half of the length is more by
              ``OVERLAP``, and the kind is negative where both sides can be seen
    indices   H x header | for each cell where its block is | blocks; cells without lists share the first
    header    first solid, solids, first line, lines, those across x, those across x or y, first cell,
              columns, rows
    block     how many numbers the lists have up to the end of each | lists; numbers of 16 bits, two in each
"""

from sim.runtime import ti

CELL = 1.0
"""Metres: the side of a cell."""

SECTORS = 8
"""Of headings: a list is for those within half a sector of its own."""

ROW = 6
"""Numbers of a solid, and of a line."""

HEADER = 9
FIRST_SOLID, SOLIDS, FIRST_LINE, LINES, ACROSS_X, ACROSS, FIRST_CELL, COLUMNS, ROWS = range(HEADER)

LISTS = 1 + 3 * SECTORS
"""A cell's lists: near solids, then for each sector the lines across x, across y and at an angle."""

ENDS = LISTS // 2 + 1
"""Words of a block before its lists."""

LINE, AHEAD = 16, 64
"""Words of a cache line, and of a block's beginning that is prefetched; the last block, too, has as many
behind it."""


@ti.func
def cell_of(numbers: ti.template(), indices: ti.template(), house, place):
    """Where in ``indices`` the block of a place's cell is."""
    header = house * HEADER
    columns, rows = indices[header + COLUMNS], indices[header + ROWS]
    x = ti.cast((place[0] - numbers[2 * house]) * ti.static(1 / CELL), ti.i32)
    y = ti.cast((place[1] - numbers[2 * house + 1]) * ti.static(1 / CELL), ti.i32)
    x, y = ti.max(0, ti.min(columns - 1, x)), ti.max(0, ti.min(rows - 1, y))
    return indices[indices[header + FIRST_CELL] + y * columns + x]


@ti.func
def end_of(indices: ti.template(), block, k):
    """How many numbers a cell's lists have before the k-th."""
    return (indices[block + (k >> 1)] >> ((k & 1) << 4)) & 0xFFFF


@ti.func
def listed(indices: ti.template(), block, k):
    """The k-th number in a cell's lists."""
    return (indices[block + ENDS + (k >> 1)] >> ((k & 1) << 4)) & 0xFFFF
