"""Walls of a house: segments, each once, with gaps at the doors between rooms.

For walls with a thickness the segments are the faces around the floor that the robot may enter, rooms and
doorways. Windows and the doors to the outside are shut: neither a ray nor a robot passes there.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.parts import Door, Rect, Room
from vitruvius.logic.house.star import StarRoom

Interval = tuple[float, float]

Line = tuple[float, float, float]
"""Place of a wall across its own axis, and its start and end along the axis, metres."""


def walls_of_rooms(
    rooms: Iterable[Room], doors: Iterable[Door], half: float = 0.0
) -> tuple[list[Line], list[Line]]:
    """Return the walls of adjacent rooms: those that run north to south, then west to east.

    Walls on one line are joined, so that a wall that two rooms share occurs once, and each door is cut out of
    it. ``half``: half the thickness of inner walls, metres; for thick walls the result is their faces.
    """
    if half:
        return _faces(list(rooms), [door for door in doors if not door.is_entrance], half)
    boxes, found = [room.box for room in rooms], []
    open_doors = [door.box for door in doors if not door.is_entrance]
    for axis in (0, 1):
        edges = sorted((box[end], *_span(box, axis)) for box in boxes for end in (axis, axis + 2))
        lines: list[tuple[float, list[Interval]]] = []
        for at, low, high in edges:
            if not lines or at - lines[-1][0] > TOLERANCE:
                lines.append((at, []))
            lines[-1][1].append((low, high))
        walls = []
        for at, spans in lines:
            gaps = [
                _span(door, axis)
                for door in open_doors
                if door[axis] == door[axis + 2] and abs(door[axis] - at) <= TOLERANCE
            ]
            walls += [(at, *left) for span in _joined(spans) for left in remaining(span, gaps)]
        found.append(walls)
    return found[0], found[1]


def doorway(door: Rect, half: float) -> Box:
    """Return the box of a door or window within its wall, half of which lies on each side, metres."""
    west, north, east, south = door.box
    return (
        (west - half, north, east + half, south) if door.height else (west, north - half, east, south + half)
    )


def _faces(rooms: list[Room], doors: list[Door], half: float) -> tuple[list[Line], list[Line]]:
    """Return the sides of rooms without their doors, and the jambs of each door."""
    found: tuple[list[Line], list[Line]] = [], []
    ways = [(int(not door.height), doorway(door, half)) for door in doors]
    for axis in (0, 1):
        for box in (room.box for room in rooms):
            for at in box[axis::2]:
                gaps = [_span(way, axis) for k, way in ways if k == axis and near(at, way[axis::2])]
                found[axis].extend((at, *left) for left in remaining(_span(box, axis), gaps))
        for low, high, jambs in (
            (way[axis], way[axis + 2], _span(way, axis)) for k, way in ways if k == axis
        ):
            found[1 - axis].extend((at, low, high) for at in jambs)
    return found


def near(at: float, places: Iterable[float]) -> bool:
    """Return True if a line is at one of these places, to within the tolerance."""
    return any(abs(at - place) <= TOLERANCE for place in places)


def walls_of_star(floor: Rect, rooms: Sequence[StarRoom]) -> tuple[list[Line], list[Line]]:
    """Return the walls of a star: every room's boundary without its door, and the rest of the main room's.

    Rooms may touch the main room from outside, as in ``vitruvius-1``, or overlap it, as in the original's
    files.
    """
    verticals: list[Line] = []
    horizontals: list[Line] = []
    for room in rooms:
        west, north, east, south = room.box
        doorway_x, doorway_y, doorway_east, doorway_south = room.door.box
        door_x = min(west, east, key=lambda x: abs(x - doorway_x)) if room.door.width == 0 else None
        door_y = min(north, south, key=lambda y: abs(y - doorway_y)) if room.door.height == 0 else None
        for x in (west, east):
            gaps = [(doorway_y, doorway_south)] if x == door_x else []
            verticals += [(x, *span) for span in remaining((north, south), gaps)]
        for y in (north, south):
            gaps = [(doorway_x, doorway_east)] if y == door_y else []
            horizontals += [(y, *span) for span in remaining((west, east), gaps)]
    west, north, east, south = floor.box
    boxes = [room.box for room in rooms]
    for x in (west, east):
        covers = [(b[1], b[3]) for b in boxes if b[0] - TOLERANCE <= x <= b[2] + TOLERANCE]
        verticals += [(x, *span) for span in remaining((north, south), covers)]
    for y in (north, south):
        covers = [(b[0], b[2]) for b in boxes if b[1] - TOLERANCE <= y <= b[3] + TOLERANCE]
        horizontals += [(y, *span) for span in remaining((west, east), covers)]
    return verticals, horizontals


def _span(box: tuple[float, float, float, float], axis: int) -> Interval:
    """Return the interval of a box along the other axis."""
    return box[1 - axis], box[3 - axis]


def _joined(spans: Iterable[Interval]) -> list[Interval]:
    """Return the spans of one line, in order, with touching spans joined."""
    joined: list[Interval] = []
    for low, high in sorted(spans):
        if joined and low - joined[-1][1] <= TOLERANCE:
            joined[-1] = joined[-1][0], max(joined[-1][1], high)
        else:
            joined.append((low, high))
    return joined


def remaining(span: Interval, gaps: Iterable[Interval]) -> list[Interval]:
    """Return the parts of a span outside the gaps, in order."""
    low, high = span
    left = []
    for start, end in sorted(gaps):
        if start - low > TOLERANCE:
            left.append((low, min(start, high)))
        low = max(low, end)
        if low >= high:
            break
    if high - low > TOLERANCE:
        left.append((low, high))
    return left


def crossing(at: float, end: float, others: np.ndarray) -> bool:
    """Return True if a wall at ``at`` meets one of ``others`` (N, 3), which run across it, at its ``end``."""
    places, low, high = others.reshape(-1, 3).T
    return bool(((abs(places - end) <= TOLERANCE) & (low - TOLERANCE <= at) & (at <= high + TOLERANCE)).any())
