"""Cells of a house with a block of lists for each cell, shared by the continuous and the free backend.

A header has the position of the house's cells in ``indices``, at ``FIRST_CELL``, ``COLUMNS`` and ``ROWS``.
The other entries of the header and the lists are specific to a backend: see its ``layout``.
"""

from vitruvius.sim.runtime import ti

CELL = 1.0
"""Side of a cell, in metres. Smaller cells have shorter lists, but there are more of them."""

HEADER = 9
"""Number of words in a house's header."""

FIRST_CELL, COLUMNS, ROWS = 5, 6, 7

LONGEST = 2**16 - 1
"""Largest total length of a cell's lists, because lengths have 16 bits."""

LINE, AHEAD = 16, 64
"""Words of a cache line, and words at the beginning of a block that are prefetched. The array has as many
words after the last block."""


@ti.func
def cell_of(numbers: ti.template(), indices: ti.template(), house, place):
    """Return the position in ``indices`` of the block of a place's cell."""
    header = house * HEADER
    columns, rows = indices[header + COLUMNS], indices[header + ROWS]
    x = ti.cast((place[0] - numbers[2 * house]) * ti.static(1 / CELL), ti.i32)
    y = ti.cast((place[1] - numbers[2 * house + 1]) * ti.static(1 / CELL), ti.i32)
    x, y = ti.max(0, ti.min(columns - 1, x)), ti.max(0, ti.min(rows - 1, y))
    return indices[indices[header + FIRST_CELL] + y * columns + x]


@ti.func
def half_word(words: ti.template(), first, k):
    """Return the k-th number of 16 bits, counted from a word on."""
    return (words[first + (k >> 1)] >> ((k & 1) << 4)) & 0xFFFF


@ti.func
def end_of(indices: ti.template(), block, k):
    """Return the total length of a cell's lists before the k-th."""
    return half_word(indices, block, k)


@ti.func
def put(words: ti.template(), first, k, number):
    """Write the k-th number of 16 bits after the start of a word. Its bits must be 0."""
    words[first + (k >> 1)] |= number << ((k & 1) << 4)


@ti.func
def mark(words: ti.template(), first, k):
    """Set the k-th bit after the start of a word."""
    words[first + k // 32] |= 1 << (k & 31)


@ti.func
def marked(words: ti.template(), first, k):
    """Return the k-th bit after the start of a word."""
    return words[first + k // 32] >> (k & 31) & 1
