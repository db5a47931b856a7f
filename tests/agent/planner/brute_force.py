"""Small maps, and exhaustive searches of them by the words of ``docs/planner.md``.

A map is of 12 by 12 nodes, or blocks of them, somewhere on the torus, and solid all around. Nodes and blocks
are pairs, east and south.
"""

import heapq
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.agent.planner.adapter import SIDE
from vitruvius.sim.actions import HEADINGS

Place = tuple[int, int]

ACROSS = 12
"""Squares of a map along each axis."""

BEFORE, SINCE, AFTER = 10, 280, 290
"""Steps at which a cell was seen: before and after ``SINCE``, from when on a target may lie there."""


def small_map(random: np.random.Generator, solid: float, unit: int) -> SimpleNamespace:
    """Return a memory that holds such a map, seen of late.

    A share ``solid`` of its squares, ``unit`` nodes wide, is occupied. The start lies outside, in a room of
    one body.
    """
    x, y = 2 * random.integers(10, SIDE // 2 - 10 - ACROSS, 2)
    seen_at, near = np.full((SIDE, SIDE), AFTER), np.ones((SIDE, SIDE), bool)
    memory = SimpleNamespace(seen_at=seen_at, near=near, solid=near.copy(), occupied=~near, x=0, y=0)
    memory.occupied[np.ix_(range(-2, 2), range(-2, 2))] = True
    squares = random.random((ACROSS, ACROSS)) < solid
    wide = ACROSS * unit
    memory.solid[y : y + wide, x : x + wide] = squares.repeat(unit, 0).repeat(unit, 1)
    memory.nodes = {(int(i), int(j)) for j, i in np.argwhere(~memory.solid)}
    return memory


def about(x: int, y: int) -> set[Place]:
    """Return the nodes within half a cell of a pose in half cells."""
    return {((x + i) // 2, (y + j) // 2) for i, j in product((0, 1), repeat=2)}


def neighbours(node: Place, nodes: set[Place]) -> Iterator[tuple[int, Place]]:
    """Yield the headings of steps to free nodes, and these nodes: a diagonal step passes two free corners."""
    x, y = node
    for heading, (dx, dy) in enumerate(HEADINGS):
        if {(x + dx, y + dy), (x + dx, y), (x, y + dy)} <= nodes:
            yield heading, (x + dx, y + dy)


def distances(sources: Iterable[Any], beside: Callable[[Any], Iterable[Any]]) -> dict[Any, int]:
    """Return the steps to all reachable places, breadth-first."""
    found = dict.fromkeys(sources, 0)
    queue = deque(found)
    while queue:
        here = queue.popleft()
        for there in beside(here):
            if there not in found:
                found[there] = found[here] + 1
                queue.append(there)
    return found


def fewest_actions(start: tuple[Place, int], ends: set[Place], nodes: set[Place]) -> int:
    """Return the fewest steps and turns to one of some nodes, two steps an edge, by Dijkstra's search."""
    queue, done = [(0, start)], set()
    while queue:
        cost, (node, heading) = heapq.heappop(queue)
        if node in ends:
            return cost
        if (node, heading) not in done:
            done.add((node, heading))
            for way, there in neighbours(node, nodes):
                heapq.heappush(queue, (cost + 2 + turns(heading, way), (there, way)))
    raise ValueError("no way")


def turns(one: int, other: int) -> int:
    """Return the turns of 45 degrees from one heading to another."""
    return min((one - other) % 8, (other - one) % 8)


# - views ------------------------------------------------------------------------------------------


def hides(memory: Any, x: int, y: int) -> bool:
    """Return True if a target may lie around a node.

    Of the 4 by 4 cells that a target covers there, the inner ones and eight others were not seen since
    ``SINCE``.
    """
    unseen = [
        memory.seen_at[j, i] < SINCE and not memory.occupied[j, i]
        for j, i in product(range(y - 2, y + 2), range(x - 2, x + 2))
    ]
    return all(unseen[k] for k in (5, 6, 9, 10)) and sum(unseen) >= 12


def levels(memory: Any) -> dict[Place, int]:
    """Return the steps to each free block from the body's node: first east or west, then north or south."""
    free = {(x // 2, y // 2) for x, y in memory.nodes}

    def beside(block: Place) -> Iterator[Place]:
        x, y = block
        for dx in (0, 1, -1):
            if (x + dx, y) in free:
                yield from {(x + dx, y + dy) for dy in (0, 1, -1)} & free

    here = {(memory.x // 2 + i, memory.y // 2 + j) for i, j in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))}
    return distances({(x // 2, y // 2) for x, y in here & memory.nodes}, beside)


def candidates(memory: Any, level: dict[Place, int]) -> dict[Place, int]:
    """Return the weights of the places where a target may lie: 100 each, or those of a prior.

    After nine pick-ups in the start room a place of that room has weight 1, since no target is there.
    """
    places = {(x, y) for x, y in level if hides(memory, 2 * x, 2 * y)}
    if memory.prior is not None:
        return {(x, y): int(memory.prior[y, x] & 127) for x, y in places if memory.prior[y, x] & 127}
    return dict.fromkeys(places, 1 if memory.found == 9 else 100)


def looks(memory: Any, x: int, y: int, octant: int) -> Iterator[tuple[Place, int, float]]:
    """Yield the blocks in sight at an octant, by 5 rays, every other cell.

    With each block come its distance along the ray and the probability that sight reaches it.
    """

    def passes(i: int, j: int) -> float:
        """Return how likely sight passes a place: over unseen ground by the prior."""
        if memory.prior is None or memory.seen_at[j % SIDE, i % SIDE] > 0:
            return 1.0
        return 1.0 - float(memory.prior[j % SIDE // 2, i % SIDE // 2] >> 8) / 255

    for ray in range(-2, 3):
        angle, reaches = np.pi / 4 * (octant + ray / 5), passes(x, y)
        for k in range(1, 28):
            i, j = x + int(np.rint(2 * k * np.cos(angle))), y - int(np.rint(2 * k * np.sin(angle)))
            share, reaches = reaches, reaches * passes(i, j)
            if memory.solid[j % SIDE, i % SIDE] or memory.occupied[j % SIDE, i % SIDE] or reaches < 0.02:
                break
            yield (i % SIDE // 2, j % SIDE // 2), k, share


def views(memory: Any, level: dict[Place, int]) -> dict[tuple[Place, int], float]:
    """Return the values of the views from all viewpoints and from the robot's own node, by heading.

    A value is the information gain over the cost in steps and turns. Places already in sight gain nothing.
    """
    px, py, heading = memory.x // 2, memory.y // 2, memory.heading
    counts = candidates(memory, level)
    for octant in (-1, 0, 1):
        for block, _, _ in looks(memory, px, py, heading + octant):
            counts.pop(block, None)
    most, worth = min(60_000, sum(counts.values())), {}
    stands = {
        (2 * x, 2 * y): max(2 * steps - 1, abs(2 * x - px), abs(2 * y - py))
        for (x, y), steps in level.items()
        if steps and x % 2 == y % 2 == 0 and (memory.seen_at[2 * y, 2 * x] or memory.prior[y, x] & 128)
    }
    for (x, y), distance in {**stands, (px, py): 0}.items():
        octants = [
            sum(k * s * counts.get(block, 0) for block, k, s in looks(memory, x, y, o)) for o in range(8)
        ]
        bearing = round(np.arctan2(py - y, x - px) / (np.pi / 4)) % 8 if distance else heading
        for h in range(8):
            gain = min(most, np.pi / 20 * (octants[h - 1] + octants[h] + octants[(h + 1) % 8]))
            turned = turns(heading, bearing) + turns(bearing, h)
            if gain >= 200 and (distance or turned):
                worth[(x, y), h] = gain / (2 * distance + 4 + turned)
    return worth
