"""Swings of doors: the free direction of each, and the places of the leaves of open doors.

Plans show the swings. Rules know only the squares around them (``rules/shared_walls/swings.pl``).
"""

import math
from typing import NamedTuple

import numpy as np

from vitruvius.logic.house.boxes import TOLERANCE, Box, distance, excess
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Room

Place = tuple[float, float]
"""Point, metres."""


class Leaf(NamedTuple):
    """Open door: it stands at right angles to the wall, from hinge to tip, as long as the door is wide."""

    room: str
    """Name of the room that the leaf swings into."""
    hinge: Place
    tip: Place
    jamb: Place
    """End of the doorway at which the tip is when the door is shut."""

    @property
    def swing(self) -> Box:
        """Square around the quarter of a circle that the leaf sweeps: (west, north, east, south), metres."""
        xs, ys = zip(self.hinge, self.tip, self.jamb, strict=True)
        return min(xs), min(ys), max(xs), max(ys)


MAX_MOVED = 3
"""Largest number of other doors whose leaves move, one out of the way of the next, for the leaf of a door."""

MAX_SETTLED = 300
"""Largest number of attempts in a house to move leaves for other doors, which bounds the time."""

MAX_NEAR = 8
"""Largest number of swings near a leaf whose quarter circles are compared; of more, the squares."""

POINTS = (np.stack(np.meshgrid(np.arange(12), np.arange(12)), axis=-1).reshape(-1, 2) + 0.5) / 12
"""Points of a unit square, by which the area that two swings share is estimated, shape (144, 2)."""


def door_leaves(house: House) -> list[Leaf]:
    """Return a leaf for each door that is no opening, in the order of ``house.doors``.

    The leaf swings into the room farther from the robot's start, with its hinge at the jamb nearer to a
    corner. If it would sweep over furniture, walls or another door's swing there, the leaf takes a free one
    of the other three ways. If none is free, the leaves of earlier doors move so that one becomes free. If
    that fails, too, the leaf takes the way that sweeps over least.
    """
    steps, rooms = _steps(house), {room.name: room for room in house.rooms}
    pieces = {room.name: [piece.box for piece in room.pieces] for room in house.rooms}
    leaves = _Leaves(len(house.doors))
    for door in house.doors:
        if door.opening:
            continue
        ways = sorted(
            _ways(door, house, rooms),
            key=lambda leaf: (-steps.get(leaf.room, 0), _from_corner(leaf, rooms[leaf.room].box)),
        )
        leaves.add(ways, [_swept(leaf, rooms[leaf.room].box, pieces[leaf.room]) for leaf in ways])
    return leaves.chosen


class _Leaves:
    """Leaves that are chosen so far, one of the possible leaves of each door."""

    def __init__(self, most: int) -> None:
        """Begin without doors. ``most``: largest number of doors that will follow."""
        self.chosen: list[Leaf] = []
        self._swings, self._into = np.empty((most, 4)), np.empty(most, object)
        self._free: list[list[Leaf]] = []  # leaves of each door over no furniture and no walls
        self._attempts = 0
        self._before: list[tuple[int, Leaf]] = []  # changes to undo: a door and its previous leaf

    def add(self, ways: list[Leaf], swept: list[float]) -> None:
        """Choose a leaf for one more door. ``ways``: its possible leaves, the preferred one first."""
        number = len(self.chosen)
        self._before.clear()
        self._free.append([leaf for leaf, depth in zip(ways, swept, strict=True) if depth == 0])
        self.chosen.append(ways[0])
        self._put(number, ways[0])
        if not self._settle(number, MAX_MOVED, ()):
            crossed = [self._crossed(number, leaf)[1].sum() for leaf in ways]
            self._put(number, ways[min(range(len(ways)), key=lambda way: (swept[way], crossed[way]))])

    def _settle(self, number: int, moves: int, settled: tuple[int, ...]) -> bool:
        """Choose a leaf of a door that crosses no other, or return False. Doors that are ``settled`` stay."""
        mark, settled = len(self._before), (*settled, number)
        self._attempts += bool(moves)
        moves = moves if self._attempts <= MAX_SETTLED else 0
        for most in sorted({0, moves}):
            for leaf in self._free[number]:
                others, _ = self._crossed(number, leaf)
                if len(others) > most or not set(settled).isdisjoint(others):
                    continue
                self._put(number, leaf)
                if all(self._settle(other, moves - len(others), settled) for other in others):
                    return True
                while len(self._before) > mark:
                    self._set(*self._before.pop())
        return False

    def _put(self, number: int, leaf: Leaf) -> None:
        self._before.append((number, self.chosen[number]))
        self._set(number, leaf)

    def _set(self, number: int, leaf: Leaf) -> None:
        self.chosen[number], self._swings[number], self._into[number] = leaf, leaf.swing, leaf.room

    def _crossed(self, number: int, leaf: Leaf) -> tuple[np.ndarray, np.ndarray]:
        """Return the doors whose swings a leaf of a door would cross, and the shared areas, square metres."""
        swing, count = leaf.swing, len(self.chosen)
        starts = np.maximum(self._swings[:count, :2], swing[:2])
        sides = np.minimum(self._swings[:count, 2:], swing[2:]) - starts
        near = np.flatnonzero((sides.min(axis=1) > TOLERANCE) & (self._into[:count] == leaf.room))
        near = near[near != number]
        areas = sides[near].prod(axis=1)
        if len(near) <= MAX_NEAR:
            for place, other in enumerate(near):
                points = starts[other] + POINTS * sides[other]
                common = _in_reach(leaf, points) & _in_reach(self.chosen[other], points)
                areas[place] *= common.mean()
        return near[areas > 0], areas[areas > 0]


