"""Doorways of a floor that is drawn as one outline: gaps between the end of a wall and the next wall."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Geometry, Point, Polygon
from shapely.geometry.polygon import orient

from vitruvius.logic.shapes.corners import parts_of

NOISE_M = 0.03
"""Tolerance of the simplified outlines, metres, which turns bevels into corners."""

WALL_M = 0.04, 0.4
"""Least and greatest thickness of a wall that ends in the floor, metres."""

GAP_M = 0.45, 3.0
"""Least and greatest width of a gap from the end of a wall to the next wall, metres."""

SAME_LINE_M = 1e-3
"""Distance of two lines that count as one, metres."""

MIN_ROOM_M2 = 0.5
"""Least area of a room, square metres."""

DIVIDING_WALL_M = 1.5
"""Length of a wall that divides two rooms, whatever the gap at its end, metres."""

REACH_M = 0.05
"""Distance that a doorway reaches into the walls beside it, past their bevels, metres."""


class Doorway(NamedTuple):
    """A gap at the end of a wall. ``shape`` is the gap extended past the bevels; ``width`` is in metres."""

    gap: Polygon
    shape: Polygon
    width: float
    is_facing: bool
    """True if another wall ends on the other side of the gap."""
    beside: tuple[Point, Point]
    """Points on both sides of the wall, ``DIVIDING_WALL_M`` metres from its end."""


IsOne = Callable[[Polygon, Polygon, Doorway], bool]
"""Predicate that is True if the two rooms beside a doorway are one room."""


def cut(floor: Geometry, doorways: Sequence[Doorway], is_one: IsOne) -> tuple[list[Polygon], list[Doorway]]:
    """Return the rooms of a floor and those of its ``doorways_of`` that lie between them.

    A gap that leads from a room to itself, or to a floor smaller than a room, is not a doorway.
    """
    rooms = parts_of(shapely.difference(floor, shapely.union_all([each.shape for each in doorways])))
    tree, whole = shapely.STRtree(rooms), list(range(len(rooms)))

    def root(room: int) -> int:
        while whole[room] != room:
            room = whole[room]
        return room

    between = list[tuple[Doorway, list[int]]]()
    for doorway in sorted(doorways, key=lambda each: each.width, reverse=True):
        beside = sorted({root(each) for each in tree.query(doorway.shape, "dwithin", 1e-6)})
        edge = doorway.shape.boundary.buffer(SAME_LINE_M)
        open_to = [(rooms[each] & edge).area / SAME_LINE_M for each in beside]
        sides = [room for room, length in zip(beside, open_to, strict=True) if length > doorway.width / 2]
        areas = [rooms[each].area for each in sides]
        is_two = len(sides) == 2 and min(areas) > MIN_ROOM_M2
        both = [rooms[each] for each in sides]
        if is_two and (_divides(doorway, both[0], both[1]) or not is_one(both[0], both[1], doorway)):
            between.append((doorway, sides))
        elif beside:
            joined = shapely.union_all(
                [shapely.intersection(floor, doorway.shape), *(rooms[each] for each in beside)]
            )
            rooms[beside[0]] = max(parts_of(joined), key=lambda part: part.area)
            whole = [beside[0] if root(each) in beside else each for each in whole]
    kept = [doorway for doorway, sides in between if len({root(each) for each in sides}) == 2]
    return [room for k, room in enumerate(rooms) if root(k) == k and room.area > MIN_ROOM_M2], kept


def _divides(doorway: Doorway, one: Polygon, other: Polygon) -> bool:
    """Return True if a long wall, at whose end the doorway is, stands between the two rooms."""
    left, right = doorway.beside
    return any(one.contains(a) and other.contains(b) for a, b in ((left, right), (right, left)))


def doorways_of(floor: Geometry) -> list[Doorway]:
    """Return the gaps at the ends of all walls.

    Of gaps that overlap, only the narrowest is returned: a gap between two ends is found from both.
    """
    found = list[Doorway]()
    for part in parts_of(floor):
        plain = orient(shapely.simplify(part, NOISE_M))
        rings = [shapely.get_coordinates(ring) for ring in (plain.exterior, *plain.interiors)]
        walls = np.concatenate([np.stack([ring[:-1], ring[1:]], 1) for ring in rings])
        for ring in rings:
            found += _of_ring(ring, _tree(walls))
    found.sort(key=lambda each: (each.width, not each.is_facing))
    shapes = np.array([each.shape for each in found], object)
    one, other = shapely.STRtree(shapes).query(shapes, "intersects")
    is_much = shapely.area(shapely.intersection(shapes[one], shapes[other])) > WALL_M[0] ** 2
    overlap: dict[int, list[int]] = {}
    for a, b in zip(one[is_much].tolist(), other[is_much].tolist(), strict=True):
        overlap.setdefault(a, []).append(b)
    kept = set[int]()
    for k in range(len(found)):
        if not kept.intersection(overlap[k]):
            kept.add(k)
    return [found[k] for k in sorted(kept)]


def _tree(lines: np.ndarray) -> shapely.STRtree:
    """Return the spatial index of segments (S, 2, 2)."""
    segments: Any = shapely.linestrings(lines)
    return shapely.STRtree(segments)


def _of_ring(corners: np.ndarray, walls: shapely.STRtree) -> list[Doorway]:
    """Return the gaps at the ends of walls along a ring (C + 1, 2), metres, with the floor to its left."""
    sides = np.diff(corners, axis=0)
    length = np.hypot(*sides.T)
    before = np.roll(sides, 1, 0)
    turn = (before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0]) / (length * np.roll(length, 1))
    ends = (turn < -0.7) & (np.roll(turn, -1) < -0.7) & (length > WALL_M[0]) & (length < WALL_M[1])
    start, along, thick = corners[:-1][ends], sides[ends], length[ends]
    way = np.stack([-along[:, 1], along[:, 0]], 1) / thick[:, None]
    # Noise tilts short sides, but walls run along the axes.
    way = np.where(abs(way).max(1, keepdims=True) > 0.95, np.round(way), way)
    reach = np.stack([_reach(start + share * along, way, walls) for share in (0.15, 0.85)])
    is_gap = (reach.min(0) > GAP_M[0]) & (reach.max(0) < GAP_M[1]) & (np.ptp(reach, 0) < WALL_M[1])
    tips = _tree(np.stack([start, start + along], 1))
    found = []
    for k in np.flatnonzero(is_gap):
        width = float(reach[:, k].max())
        gap, shape = (_beside(start[k], along[k], way[k], -more, width + more) for more in (0.0, REACH_M))
        opposite = Point(start[k] + along[k] / 2 + width * way[k])
        is_facing = len(tips.query(opposite, "dwithin", thick[k])) > 0
        back = start[k] - DIVIDING_WALL_M * way[k]
        beside = Point(back - along[k]), Point(back + 2 * along[k])
        found.append(Doorway(gap, shape, width, is_facing, beside))
    return found


def _beside(start: np.ndarray, along: np.ndarray, way: np.ndarray, near: float, far: float) -> Polygon:
    """Return the rectangle in front of the end of a wall, from ``near`` to ``far`` metres away."""
    low, high = start + near * way, start + far * way
    return Polygon([low, low + along, high + along, high])


def _reach(start: np.ndarray, way: np.ndarray, walls: shapely.STRtree) -> np.ndarray:
    """Return the distances (P,) from points (P, 2) to walls along directions (P, 2), metres, up to WIDTH."""
    rays: Any = shapely.linestrings(np.stack([start + 0.01 * way, start + GAP_M[1] * way], 1))
    ray, wall = walls.query(rays, "intersects")
    met = shapely.intersection(rays[ray], walls.geometries[wall])
    found = np.full(len(rays), GAP_M[1])
    np.minimum.at(found, ray, shapely.distance(shapely.points(start[ray]), met))
    return found
