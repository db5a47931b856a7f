"""How far sight goes on ground that was not seen: rays over the truth, from the ground that was."""

from typing import NamedTuple

import numpy as np

from agent.map_completion.windows import OCCUPIED_CELLS, seen

RAYS = 256
"""Rays over a window."""

REACH = 27
"""Blocks that a ray goes on at most: as far as the planner's views."""


class Sight(NamedTuple):
    """What rays met on the unseen ground of n windows."""

    rays: np.ndarray
    """(n, W, W) float32: how many of them came to a block."""

    passed: np.ndarray
    """(n, W, W) float32: the share of these that went on, 0 where none came."""


def cast(windows: np.ndarray, solid: np.ndarray, random: np.random.Generator) -> Sight:
    """Cast rays over windows (n, W, W) uint8, as ``Windows.read`` gives them, from random places on ground
    that was seen to be free, in random directions, to the first block that is ``solid`` (n, W, W) uint8.

    One less the share that passes is the hazard of survival analysis (Kaplan and Meier 1958): rays that ended
    before do not count. So the product of what passes is how likely a ray comes so far, also where a wall is
    certain and its place is not.
    """
    count, high, wide = windows.shape
    known, open_ = seen(windows).ravel(), solid.ravel() == 0
    free = np.flatnonzero(known & open_ & (windows.ravel() & OCCUPIED_CELLS == 0))
    ends = np.searchsorted(free, high * wide * np.arange(count + 1))
    # As many rays over each window, where anything was seen.
    some = np.diff(ends)
    drawn = (ends[:-1, None] + random.random((count, RAYS)) * some[:, None]).astype(int)[some > 0]
    window, place = np.divmod(free[drawn.ravel()], high * wide)
    y, x = np.divmod(place, wide)
    angles = random.uniform(0, 2 * np.pi, len(window))
    south, east, first = np.sin(angles), np.cos(angles), high * wide * window
    came, ended = [np.zeros(0, int)], [np.zeros(0, int)]
    for k in range(1, REACH + 1):
        i, j = y + np.rint(k * south).astype(int), x + np.rint(k * east).astype(int)
        inside = (i >= 0) & (i < high) & (j >= 0) & (j < wide)
        there = first + np.where(inside, i * wide + j, 0)
        goes, new = inside & open_[there], inside & ~known[there]
        came.append(there[new])
        ended.append(there[new & ~goes])
        y, x, south, east, first = (each[goes] for each in (y, x, south, east, first))
    rays, lost = (np.bincount(np.concatenate(each), minlength=windows.size) for each in (came, ended))
    rays, lost = rays.reshape(windows.shape), lost.reshape(windows.shape)
    return Sight(rays.astype(np.float32), ((rays - lost) / np.maximum(rays, 1)).astype(np.float32))
