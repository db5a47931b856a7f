"""The planner a second time, in NumPy and by its meaning: what one step must make of a memory.

Places are in cells, half a body wide, east and south of where the episode began; poses are in half cells.
The map is a torus of 256 by 256 cells; cell (x, y) has node (x, y), where a body may stand, at its north-
west corner. Arrays of cells are indexed [y, x]. A ``memory`` is what the adapter reads.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

import numpy as np

from agent.avoidance import air, clearance
from sim.config import Config

SIDE = 256
WAYS = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))
"""East and south, at each of the eight headings."""

ON_RAY, BEYOND = 0.7, 0.45
"""A ray shows cells whose centres are so near to it, and that it reaches so far beyond, in cells."""

ABOUT_HIT = 0.07
"""Cells about a hit that hold what was hit."""

SQUARE = ((0, 0), (1, 0), (0, 1), (1, 1))


@dataclass(frozen=True)
class Body:
    """A body and its eye, in cells."""

    config: Config

    @cached_property
    def step(self) -> int:
        """Half cells that it goes along an axis in a step."""
        return max(1, round(4 * self.config.step / max(self.config.body)))

    @cached_property
    def cell(self) -> float:
        """Metres."""
        return 2 * self.config.step / self.step

    @cached_property
    def angles(self) -> np.ndarray:
        """Of its rays, radians counter-clockwise from its heading."""
        return np.deg2rad(self.config.first_ray - self.config.ray_spacing * np.arange(self.config.rays))

    @cached_property
    def half(self) -> float:
        """Half a target's side."""
        return self.config.target / 2 / self.cell

    @property
    def touching(self) -> bool:
        """Whether it fills a cell of a grid, so that it touches walls."""
        return self.config.in_cells

    def ends(self, observation: np.ndarray, heading: float) -> np.ndarray:
        """Where its rays end (R, 2), east and south of its eye."""
        angles = self.angles + heading * np.pi / 4
        far = observation[:, 0].astype(float)[:, None] * self.config.range / self.cell
        return far * np.column_stack([np.cos(angles), -np.sin(angles)])

    def may_go(self, observation: np.ndarray, diagonal: int) -> bool:
        """Whether rays show room for a step forward; a target is never in the way."""
        needs = clearance(self.angles, max(self.config.body), self.config.step, air(self.config))[diagonal]
        near = observation[:, 0] < (needs / self.config.range).astype(np.float32)
        return not (near & (observation[:, -1] == 0)).any()


# - move -------------------------------------------------------------------------------------------


def moved(body: Body, before: Any, action: int, blocked: bool) -> tuple[int, int, int]:
    """The pose after an action, and the heading."""
    x, y, heading = before.x, before.y, before.heading
    if action < 2:
        return x, y, (heading + (1, -1)[action]) % 8
    if blocked:
        return x, y, heading
    return x + body.step * WAYS[heading][0], y + body.step * WAYS[heading][1], heading


def diagonal(body: Body, observation: np.ndarray) -> int | None:
    """Whether a heading is at 45 degrees to the walls: two neighbouring rays that end on one wall show its
    direction. None where as many pairs say yes as no.
    """
    votes = []
    hit = observation[:, 0] < 1
    for heading in (0, 1):
        along = np.diff(body.ends(observation, heading), axis=0)
        votes.append((np.abs(along) < 1e-3)[hit[1:] & hit[:-1]].sum())
    return None if votes[0] == votes[1] else int(votes[1] > votes[0])


# - see --------------------------------------------------------------------------------------------


