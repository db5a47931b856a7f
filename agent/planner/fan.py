"""The fan of an eye's rays over the map's cells: which cells lie behind which rays, nearest first.

Rays cross near cells in numbers and miss far ones between them. So each cell belongs to the ray that crosses
it nearest to its centre by angle, and is seen if that one reaches beyond it; or it lies between two rays, and
is seen if both do. Headings are eight, and the eye stands on a cell's corner or half a cell from it: all
cases fit in a table.
"""

import numpy as np

from agent.planner.cells import WAYS

BESIDE = 0.7
"""Cells from a ray at which a cell's centre is on it."""

BEYOND = 0.45
"""Cells that a ray must reach beyond a cell's centre for the cell to be seen."""

FINE = 512
"""Parts of a cell in which distances are counted."""

BAND = 4
"""Cells of a ray that are passed over at a time, where they were noted before."""


def bands(reach: float) -> int:
    """How many ways of 0, 1, 2 ... times ``BAND`` cells there are within a ray's reach, in cells."""
    return int(reach / BAND) + 1


def fan(angles: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells behind rays at ``angles`` (R,), radians counter-clockwise from the heading, falling, of so many
    cells' reach.

    Returns where each list begins (32, 2 R) int32, by heading and by whether the eye's place in half cells
    is odd (east + 2 south): a ray's own cells, then those between it and the next one. Then how many of its
    own cells a ray passes before it has gone 0, 1, 2 ... times ``BAND`` cells (32, R, bands) int32. And all
    the lists, one after the other, int32: how far a ray must reach, in parts of a cell, times 2^16, and the
    way there from the eye's own cell, south times 2^8 and east, both modulo 2^8 (``Grid.beside``).
    """
    wide = int(np.ceil(reach)) + 1
    south, east = np.mgrid[-wide:wide, -wide:wide].reshape(2, -1)
    middles = np.append((angles[1:] + angles[:-1]) / 2, -np.inf)
    starts, skips, lists, begun = [], [], [], 0
    along = BAND * FINE * np.arange(bands(reach)) << 16
    for heading in range(len(WAYS)):
        for odd in range(4):
            x, y = east + 0.5 - 0.5 * (odd & 1), south + 0.5 - 0.5 * (odd >> 1)
            angle = (np.arctan2(-y, x) - np.pi / 4 * heading + np.pi) % (2 * np.pi) - np.pi
            nearest = np.searchsorted(-middles, -angle)
            off, away = angle - angles[nearest], np.hypot(x, y)
            on = (np.abs(np.sin(off)) * away <= BESIDE) & (np.cos(off) > 0)
            # Rays fall: what is counter-clockwise of one lies between the one before and it.
            list_ = np.where(on, 2 * nearest, np.where(off > 0, 2 * nearest - 1, 2 * nearest + 1))
            far = away * np.cos(off) + BEYOND
            kept = (list_ >= 0) & (list_ < 2 * len(angles) - 1) & (far <= reach)
            order = np.lexsort((far[kept], list_[kept]))
            places = ((south[kept] & 0xFF) << 8) | (east[kept] & 0xFF)
            cells = (np.ceil(far[kept] * FINE).astype(np.int64) << 16 | places)[order]
            begins = np.searchsorted(list_[kept][order], np.arange(2 * len(angles)))
            own = zip(begins[::2], begins[1::2], strict=True)
            skips.append([np.searchsorted(cells[first:last], along) for first, last in own])
            starts.append(begun + begins)
            lists.append(cells)
            begun += len(order)
    return np.array(starts, np.int32), np.array(skips, np.int32), np.concatenate(lists).astype(np.int32)
