"""Least main room that fits a house's rooms. The check compares the house's main room with it."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise, product

from vitruvius.logic.house.boxes import TOLERANCE, WALLS, is_on_wall
from vitruvius.logic.house.star import Star, StarRoom

MAX_SIDE_RATIO = 2.0
"""Largest ratio of the main room's length to its width."""


def side_of(star: Star, room: StarRoom) -> str | None:
    """Return the wall of the main room that a room touches from outside with its door, or None."""
    for index, wall in enumerate(WALLS):
        if is_on_wall(room.door, star.floor, index) and is_on_wall(room.door, room, (index + 2) % 4):
            return wall
    return None


def least_area(star: Star, room_gap: float = math.inf) -> float:
    """Return the area of the least main room that fits the house's rooms, square metres.

    The rooms keep their sizes, sides, order and the places of their doors. Neighbours, on a side or around a
    corner, come as near as ``room_gap`` (metres), or nearer if any two in this star do so. The wall of a side
    reaches from the first door to the last, since a room may stand out past the corner of the main room. If
    the side around the corner has rooms too, a room may stand out only if it does so in this star. The main
    room is no smaller than any room and at most twice as long as wide.

    Raises ``ValueError`` if a door is not on the main room's wall.
    """
    sides: dict[str, list[StarRoom]] = {wall: [] for wall in WALLS}
    for index, room in enumerate(star.rooms):
        wall = side_of(star, room)
        if wall is None:
            raise ValueError(f"R{index} ({room.type}): its door is not on the main room's wall")
        sides[wall].append(room)
    gaps = []
    for wall, chain in sides.items():
        low = _along(wall)
        chain.sort(key=lambda room: room.box[low])
        gaps += [after.box[low] - before.box[low + 2] for before, after in pairwise(chain)]
    for one, other in _corners(sides):
        gaps.append(max(_short_of(star, sides, one, other), _short_of(star, sides, other, one)))
    gap = max(0.0, min(*gaps, room_gap)) if gaps else 0.0
    needed = {wall: _needed_wall(star, wall, sides, gap) for wall in WALLS}
    return least_rectangle(
        max(needed["north"], needed["south"]),
        max(needed["west"], needed["east"]),
        max((room.area for room in star.rooms), default=0.0),
    )


def least_rectangle(width: float, height: float, area: float) -> float:
    """Return the least area of a rectangle with these least sides and area, at most twice as long as wide."""
    # A side is at least half the other. Beyond that, the rectangle can grow to any area in proportion.
    return max(max(width, height / MAX_SIDE_RATIO) * max(height, width / MAX_SIDE_RATIO), area)


def _needed_wall(star: Star, wall: str, sides: Mapping[str, list[StarRoom]], gap: float) -> float:
    """Return the least length of a wall of the main room that holds the doors of its rooms, metres."""
    chain = sides[wall]
    if not chain:
        return 0.0
    low = _along(wall)
    high = low + 2
    first, last = chain[0], chain[-1]
    length = sum(room.box[high] - room.box[low] for room in chain) + gap * (len(chain) - 1)
    for end, inset in (
        (low, first.door.box[low] - first.box[low]),
        (high, last.box[high] - last.door.box[high]),
    ):
        stands_out = not sides[WALLS[end]] or _short_of(star, sides, wall, WALLS[end]) < -TOLERANCE
        length += -inset if stands_out else gap
    return length


def _corners(sides: Mapping[str, list[StarRoom]]) -> Iterator[tuple[str, str]]:
    """Yield the corners of the main room that have rooms on both sides."""
    for one, other in product(("west", "east"), ("north", "south")):
        if sides[one] and sides[other]:
            yield one, other


def _short_of(star: Star, sides: Mapping[str, list[StarRoom]], wall: str, other: str) -> float:
    """Return the distance from the last room on a wall to the corner with the other wall, metres.

    The distance is negative if the room reaches past the corner.
    """
    end = WALLS.index(other)
    edge = star.floor.box[end]
    return min(room.box[end] - edge if end < 2 else edge - room.box[end] for room in sides[wall])


def _along(wall: str) -> int:
    """Return the index in a box at which a wall begins: 0 (west) for a wall along x, 1 (north) along y."""
    return 0 if wall in {"north", "south"} else 1
