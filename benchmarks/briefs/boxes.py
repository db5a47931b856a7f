"""Boxes of rooms as tuples of numbers: shared walls, and outer parts of sides.

Everything follows from the geometry only; this module does not know how a house was made.
"""

from collections.abc import Iterable, Iterator, Sequence

Box = tuple[float, float, float, float]
"""(west, north, east, south), metres; x grows east, y grows south."""

SIDES = ("west", "north", "east", "south")
"""Names of the sides, in the order of a box."""

CLOSE = 1e-3
"""Largest distance between two lines that count as one line, in metres."""


def shared(one: Box, other: Box) -> tuple[str, float, float] | None:
    """Return the side of a box that shares a wall with another box, and where along the side.

    Return None without a shared wall.
    """
    for number, side in enumerate(SIDES):
        low, high = overlap(one, other, 1 - number % 2)
        if abs(one[number] - other[(number + 2) % 4]) < CLOSE < high - low:
            return side, low, high
    return None


def contact(one: Box, other: Box) -> float:
    """Return the length of the wall that two boxes share, in metres."""
    found = shared(one, other)
    return found[2] - found[1] if found else 0.0


def overlap(one: Box, other: Box, axis: int) -> tuple[float, float]:
    """Return the interval in which two boxes lie side by side along x (0) or y (1).

    If they do not, the end is before the start.
    """
    return max(one[axis], other[axis]), min(one[axis + 2], other[axis + 2])


def cover(one: Box, other: Box) -> bool:
    """Return True if two boxes have more in common than a line."""
    return all(high - low > CLOSE for low, high in (overlap(one, other, axis) for axis in (0, 1)))


def around(boxes: Iterable[Box]) -> Box:
    """Return the outline of boxes."""
    west, north, east, south = zip(*boxes, strict=True)
    return min(west), min(north), max(east), max(south)


def area(box: Box) -> float:
    """Return the area in square metres."""
    return (box[2] - box[0]) * (box[3] - box[1])


def outer_parts(boxes: Sequence[Box], place: int) -> Iterator[tuple[str, float, float]]:
    """Yield the parts of a box's sides at which no other box lies: the side, the start and the end."""
    box = boxes[place]
    for number, side in enumerate(SIDES):
        along = 1 - number % 2
        walls = [shared(box, other) for other in boxes if other is not box]
        taken = sorted((low, high) for name, low, high in filter(None, walls) if name == side)
        at = box[along]
        for low, high in (*taken, (box[along + 2], box[along + 2])):
            if low - at > CLOSE:
                yield side, at, low
            at = max(at, high)
