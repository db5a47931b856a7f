"""Walls with a thickness, independent of generation: plans that get walls, and the faces of walls."""

from bisect import bisect_left, bisect_right
from typing import TypeVar

import shapely
from msgspec import structs

from vitruvius.logic import House, Rect
from vitruvius.logic.house.promises import Thickness

R = TypeVar("R", bound=Rect)


def thickened(house: House, inner: float = 0.3, outer: float = 0.6) -> House:
    """Return a plan with walls of a thickness.

    Each line of walls becomes as wide as an inner wall, and everything beyond moves away. Edges on a grid of
    cells as wide as inner walls stay on it.
    """
    lines = [
        sorted({round(edge, 9) for room in house.rooms for edge in room.box[axis::2]}) for axis in (0, 1)
    ]

    def placed(rect: Rect, axis: int) -> tuple[float, float]:
        low, high = round(rect.box[axis], 9), round(rect.box[axis + 2], 9)
        first, last = bisect_right(lines[axis], low) - 1, bisect_left(lines[axis], high) - 1
        if low == high:
            return low + inner * (first - 0.5), 0.0
        return low + inner * first, high - low + inner * (last - first)

    def moved(rect: R) -> R:
        (x, width), (y, height) = placed(rect, 0), placed(rect, 1)
        numbers = {"x": x, "y": y, "width": width, "height": height}
        return structs.replace(rect, **{name: round(value, 9) for name, value in numbers.items()})

    rooms = [moved(room) for room in house.rooms]
    rooms = [structs.replace(room, children=tuple(map(moved, room.children))) for room in rooms]
    parts = tuple(rooms), tuple(map(moved, house.doors)), tuple(map(moved, house.windows))
    return House(*parts, house.hub, house.topology, wall_thickness=Thickness(inner, outer))


def faces(house: House) -> shapely.Geometry:
    """Return the boundary of the space of bodies: rooms and doorways, which overlap slightly."""
    assert house.wall_thickness
    half = house.wall_thickness.inner / 2 + 1e-9
    parts = [shapely.box(*room.box) for room in house.rooms]
    for door in house.doors:
        if "outside" not in door.between:
            west, north, east, south = door.box
            x, y = (half, 0) if west == east else (0, half)
            parts.append(shapely.box(west - x, north - y, east + x, south + y))
    return shapely.union_all(parts).boundary
