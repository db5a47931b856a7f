"""Cells of a house, and the lists of each in a block of words: what the continuous and the free backend have.

A header says where the house's cells are in ``indices``, at ``FIRST_CELL``, ``COLUMNS`` and ``ROWS``; what
else stands in it, and which lists there are, is the backend's: see their ``layout``.
"""

from sim.runtime import ti

CELL = 1.0
"""Metres: the side of a cell. Smaller ones make shorter lists, and more of them."""

HEADER = 9
"""Words of a house's header."""

FIRST_CELL, COLUMNS, ROWS = 5, 6, 7

LONGEST = 2**16 - 1
"""Of a cell's lists together: they are counted in 16 bits."""

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
def half_word(words: ti.template(), first, k):
    """The k-th number of 16 bits from a word on."""
    return (words[first + (k >> 1)] >> ((k & 1) << 4)) & 0xFFFF


@ti.func
def end_of(indices: ti.template(), block, k):
    """How many numbers a cell's lists have before the k-th."""
    return half_word(indices, block, k)
