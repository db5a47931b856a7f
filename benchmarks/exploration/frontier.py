"""The baseline that goes to the nearest frontier (Yamauchi, CIRA 1997): a free cell beside an unseen one.

It is told where it is, and knows what the beams of ``Seen`` have shown. It goes to the frontier that the
fewest steps lead to, of those of more than ten cells, until it is there or all of that has been seen, and
chooses again; a frontier that stays one though it was there is left.
"""

import numpy as np
from scipy.ndimage import binary_dilation, label

from benchmarks.exploration.seen import OPEN, UNSEEN, Seen
from sim.actions import FORWARD, HEADINGS, LEFT, RIGHT

SMALLEST = 10
"""Cells: frontiers of no more are left out, as in MapEx."""

NEAR = 3
"""Cells from a frontier at which a body is there: nearer it may have no room."""

TRIES = 1
"""How often it goes to a frontier that stays one, though it has looked from there."""

ALL_AROUND, WIDE = np.ones((3, 3), bool), np.ones((2 * NEAR + 1,) * 2, bool)


class NearestFrontier:
    """Policies of E bodies, which share nothing."""

    def __init__(self, seen: Seen, turns: bool) -> None:
        """``turns``: whether it turns around where it has come to a frontier, as its sensor is in front."""
        self.seen, self.turns, count = seen, turns, seen.bodies
        self.ways: list[list[int]] = [[] for _ in range(count)]
        self.goals = np.zeros((count, 2), int)
        self.turning = np.full(count, 8 if turns else 0)
        self.arrived, self.done = np.zeros(count, bool), np.zeros(count, bool)
        self.tried = np.zeros((count, *seen.shape), np.uint8)

    arrived: np.ndarray
    """(E,) bool: which have come to the end of their way, where they look before they choose again."""
    done: np.ndarray
    """(E,) bool: which have no frontier left that a way leads to."""

    def act(self, poses: np.ndarray) -> np.ndarray:
        """Actions (E,) from poses (E, 3)."""
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
        """Which cells about a place are frontiers, (h, w) bool."""
        row, column = at
        rows, columns = (slice(max(0, x - NEAR - 1), x + NEAR + 2) for x in (row, column))
        known = self.seen.known[e, rows, columns]
        return (known == OPEN) & binary_dilation(known == UNSEEN, ALL_AROUND)

    def _choose(self, poses: np.ndarray, at: np.ndarray, lost: np.ndarray) -> None:
        """Choose goals for those that have none."""
        goals = np.zeros((len(poses), *self.seen.shape), bool)
        for e in np.flatnonzero(lost):
            known = self.seen.known[e]
            edge = (known == OPEN) & binary_dilation(known == UNSEEN, ALL_AROUND) & (self.tried[e] < TRIES)
            regions, _ = label(edge, ALL_AROUND)
            large = np.bincount(regions.ravel()) > SMALLEST
            large[0] = False
            goals[e] = binary_dilation(large[regions], WIDE)
            row, column = at[e]
            if goals[e, row, column]:  # It is there, and has looked: these stay frontiers.
                rows, columns = (slice(max(0, x - NEAR), x + NEAR + 1) for x in (row, column))
                self.tried[e, rows, columns] += 1
                goals[e, rows, columns] = False
        for e, way in enumerate(self.seen.ways(poses, goals, lost)):
            if lost[e]:
                self.ways[e], self.done[e] = way, not way
                end = poses[e, :2] + self.seen.pitch * np.sum([HEADINGS[h] for h in way] or [(0, 0)], axis=0)
                self.goals[e] = self.seen.cells(end)[::-1]

    def _next(self, e: int, heading: int) -> int:
        """The action that leads along its way; where there is none, it turns."""
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