@lru_cache(maxsize=64)
def fan(body: Body, heading: int, odd_x: int, odd_y: int) -> tuple[np.ndarray, ...]:
    """Cells before an eye: their places from the eye's own cell, the two rays that must show each (the same
    one twice where it is on a ray), whether either does, and how far rays must reach.
    """
    wide = int(body.config.range / body.cell) + 2
    south, east = np.mgrid[-wide:wide, -wide:wide].reshape(2, -1)
    x, y = east + 0.5 - odd_x / 2, south + 0.5 - odd_y / 2
    angle = (np.arctan2(-y, x) - heading * np.pi / 4 + np.pi) % (2 * np.pi) - np.pi
    off = angle[:, None] - body.angles
    by_angle = np.argsort(np.abs(off), axis=1, kind="stable")
    first, second = by_angle[:, 0], by_angle[:, 1]
    aside = np.take_along_axis(off, by_angle, axis=1)
    away = np.hypot(x, y)
    on = (np.abs(np.sin(aside[:, 0])) * away <= ON_RAY) & (np.cos(aside[:, 0]) > 0)
    within = (angle < body.angles[0]) & (angle > body.angles[-1])
    either = on & (np.abs(np.abs(aside[:, 0]) - np.abs(aside[:, 1])) < 1e-6)
    second = np.where(on & ~either, first, second)
    needs = away * np.cos(aside[:, 0]) + BEYOND
    return tuple(part[on | within] for part in (east, south, first, second, either, needs))


