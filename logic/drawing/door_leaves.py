"""Swings of doors: the free direction of each, and the places of the leaves of open doors.

Plans show the swings; no rule uses them.
"""

import math
from typing import NamedTuple

import numpy as np

from vitruvius.logic.house.boxes import TOLERANCE, Box, distance, excess, overlap
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


def door_leaves(house: House) -> list[Leaf]:
    """Return a leaf for each door that is no opening, in the order of ``house.doors``.

    The leaf swings into the room farther from the robot's start, with its hinge at the jamb nearer to a
    corner. If it would sweep over furniture, walls or another door's swing there, the leaf takes one of the
    other three ways that is free. If none is free, it takes the way that sweeps over least.
    """
    steps, rooms = _steps(house), {room.name: room for room in house.rooms}
    pieces = {room.name: [piece.box for piece in room.pieces] for room in house.rooms}
    leaves: list[Leaf] = []
    swings, into = np.empty((len(house.doors), 4)), np.empty(len(house.doors), object)
    for door in house.doors:
        if door.opening:
            continue
        ways = sorted(
            _ways(door, house, rooms),
            key=lambda leaf: (-steps.get(leaf.room, 0), _from_corner(leaf, rooms[leaf.room].box)),
        )
        swept: list[tuple[float, float]] = []
        for leaf in ways:
            others = swings[: len(leaves)][into[: len(leaves)] == leaf.room]
            swept.append(_swept(leaf, rooms[leaf.room].box, pieces[leaf.room], others))
            if swept[-1] == (0, 0):
                break
        leaf = ways[swept.index(min(swept))]
        swings[len(leaves)], into[len(leaves)] = leaf.swing, leaf.room
        leaves.append(leaf)
    return leaves


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


def _swept(leaf: Leaf, room: Box, pieces: list[Box], others: np.ndarray) -> tuple[float, float]:
    """Return the depth of a leaf in furniture and walls, and in the swings ``others`` (N, 4), metres."""
    swing, length = leaf.swing, math.dist(leaf.hinge, leaf.tip)
    point = (*leaf.hinge, *leaf.hinge)
    hit = [length - distance(point, piece) for piece in pieces if overlap(swing, piece) > TOLERANCE]
    deep = np.minimum(others[:, 2:], swing[2:]) - np.maximum(others[:, :2], swing[:2])
    crossed = float(deep.min(axis=1).max(initial=TOLERANCE))
    return max([excess(swing, room), *hit, TOLERANCE]) - TOLERANCE, crossed - TOLERANCE


def _from_corner(leaf: Leaf, room: Box) -> float:
    """Return the distance of the hinge from the nearer corner of the door's wall, metres."""
    axis = int(leaf.hinge[0] == leaf.jamb[0])
    return min(leaf.hinge[axis] - room[axis], room[axis + 2] - leaf.hinge[axis])
