"""Length of sight over unseen ground: rays over the true house, from seen ground."""

from typing import NamedTuple

import numpy as np

from vitruvius.agent.algorithms.map_completion.windows import OCCUPIED_CELLS, seen
from vitruvius.agent.planner import TUNED

RAYS = 256
"""Number of rays in each window."""

RANGE = TUNED.view_range // 2
"""Largest number of blocks that a ray passes, as in the planner's views. A block is two cells wide."""


class SightLines(NamedTuple):
    """Rays over the unseen ground of n windows."""

    rays: np.ndarray
    """(n, W, W) float32: number of rays that reached a block."""

    passed: np.ndarray
    """(n, W, W) float32: fraction of these rays that passed the block; 0 if no ray came."""


def cast_rays(windows: np.ndarray, solid: np.ndarray, random: np.random.Generator) -> SightLines:
    """Cast rays in windows (n, W, W) uint8, as ``Windows.read`` returns them.

    Rays start at random blocks that were seen to be free, in random directions, and end at the first block
    that is ``solid`` (n, W, W) uint8.

    1 minus the fraction that passes is the hazard rate of survival analysis (Kaplan and Meier 1958): rays
    that ended before do not count. So the product of the fractions along a ray approximates the probability
    that the ray gets that far, even if a wall is certain but its place is not.
    """
    count, high, wide = windows.shape
    known, open_ = seen(windows).ravel(), solid.ravel() == 0
    free = np.flatnonzero(known & open_ & (windows.ravel() & OCCUPIED_CELLS == 0))
    ends = np.searchsorted(free, high * wide * np.arange(count + 1))
    # Each window gets RAYS rays, unless none of its blocks was seen to be free.
    some = np.diff(ends)
    drawn = (ends[:-1, None] + random.random((count, RAYS)) * some[:, None]).astype(int)[some > 0]
    window, place = np.divmod(free[drawn.ravel()], high * wide)
    y, x = np.divmod(place, wide)
    angles = random.uniform(0, 2 * np.pi, len(window))
    south, east, first = np.sin(angles), np.cos(angles), high * wide * window
    came, ended = [], []
    for k in range(1, RANGE + 1):
        i, j = y + np.rint(k * south).astype(int), x + np.rint(k * east).astype(int)
        inside = (i >= 0) & (i < high) & (j >= 0) & (j < wide)
        there = first + np.where(inside, i * wide + j, 0)
        goes, new = inside & open_[there], inside & ~known[there]
        came.append(there[new])
        ended.append(there[new & ~goes])
        y, x, south, east, first = (each[goes] for each in (y, x, south, east, first))
    rays, lost = (np.bincount(np.concatenate(each), minlength=windows.size) for each in (came, ended))
    rays, lost = rays.reshape(windows.shape), lost.reshape(windows.shape)
    return SightLines(rays.astype(np.float32), ((rays - lost) / np.maximum(rays, 1)).astype(np.float32))
