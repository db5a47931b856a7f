"""Cells of a house with a block of lists for each cell, shared by the continuous and the free backend.

A header has the position of the house's cells in ``indices``, at ``FIRST_CELL``, ``COLUMNS`` and ``ROWS``.
The other entries of the header and the lists are specific to a backend: see its ``layout``.
"""

import numpy as np

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


def empty_blocks(
    header: np.ndarray, most: np.ndarray, owner: np.ndarray, used: np.ndarray, counts: np.ndarray
) -> np.ndarray:
    """Return the array ``indices`` of a bank, with blocks whose lists are not written yet.

    ``header`` (H, 9) has the header of each house. ``most`` (H,) has the number of a house's lines, or of the
    things that bodies touch, whichever is larger. ``owner`` (C,) has the house of each cell. ``used`` (C,)
    bool is True for the cells with lists; the others share the first block. ``counts`` (c, n) has the lengths
    of the lists of each used cell. Raises ``ValueError`` for a house with too many lines or things.
    """
    sums = counts.cumsum(axis=1)
    total, before = sums[:, -1], counts.shape[1] // 2 + 1
    if max(total.max(initial=0), most.max()) > LONGEST:
        house = most.argmax() if most.max() > LONGEST else owner[used][total.argmax()]
        raise ValueError(
            f"house {house} of {len(header)} has more walls and furniture than this backend can store"
        )
    words = before + (total + 1) // 2
    first = header.size + len(used)
    block = first + before + words.cumsum() - words
    indices = np.zeros(first + before + int(words.sum()) + AHEAD, np.int32)
    indices[: header.size], indices[header.size : first] = header.ravel(), first
    indices[header.size : first][used] = block
    ends = np.zeros((len(counts), 2 * before), np.uint16)
    ends[:, 1 : counts.shape[1] + 1] = sums
    indices[block[:, None] + np.arange(before)] = ends.view(np.int32)
    return indices


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
