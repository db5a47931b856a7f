"""Baseline that goes to the nearest frontier (Yamauchi, CIRA 1997): a free cell beside an unseen one.

The baseline knows its exact pose, and what the beams of ``Seen`` have shown. It goes to the frontier with the
fewest steps among those of more than ten cells. It chooses again when it is there or when all of the frontier
has been seen. If a frontier remains although the baseline was there, it is left out from then on.
"""

import numpy as np
from scipy.ndimage import binary_dilation, label

from benchmarks.exploration.seen import OPEN, UNSEEN, Seen
from vitruvius.sim.actions import FORWARD, HEADINGS, LEFT, RIGHT

SMALLEST = 10
"""Size in cells of a frontier that is too small: frontiers of no more cells are left out, as in MapEx."""

NEAR = 3
"""Distance in cells at which a body has reached a frontier; closer to it there may be no room."""

TRIES = 1
"""Largest number of visits to a frontier that remains after a look from there."""

ALL_AROUND, WIDE = np.ones((3, 3), bool), np.ones((2 * NEAR + 1,) * 2, bool)


class NearestFrontier:
    """Policies of E bodies, which share nothing."""

    def __init__(self, seen: Seen, turns: bool) -> None:
        """Take ``turns``: True if a body turns around at a frontier, because its sensor looks forward."""
        self.seen, self.turns, count = seen, turns, seen.bodies
        self.ways: list[list[int]] = [[] for _ in range(count)]
        self.goals = np.zeros((count, 2), int)
        self.turning = np.full(count, 8 if turns else 0)
        self.arrived, self.done = np.zeros(count, bool), np.zeros(count, bool)
        self.tried = np.zeros((count, *seen.shape), np.uint8)

    arrived: np.ndarray
    """(E,) bool: True for bodies that have reached the end of their path, where they look before they choose
    again."""
    done: np.ndarray
    """(E,) bool: True for bodies that have no reachable frontier left."""

    def act(self, poses: np.ndarray) -> np.ndarray:
        """Return actions (E,) for poses (E, 3)."""
        at = self.seen.cells(poses[:, :2]).astype(int)[:, ::-1]
        lost = np.zeros(len(poses), bool)
        for e in range(len(poses)):
            if self.turning[e] or self.done[e]:
                continue
            if self.ways[e] and not self._frontiers(e, self.goals[e]).any():
                self.ways[e] = []
            lost[e] = not self.ways[e]
        if lost.any():
            self._choose(poses, at, lost)
        return np.array([self._next(e, round(poses[e, 2] / (np.pi / 4)) % 8) for e in range(len(poses))])

    def _frontiers(self, e: int, at: np.ndarray) -> np.ndarray:
        """Return a mask (h, w) bool of the cells around a place that are frontiers."""
        row, column = at
        rows, columns = (slice(max(0, x - NEAR - 1), x + NEAR + 2) for x in (row, column))
        known = self.seen.known[e, rows, columns]
        return (known == OPEN) & binary_dilation(known == UNSEEN, ALL_AROUND)

    def _choose(self, poses: np.ndarray, at: np.ndarray, lost: np.ndarray) -> None:
        """Choose goals for bodies without one."""
        goals = np.zeros((len(poses), *self.seen.shape), bool)
        for e in np.flatnonzero(lost):
            known = self.seen.known[e]
            edge = (known == OPEN) & binary_dilation(known == UNSEEN, ALL_AROUND) & (self.tried[e] < TRIES)
            regions, _ = label(edge, ALL_AROUND)
            large = np.bincount(regions.ravel()) > SMALLEST
            large[0] = False
            goals[e] = binary_dilation(large[regions], WIDE)
            row, column = at[e]
            if goals[e, row, column]:  # After its look, these cells remain frontiers.
                rows, columns = (slice(max(0, x - NEAR), x + NEAR + 1) for x in (row, column))
                self.tried[e, rows, columns] += 1
                goals[e, rows, columns] = False
        for e, way in enumerate(self.seen.ways(poses, goals, lost)):
            if lost[e]:
                self.ways[e], self.done[e] = way, not way
                end = poses[e, :2] + self.seen.pitch * np.sum([HEADINGS[h] for h in way] or [(0, 0)], axis=0)
                self.goals[e] = self.seen.cells(end)[::-1]

    def _next(self, e: int, heading: int) -> int:
        """Return the next action of a body's path; without a path, turn."""
        if self.turning[e]:
            self.turning[e] -= 1
            return LEFT
        if not self.ways[e]:
            return LEFT
        wanted = self.ways[e][0]
        if heading == wanted:
            self.ways[e].pop(0)
            if not self.ways[e]:
                self.arrived[e], self.turning[e] = True, 8 * self.turns
            return FORWARD
        return LEFT if (wanted - heading) % 8 <= 4 else RIGHT
