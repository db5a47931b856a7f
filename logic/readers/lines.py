"""Lines of walls: the two faces of a wall between rooms, and all that lies on one line, get one place."""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import shapely
from shapely import Polygon

MOST_WALL = 0.4
"""Metres: the thickest wall between two rooms."""

FACING = 0.1
"""Metres of two walls that must be opposite each other."""


class Face(NamedTuple):
    """A wall of a room as seen from it: where it is, from where to where it runs, and whether the room lies
    behind it, at lesser places.
    """

    room: int
    place: float
    start: float
    end: float
    is_far: bool


def common_lines(shapes: Sequence[Polygon], noise: float) -> list[Callable[[float], float]]:
    """For x and for y, where what is there lies when walls have no thickness.

    Two faces at most ``MOST_WALL`` apart, with no room between them, are one wall, in its middle; what lies
    ``2 * noise`` metres beside each other is one line.
    """
    found = []
    tree = shapely.STRtree(list(shapes))
    for axis in (0, 1):
        faces = sorted(
            (face for room, shape in enumerate(shapes) for face in _faces(room, shape, axis)),
            key=lambda face: face.place,
        )
        groups = _groups(faces, 2 * noise + 1e-6)
        joined = list(range(len(groups)))

        def root(group: int, joined: list[int] = joined) -> int:
            while joined[group] != group:
                group = joined[group]
            return group

        numbered = [(face, number) for number, group in enumerate(groups) for face in group]
        for one, its in numbered:
            if not one.is_far:
                continue
            for other, others in numbered:
                if (
                    its != others
                    and _is_wall(one, other, noise)
                    and not _between(one, other, axis, shapes, tree)
                ):
                    joined[root(others)] = root(its)
        together: dict[int, list[Face]] = {}
        for face, number in numbered:
            together.setdefault(root(number), []).append(face)
        places = {face.place: _middle(group) for group in together.values() for face in group}
        found.append(_nearest(places))
    return found


def _faces(room: int, shape: Polygon, axis: int) -> list[Face]:
    found = []
    for ring in (shape.exterior, *shape.interiors):
        for one, other in pairwise(ring.coords):
            if abs(one[axis] - other[axis]) > 1e-9:
                continue
            start, end = sorted((one[1 - axis], other[1 - axis]))
            middle = [0.0, 0.0]
            middle[axis], middle[1 - axis] = one[axis] - 1e-4, (start + end) / 2
            found.append(Face(room, one[axis], start, end, bool(shape.contains(shapely.Point(middle)))))
    return found


def _groups(faces: Sequence[Face], within: float) -> list[list[Face]]:
    """Faces that lie on one line, but for noise."""
    groups: list[list[Face]] = []
    for face in faces:
        last = groups[-1] if groups else []
        if not last or face.place - last[-1].place > within or face.place - last[0].place > 2 * within:
            groups.append([])
        groups[-1].append(face)
    return groups


def _is_wall(one: Face, other: Face, noise: float) -> bool:
    along = min(one.end, other.end) - max(one.start, other.start)
    apart = other.place - one.place
    return not other.is_far and one.room != other.room and -2 * noise <= apart <= MOST_WALL and along > FACING


def _between(one: Face, other: Face, axis: int, shapes: Sequence[Polygon], tree: shapely.STRtree) -> bool:
    """Whether another room lies between two faces."""
    low, high = max(one.start, other.start), min(one.end, other.end)
    ends = (one.place, low, other.place, high) if axis == 0 else (low, one.place, high, other.place)
    gap = shapely.box(*ends)
    if other.place - one.place < 0.02:
        return False
    near = (shapes[each] for each in tree.query(gap) if each not in (one.room, other.room))
    return any(each.intersection(gap).area > 0.5 * gap.area for each in near)


def _middle(group: Sequence[Face]) -> float:
    """Halfway between the mean place of faces on the one side and on the other, by their lengths."""
    means = []
    for is_far in (True, False):
        faces = [face for face in group if face.is_far == is_far]
        length = sum(face.end - face.start for face in faces)
        if faces:
            means.append(sum(face.place * (face.end - face.start) for face in faces) / length)
    return round(sum(means) / len(means), 4)


def _nearest(places: dict[float, float]) -> Callable[[float], float]:
    return lambda value: places[min(places, key=lambda place: abs(place - value))]
