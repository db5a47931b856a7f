"""Boxes of rooms as tuples of numbers: which walls they share, and what of their sides is an outer wall.

All by geometry alone: nothing here knows how a house was made.
"""

from collections.abc import Iterable, Iterator, Sequence

Box = tuple[float, float, float, float]
"""(west, north, east, south), metres; x grows east, y grows south."""

SIDES = ("west", "north", "east", "south")
"""In the order of a box."""

CLOSE = 1e-3
"""Metres: what is nearer lies on one line."""


def shared(one: Box, other: Box) -> tuple[str, float, float] | None:
    """The side of a box at which it shares a wall with another, and where along it; None where they share
    none.
    """
    for number, side in enumerate(SIDES):
        low, high = overlap(one, other, 1 - number % 2)
        if abs(one[number] - other[(number + 2) % 4]) < CLOSE < high - low:
            return side, low, high
    return None


def contact(one: Box, other: Box) -> float:
    """How much wall two boxes share, metres."""
    found = shared(one, other)
    return found[2] - found[1] if found else 0.0


def overlap(one: Box, other: Box, axis: int) -> tuple[float, float]:
    """From where to where two boxes lie side by side along x (0) or y (1): an end before its start where they
    do not.
    """
    return max(one[axis], other[axis]), min(one[axis + 2], other[axis + 2])


def cover(one: Box, other: Box) -> bool:
    """Whether two boxes have more in common than a line."""
    return all(high - low > CLOSE for low, high in (overlap(one, other, axis) for axis in (0, 1)))


def around(boxes: Iterable[Box]) -> Box:
    """The outline of boxes."""
    west, north, east, south = zip(*boxes, strict=True)
    return min(west), min(north), max(east), max(south)


def area(box: Box) -> float:
    """Square metres."""
    return (box[2] - box[0]) * (box[3] - box[1])


def outer_parts(boxes: Sequence[Box], place: int) -> Iterator[tuple[str, float, float]]:
    """The parts of a box's sides at which no other of the boxes lies: the side, from where to where."""
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
