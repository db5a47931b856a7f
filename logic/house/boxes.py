"""Plain geometry of axis-aligned boxes, with which the independent check measures."""

import math

from vitruvius.logic.house.parts import Rect

Box = tuple[float, float, float, float]
"""(west, north, east, south), metres. A segment has no width or no height."""

TOLERANCE = 1e-6
"""Difference between two lengths that count as equal, metres."""

WALLS = ("west", "north", "east", "south")
"""Walls of a box, in the order of its numbers. The walls ``k`` and ``(k + 2) % 4`` face each other."""

BACK = {"N": 3, "E": 0, "S": 1, "W": 2}
"""Index in ``WALLS`` of the wall behind a piece, by the direction of its front."""


def overlap(one: Box, other: Box) -> float:
    """Return the depth by which two boxes overlap, metres; negative if they are apart."""
    x = min(one[2], other[2]) - max(one[0], other[0])
    y = min(one[3], other[3]) - max(one[1], other[1])
    return min(x, y)


def distance(one: Box, other: Box) -> float:
    """Return the distance between two boxes, metres; 0 if they touch or overlap."""
    x = max(one[0], other[0]) - min(one[2], other[2])
    y = max(one[1], other[1]) - min(one[3], other[3])
    return math.hypot(max(0.0, x), max(0.0, y))


def front(door: Box, depth: float) -> Box:
    """Return the zone in front of a door and behind it, as wide as the door and ``depth`` metres deep."""
    west, north, east, south = door
    x, y = (depth, 0.0) if east - west < south - north else (0.0, depth)
    return west - x, north - y, east + x, south + y


def excess(inner: Box, outer: Box) -> float:
    """Return the distance by which a box juts out of another, metres; 0 or negative if it lies inside."""
    x = max(outer[0] - inner[0], inner[2] - outer[2])
    y = max(outer[1] - inner[1], inner[3] - outer[3])
    return max(x, y)


def is_on_wall(door: Rect, rect: Rect, wall: int) -> bool:
    """Return True if a door lies on a rectangle's wall, from end to end."""
    edge = list(rect.box)
    edge[(wall + 2) % 4] = edge[wall]
    return excess(door.box, (edge[0], edge[1], edge[2], edge[3])) <= TOLERANCE


def walls_touched(piece: Rect, room: Rect) -> list[int]:
    """Return the walls of a room that a piece inside it stands against."""
    return [wall for wall in range(4) if abs(piece.box[wall] - room.box[wall]) <= TOLERANCE]