def shown(body: Body, observation: np.ndarray, x: int, y: int, heading: int, slack: float) -> np.ndarray:
    """Cells whose floor the rays show; with ``slack``, if they reached so much further (or less far)."""
    east, south, first, second, either, needs = fan(body, heading, x % 2, y % 2)
    reach = observation[:, 0].astype(float) * body.config.range / body.cell
    one, other = reach[first], reach[second]
    far = np.where(either & (slack > 0), np.maximum(one, other), np.minimum(one, other))
    seen = (needs <= far + slack) & (needs <= body.config.range / body.cell)
    cells = np.zeros((SIDE, SIDE), bool)
    cells[(y // 2 + south[seen]) % SIDE, (x // 2 + east[seen]) % SIDE] = True
    return cells


def due(before: Any, action: int) -> bool:
    """Whether a planner sweeps its rays: not at each step where nothing is new and it goes straight on, or
    knows a target.
    """
    every, straight = 4 if before.known else 2, before.straight >= 0 and action == 2
    return bool(before.new or (before.time + 1) % every == 1 or not (straight or before.known))


def under(x: int, y: int) -> np.ndarray:
    """Cells that a body covers wholly, or half of them between two nodes."""
    cells = np.zeros((SIDE, SIDE), bool)
    for i, j in SQUARE:
        cells[((y + 1) // 2 - 1 + j) % SIDE, ((x + 1) // 2 - 1 + i) % SIDE] = True
    return cells


def walls(body: Body, observation: np.ndarray, x: int, y: int, heading: int, slack: float) -> np.ndarray:
    """Walls (n, 4) that rays end on, west, north, east, south: each hit, and what joins two neighbouring
    hits on one line.
    """
    ends, hit = body.ends(observation, heading), (observation[:, 0] < 1) & (observation[:, -1] == 0)
    ends = ends + np.array([x, y]) / 2
    gap = np.abs(np.diff(ends, axis=0))
    widest = (1.9 if body.touching else 2.9) + slack
    joined = hit[1:] & hit[:-1] & (gap.max(1) < widest) & (gap.min(1) < 1e-3 + slack / 10)
    low, high = np.minimum(ends[1:], ends[:-1])[joined], np.maximum(ends[1:], ends[:-1])[joined]
    return np.concatenate([np.hstack([ends[hit]] * 2), np.hstack([low, high])])


def occupied(walls: np.ndarray, slack: float) -> np.ndarray:
    """Cells that walls are in, or within a centimetre of."""
    cells, about = np.zeros((SIDE, SIDE), bool), ABOUT_HIT + slack
    low, high = np.floor(walls[:, :2] - about).astype(int), np.floor(walls[:, 2:] + about).astype(int)
    for more in product(range(5), repeat=2):
        x, y = (low + more)[(low + more <= high).all(1)].T % SIDE
        cells[y, x] = True
    return cells


def closed(body: Body, walls: np.ndarray, new: np.ndarray, slack: float) -> np.ndarray:
    """Nodes where bodies have no room since cells are ``new``ly occupied: their corners. Where bodies touch
    walls, only nodes on a wall's own line, which is an odd one, and not the next one to its end.
    """
    if not body.touching:
        return grown(new, SQUARE)
    nodes, short = np.zeros((SIDE, SIDE), bool), 1 - ABOUT_HIT + slack
    lines = 2 * np.floor(walls[:, :2] / 2) + 1
    off = np.abs(walls[:, :2] - lines)
    for axis in (0, 1):  # across the line
        on = off[:, axis] < off[:, 1 - axis] + slack
        first, last = walls[on, 1 - axis] - short, walls[on, 3 - axis] + short
        for more in range(1, 6):
            along = np.floor(first) + more
            line = np.column_stack([lines[on, axis], along])[along < last].astype(int) % SIDE
            nodes[tuple(line.T[::-1] if axis == 0 else line.T)] = True
    return nodes


def grown(cells: np.ndarray, ways: Any) -> np.ndarray:
    """Cells, and those that lie in one of some ways, east and south, from them."""
    result = cells.copy()
    for x, y in ways:
        result |= np.roll(cells, (y, x), axis=(0, 1))
    return result


# - remember ---------------------------------------------------------------------------------------


def target(body: Body, observation: np.ndarray, heading: int, known: np.ndarray | None) -> np.ndarray | None:
    """The centre of the target that rays show, from the eye; where it was ``known`` to lie, if so. Along an
    axis it is exact where a face across it is seen; None where no ray meets it.
    """
    met = observation[:, -1] > 0
    if not met.any():
        return None
    ends = body.ends(observation, heading)[met]
    low, high = ends.min(0), ends.max(0)
    way = np.sum([[np.cos(a), -np.sin(a)] for a in body.angles[met] + heading * np.pi / 4], axis=0)
    centre = (low + high) / 2
    if known is not None and not other(centre, known):
        centre = np.clip(known, high - body.half, low + body.half)
    elif len(ends) == 1:
        centre = centre + way
    for axis in (0, 1):
        if len(ends) > 1 and high[1 - axis] - low[1 - axis] >= 0.02:  # a face across this axis
            centre[axis] = low[axis] + body.half if way[axis] > 0 else high[axis] - body.half
    return centre


def other(one: np.ndarray, known: np.ndarray) -> bool:
    """Whether a target in one place is not the one that was known in another."""
    return np.abs(one - known).max() > 4.5


def gone(body: Body, observation: np.ndarray, heading: int, known: np.ndarray) -> bool:
    """Whether a target that no ray meets is gone: the body touches its place, or a ray passes beyond it."""
    ends = body.ends(observation, heading)
    far = np.hypot(*ends.T)
    along, aside = ends @ known / far, np.abs(ends[:, 0] * known[1] - ends[:, 1] * known[0]) / far
    passes = (along > 0) & (aside < 0.5) & (far > along + 1)
    away = np.abs(known).max()
    return bool(away < 1 + body.half + 0.125 or (passes.any() and away < 12))


def start_room(memory: Any) -> tuple[int, int, int, int]:
    """The rectangle about the start that grows, a row or column at a time, until one has a wall or is unseen:
    its first and last columns and rows.
    """
    box, grows = [-1, 0, -1, 0], [True] * 4
    while any(grows):
        for side in range(4):
            at = box[side] + (-1, 1)[side % 2]
            first, last = box[2 * (1 - side // 2)], box[2 * (1 - side // 2) + 1]
            span = np.arange(first, last + 1) % SIDE
            line = (span, at % SIDE) if side < 2 else (at % SIDE, span)
            grows[side] &= bool(
                not memory.occupied[line].any() and memory.seen_at[line].any() and abs(at) < 120
            )
            box[side] = at if grows[side] else box[side]
    west, east, north, south = box
    return west, east, north, south


def shares(here: int, found: int) -> tuple[float, float]:
    """How likely targets lie in the start room, and elsewhere, over the greater: three hypotheses (only
    here, only elsewhere, anywhere) by Bayes's rule, where one pick-up in twenty is taken for one in another
    room.
    """
    likely = {"anywhere": 0.5**found}
    likely["here"] = 0.95**here * 0.05 ** (found - here)
    likely["elsewhere"] = 0.05**here * 0.95 ** (found - here)
    one, two = likely["anywhere"] + 2 * likely["here"], likely["anywhere"] + 2 * likely["elsewhere"]
    return one / max(one, two), two / max(one, two)
