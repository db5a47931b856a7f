"""The second half of the reference: what a planner must choose, and how it must go there, by its memory."""

from dataclasses import dataclass
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.agent.planner.reference import SIDE, SQUARE, WAYS, Body, shares, start_room

SURE, ODDS = 100, (0, 0, 0, 0, 0, 0, 0, 7, 23, 38, 57, 63, 76, 87, 87, 87, 87)
"""How likely a place holds floor: one that was seen, and one that was not, by the floor less walls around
it.
"""

PITCH, HASTE, LEAST, PLENTY = 4, 4.0, 200, 60_000
"""Nodes between viewpoints; steps added to each path; what a view must show, and needs at most."""


# - where targets may lie, and how far that is -----------------------------------------------------


def openings(memory: Any) -> np.ndarray:
    """Nodes that a path may lead over."""
    return memory.near & ~memory.solid


def levels(memory: Any, x: int, y: int) -> np.ndarray:
    """Steps (128, 128) to each block of 2 by 2 nodes from a pose; -1 for never. Blocks are joined where
    open nodes of both are side by side; one whose open nodes touch at a corner alone joins none. Diagonals
    are one step.
    """
    open_ = openings(memory)
    a, b, c, d = (open_[j::2, i::2] for j, i in product((0, 1), repeat=2))
    whole = ~((a & d & ~b & ~c) | (b & c & ~a & ~d))
    a, b, c, d = (corner & whole for corner in (a, b, c, d))
    east = (b & np.roll(a, -1, 1)) | (d & np.roll(c, -1, 1))
    south = (c & np.roll(a, -1, 0)) | (d & np.roll(b, -1, 0))
    wet = np.zeros(east.shape, bool)
    for i, j in product({x // 2, (x + 1) // 2}, {y // 2, (y + 1) // 2}):
        for dx, dy in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
            if (dx, dy) == (0, 0) or open_[(j + dy) % SIDE, (i + dx) % SIDE]:
                wet[(j + dy) % SIDE // 2, (i + dx) % SIDE // 2] = True
    level, last = np.where(wet, 0, -1), None
    while last is None or (wet & (level < 0)).any():
        level[wet & (level < 0)] = last = level.max() + 1 if last is not None else 0
        wet = wet | np.roll(wet & east, 1, 1) | (np.roll(wet, -1, 1) & east)
        wet = wet | np.roll(wet & south, 1, 0) | (np.roll(wet, -1, 0) & south)
    return level


def hides(memory: Any, since: int) -> np.ndarray:
    """Whether a target may lie about each block's first node (128, 128), unseen since a step: it covers
    some 4 by 4 cells, the inner ones wholly.
    """
    unseen = ~memory.occupied & (memory.seen_at < since)
    rolled = {(i, j): np.roll(unseen, (-j, -i), (0, 1)) for i, j in product(range(-2, 2), repeat=2)}
    inner = np.all([rolled[way] for way in product((-1, 0), (-1, 0))], axis=0)
    return (inner & (np.sum(list(rolled.values()), axis=0) >= 12))[::2, ::2]


def foreseen(memory: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """What a prior says of blocks (128, 128): what they count, whether bodies can stand there, and how likely
    sight passes them; None without a prior.
    """
    prior = getattr(memory, "prior", None)
    if prior is None:
        return None
    passes = 1 - (prior >> 8) / 255
    return prior & 127, prior & 128 > 0, passes


def likelihood(memory: Any) -> np.ndarray:
    """What each block (128, 128) counts as a candidate: what a prior says; else 0, or how likely it is
    floor.
    """
    if prior := foreseen(memory):
        return np.where(hides(memory, memory.since), prior[0], 0)
    floor = np.zeros((SIDE, SIDE), int)
    for dx, dy in WAYS:
        met = np.zeros((SIDE, SIDE), int)
        for t in range(9, 0, -1):
            way = (-(t * dy - (dy < 0)), -(t * dx - (dx < 0)))
            seen, wall = np.roll(memory.seen_at > 0, way, (0, 1)), np.roll(memory.occupied, way, (0, 1))
            met = np.where(seen, np.where(wall, -1, 1), met)
        floor += met
    odds = np.where(memory.seen_at > 0, SURE, np.array(ODDS)[floor + 8])
    return np.where(hides(memory, memory.since), odds[::2, ::2], 0)


def believed(memory: Any) -> np.ndarray:
    """``likelihood``, weighed by what pick-ups tell of the start room, where no prior does."""
    if foreseen(memory):
        return likelihood(memory)
    west, east, north, south = start_room(memory)
    here, elsewhere = shares(memory.found_here, memory.found)
    at = (np.arange(0, SIDE, 2) + 128) % SIDE - 128
    inside = np.outer((at > north) & (at <= south), (at > west) & (at <= east))
    return np.ceil(np.where(inside, here, elsewhere) * likelihood(memory) - 1e-4).astype(int)


# - choose a viewpoint -----------------------------------------------------------------------------


def look_table() -> np.ndarray:
    """Places (8, 5, 27, 2) that a look at each octant goes over, from a node: 5 rays, every other cell."""
    angles = np.pi / 4 * (np.arange(8)[:, None] + (np.arange(5) - 2) / 5)
    along = 2 * np.arange(1, 28)[:, None]
    return np.rint(along * np.stack([np.cos(angles), -np.sin(angles)], -1)[:, :, None]).astype(int)


LOOK = look_table()


def looked(memory: Any, x: Any, y: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What looks from nodes (n,) meet: rows and columns of blocks (n, 8, 5, 27), and which are in sight."""
    column, row = np.reshape(x, (-1, 1, 1, 1)) + LOOK[..., 0], np.reshape(y, (-1, 1, 1, 1)) + LOOK[..., 1]
    barred = (memory.occupied | memory.solid)[row % SIDE, column % SIDE] | (passed(memory, x, y) == 0)
    return row % SIDE // 2, column % SIDE // 2, ~np.logical_or.accumulate(barred, axis=-1)


def sight(memory: Any) -> np.ndarray:
    """How likely sight passes each cell (256, 256): a prior tells it of cells that were never seen."""
    if prior := foreseen(memory):
        return np.where(memory.seen_at > 0, 1.0, prior[2].repeat(2, 0).repeat(2, 1))
    return np.ones((SIDE, SIDE))


def passed(memory: Any, x: Any, y: Any) -> np.ndarray:
    """The probability that looks from nodes (n,) reach each place (n, 8, 5, 27); 0 where few go on."""
    here = sight(memory)[np.reshape(y, (-1, 1, 1, 1)) % SIDE, np.reshape(x, (-1, 1, 1, 1)) % SIDE]
    column, row = np.reshape(x, (-1, 1, 1, 1)) + LOOK[..., 0], np.reshape(y, (-1, 1, 1, 1)) + LOOK[..., 1]
    there = sight(memory)[row % SIDE, column % SIDE]
    comes = np.cumprod(np.concatenate([np.broadcast_to(here, (*there.shape[:-1], 1)), there], -1), -1)
    return np.where(comes[..., 1:] < 0.02, 0, comes[..., :-1])


def gains(memory: Any, counts: np.ndarray, x: Any, y: Any) -> np.ndarray:
    """The information gain (n, 8) of a look at each heading: candidates in three octants of sight, each
    for the ground about it.
    """
    rows, columns, clear = looked(memory, x, y)
    counted = counts[rows, columns] * clear * passed(memory, x, y)
    octants = (counted * np.arange(1, 28)).sum((-1, -2)) * np.pi / 20
    return octants + np.roll(octants, 1, -1) + np.roll(octants, -1, -1)


def turns(one: Any, other: Any) -> Any:
    """Turns of 45 degrees from one heading to another."""
    return np.minimum((one - other) % 8, (other - one) % 8)


def candidates(memory: Any) -> tuple[np.ndarray, np.ndarray, set[tuple[int, int]]]:
    """How far all blocks are (128, 128); what each counts as a candidate; the nearest of these."""
    level = levels(memory, memory.x, memory.y)
    counts = np.where((level >= 0) & openings(memory)[::2, ::2], believed(memory), 0)
    places = [(int(x), int(y)) for y, x in np.argwhere(counts > 0)]
    least = min((level[y, x] for x, y in places), default=0)
    return level, counts, {(2 * x, 2 * y) for x, y in places if level[y, x] == least}


@dataclass
class Choice:
    """What views are worth, by node and heading; the nearest candidates; those that are tried now."""

    worth: dict[tuple[tuple[int, int], int], float]
    nearest: set[tuple[int, int]]
    tried: np.ndarray


def choice(body: Body, memory: Any, tried: np.ndarray) -> Choice:
    """What may be chosen where some places (128, 128) bool were ``tried`` before: they were in sight, and
    still were not seen. A view is worth its information gain over its cost, in steps and turns.
    """
    heading, (level, counts, nearest) = memory.heading, candidates(memory)
    here = np.array([memory.x // 2, memory.y // 2])
    rows, columns, clear = (part[0, (heading + np.arange(-1, 2)) % 8] for part in looked(memory, *here))
    now = np.zeros_like(tried)
    now[rows[clear], columns[clear]] = True
    now &= (counts > 0) & ~tried
    counts[tried | now] = 0
    stands = (memory.seen_at > 0)[::2, ::2]
    if prior := foreseen(memory):
        stands |= prior[1]
    may = (level > 0) & openings(memory)[::2, ::2] & stands
    y, x = 2 * np.argwhere(may & ~(np.indices(may.shape) % (PITCH // 2)).any(0)).T
    off = (np.column_stack([x, y]) - here + SIDE // 2) % SIDE - SIDE // 2
    distance = np.append(np.maximum(2 * level[y // 2, x // 2] - 1, np.abs(off).max(-1)), 0)
    east, south = (2 * off - (memory.x % 2, memory.y % 2)).T
    bearing = np.append(np.rint(np.arctan2(-south, east) / (np.pi / 4)).astype(int) % 8, heading)
    stand = next(
        (at for at in nodes_about(memory.x, memory.y)[::-1] if not memory.solid[at[::-1]]), tuple(here % SIDE)
    )
    x, y = np.append(x, stand[0]), np.append(y, stand[1])
    gain = np.minimum(gains(memory, counts, x, y), min(PLENTY, counts.sum()))
    turned = turns(heading, bearing)[:, None] + turns(bearing[:, None], np.arange(8))
    worth = gain / (2 / body.step * distance[:, None] + HASTE + turned)
    worth[(gain < LEAST) | ((distance[:, None] == 0) & (turned == 0))] = 0
    found = {((int(x[n]), int(y[n])), int(h)): float(worth[n, h]) for n, h in np.argwhere(worth > 0)}
    return Choice(found, nearest, now)


# - paths ------------------------------------------------------------------------------------------


def nodes_about(x: int, y: int) -> list[tuple[int, int]]:
    """The nodes within half a cell of a pose."""
    return [((x + i) // 2 % SIDE, (y + j) // 2 % SIDE) for i, j in SQUARE]


def sources(body: Body, memory: Any) -> list[np.ndarray]:
    """Where paths to the goal may end: the first of these that is not empty; or where there is none from
    there, the next. All free nodes less than some cells from it, along both axes.
    """
    centre, radius = np.array(memory.goal, float), 0.5
    if memory.kind == "target":
        centre, radius = memory.target % SIDE, 1 + body.half - 0.1  # where the body touches it
    x, y = np.arange(SIDE), np.arange(SIDE)[:, None]
    away = np.maximum(
        *(np.abs((axis - at + 128) % SIDE - 128) for axis, at in zip((x, y), centre, strict=True))
    )
    return [
        (away < r + more) & ~memory.solid
        for r in (radius, 1.5 if body.touching else 2.5)
        for more in range(4)
    ]


def distances(memory: Any, sources: np.ndarray, most: int) -> np.ndarray:
    """Steps (256, 256) to the nearest source, up to ``most``, -1 beyond: breadth-first; a diagonal step is
    one step, between two open corners.
    """
    open_, reached, far = openings(memory) | sources, sources, np.where(sources, 0, -1)
    into = [
        (x, y, open_ & np.roll(open_, x, 1) & np.roll(open_, y, 0) if x and y else open_) for x, y in WAYS
    ]
    for step in range(1, most + 1):
        wave = reached.copy()
        for x, y, may in into:
            wave |= np.roll(reached, (y, x), (0, 1)) & may
        far[wave & ~reached] = step
        reached = wave
    return far


def away(field: np.ndarray, x: int, y: int) -> int | None:
    """Half cells from a pose to the goal, by the nodes about it; None where none has a distance."""
    found = []
    for i, j in SQUARE:
        node = (x + i) // 2, (y + j) // 2
        steps = field[node[1] % SIDE, node[0] % SIDE]
        if steps >= 0:
            found.append(2 * steps + max(abs(2 * node[0] - x), abs(2 * node[1] - y)))
    return min(found, default=None)


def room(memory: Any, x: int, y: int) -> bool:
    """Whether a body has room at a pose."""
    return not any(memory.solid[j, i] for i, j in nodes_about(x, y))


def passes(body: Body, memory: Any, x: int, y: int, dx: int, dy: int) -> bool:
    """Whether it has room on a step's way, each cell of it."""
    return all(room(memory, x + k * dx, y + k * dy) for k in {*range(2, body.step, 2), body.step})


def steps(body: Body, memory: Any, forward: bool) -> tuple[np.ndarray, np.ndarray]:
    """Of a step at each heading, counter-clockwise from the body's own: whether it is free, and how much
    nearer it brings the goal, per half cell; -1 where that is not known.
    """
    x, y = memory.x, memory.y
    span = look_ahead(body, x, y)
    free, gain, far = np.zeros(8, bool), np.full(8, -1.0), away(memory.distance, x, y)
    for k in range(8):
        dx, dy = WAYS[(memory.heading + k) % 8]
        to = x + span * dx, y + span * dy
        free[k] = room(memory, *to) and passes(body, memory, x, y, dx, dy) and (forward or k > 0)
        if dx and dy:
            free[k] &= room(memory, to[0], y) and room(memory, x, to[1])
            if body.touching:  # no wall crosses the square of the step
                free[k] &= passes(body, memory, x, y, dx, 0) and passes(body, memory, x, y, 0, dy)
                free[k] &= passes(body, memory, *to, -dx, 0) and passes(body, memory, *to, 0, -dy)
        left = away(memory.distance, *to)
        if free[k] and far is not None and left is not None:
            gain[k] = (far - left) / span
    return free, gain


def look_ahead(body: Body, x: int, y: int) -> int:
    """Half cells by which steps are compared: from node to node where a step is less."""
    return body.step if x % 2 or y % 2 else max(2, body.step)


def turns_on(memory: Any, x: int, y: int, heading: int) -> int:
    """Turns on a shortest path of up to 40 nodes that goes straight on while it can, and then turns least."""
    near = [
        (memory.distance[j, i], n, (i, j))
        for n, (i, j) in enumerate(nodes_about(x, y))
        if memory.distance[j, i] >= 0
    ]
    if not near:
        return 0
    left, _, (x, y) = min(near)
    turned = 0
    for _ in range(min(40, left)):
        for turn in (0, 1, -1, 2, -2, 3, -3, 4):
            dx, dy = WAYS[(heading + turn) % 8]
            corner = dx and dy and (memory.solid[y, (x + dx) % SIDE] or memory.solid[(y + dy) % SIDE, x])
            if memory.distance[(y + dy) % SIDE, (x + dx) % SIDE] == left - 1 and not corner:
                x, y, left = (x + dx) % SIDE, (y + dy) % SIDE, left - 1
                heading, turned = heading + turn, turned + abs(turn)
                break
        else:
            break
    return turned


def turn(body: Body, memory: Any, gain: np.ndarray) -> int:
    """The turn to make now, in eighths counter-clockwise: to the best step with the fewest turns before and
    after it; at a viewpoint, to its heading.
    """
    far = away(memory.distance, memory.x, memory.y)
    if memory.kind == "search" and memory.look >= 0 and far == 0:
        return (memory.look - memory.heading) % 8
    best, span = [], look_ahead(body, memory.x, memory.y)
    for k in np.flatnonzero((gain == gain.max()) & (gain.max() > -1)):
        heading = (memory.heading + int(k)) % 8
        to = memory.x + span * WAYS[heading][0], memory.y + span * WAYS[heading][1]
        best.append((min(k, 8 - k) + turns_on(memory, *to, heading), k))
    return int(min(best)[1]) if best else 1


def stopped(body: Body, memory: Any, solid: np.ndarray) -> tuple[int, int] | None:
    """The node [y, x] that hinders a body which cannot go forward; None where known ones do."""
    (dx, dy), far = WAYS[memory.heading], body.step // 2 if body.touching else body.step
    if not passes(body, SimpleNamespace(solid=solid), memory.x, memory.y, dx, dy):
        return None
    x, y = memory.x + far * dx, memory.y + far * dy
    return (y + (dy > 0)) // 2 % SIDE, (x + (dx > 0)) // 2 % SIDE