def _steps(house: House) -> dict[str, int]:
    """Return for each room the least number of doors on the way from the robot's start."""
    steps, level = {house.start.name: 0}, [house.start.name]
    while level:
        following = [
            name
            for here in level
            for door in house.doors_of(here)
            for name in door.between
            if name not in (*steps, OUTSIDE)
        ]
        steps |= dict.fromkeys(following, steps[level[0]] + 1)
        level = [*dict.fromkeys(following)]
    return steps


def _ways(door: Door, house: House, rooms: dict[str, Room]) -> list[Leaf]:
    """Return the possible leaves of a door: into each of its rooms, with the hinge at each of its jambs."""
    ends = (door.x, door.y), (door.x + door.width, door.y + door.height)
    names = sorted(
        (name for name in door.between if name != OUTSIDE),
        key=lambda name: rooms[name] is house.main_room,
    )
    # A star's main room may reach under the room. Therefore the room decides on which side of the door it
    # lies, and the main room lies on the other side.
    box, across = rooms[names[0]].box, int(door.height == 0)
    side = 1 if (box[across] + box[across + 2]) / 2 > (door.x, door.y)[across] else -1
    reach = (0.0, side * door.length) if across else (side * door.length, 0.0)
    ways = []
    for name, sign in zip(names, (1, -1), strict=False):
        for hinge, jamb in (ends, ends[::-1]):
            tip = (hinge[0] + sign * reach[0], hinge[1] + sign * reach[1])
            off = sign * side * house.half_wall  # at the face of the wall
            points = ((x, y + off) if across else (x + off, y) for x, y in (hinge, tip, jamb))
            ways.append(Leaf(name, *points))
    return ways


def _swept(leaf: Leaf, room: Box, pieces: list[Box]) -> float:
    """Return the depth to which a leaf reaches into furniture or walls, metres."""
    (west, north, east, south), length = leaf.swing, math.dist(leaf.hinge, leaf.tip)
    point = (*leaf.hinge, *leaf.hinge)
    hit = [
        length - distance(point, (max(west, x0), max(north, y0), min(east, x1), min(south, y1)))
        for x0, y0, x1, y1 in pieces
        if min(east, x1) - max(west, x0) > TOLERANCE and min(south, y1) - max(north, y0) > TOLERANCE
    ]
    return max([excess(leaf.swing, room), *hit, TOLERANCE]) - TOLERANCE


def _in_reach(leaf: Leaf, points: np.ndarray) -> np.ndarray:
    """Return a mask (N,) of the points (N, 2), in the square around a swing, that the leaf sweeps over."""
    return np.hypot(*(points - leaf.hinge).T) < math.dist(leaf.hinge, leaf.tip)


def _from_corner(leaf: Leaf, room: Box) -> float:
    """Return the distance of the hinge from the nearer corner of the door's wall, metres."""
    axis = int(leaf.hinge[0] == leaf.jamb[0])
    return min(leaf.hinge[axis] - room[axis], room[axis + 2] - leaf.hinge[axis])
