"""Common lines of walls: both faces of a wall, and all faces on one line, move to one place."""

from collections.abc import Sequence
from itertools import pairwise
from statistics import median
from typing import NamedTuple

import shapely
from shapely import Polygon

MAX_WALL_M = 0.4
"""Greatest thickness of a wall between two rooms, metres."""

MAX_OVERLAP_M = 0.05
"""Greatest overlap of two rooms that count as side by side, metres."""

THIN_WALL_M, MIN_FACING_M = 0.2, 0.1
"""Thickness above which the two faces of a wall must face each other, and over which length, metres."""


Places = dict[float, float]
"""New place of each line by its old place, metres."""


class Face(NamedTuple):
    """A wall seen from its room: its place across, its start and end along the wall, metres.

    ``is_far`` is True if the room lies at lesser places, west or north of the wall.
    """

    room: int
    place: float
    start: float
    end: float
    is_far: bool


def common_lines(shapes: Sequence[Polygon], noise: float) -> tuple[list[tuple[Places, Places]], float]:
    """Return the new places of each room's lines in x and in y, and the median thickness of walls, metres.

    Two faces at most ``MAX_WALL_M`` apart, with no room between them, are one wall and move to its middle.
    Faces within ``2 * noise`` metres of each other share a line. Outer walls get the median thickness.
    """
    walls = [_walls(shapes, axis, noise) for axis in (0, 1)]
    thick = [_thickness(wall) for each in walls for wall in each if len({face.is_far for face in wall}) == 2]
    half = max(0.0, median(thick)) / 2 if thick else 0.0
    found: list[tuple[Places, Places]] = [({}, {}) for _ in shapes]
    for axis in (0, 1):
        for wall in walls[axis]:
            place = _middle(wall, half)
            for face in wall:
                found[face.room][axis][face.place] = place
    return found, 2 * half


def _walls(shapes: Sequence[Polygon], axis: int, noise: float) -> list[list[Face]]:
    """Return the faces of each wall, on both of its sides."""
    tree = shapely.STRtree(list(shapes))
    faces = sorted(
        (face for room, shape in enumerate(shapes) for face in _faces(room, shape, axis)),
        key=lambda face: face.place,
    )
    # The two sides are grouped apart: a face of another wall may lie on the line of the opposite face.
    sides = [[face for face in faces if face.is_far == side] for side in (True, False)]
    groups = [group for side in sides for group in _groups(side, 2 * noise + 1e-6)]
    joined = list(range(len(groups)))

    def root(group: int) -> int:
        while joined[group] != group:
            group = joined[group]
        return group

    numbered = [(face, number) for number, group in enumerate(groups) for face in group]
    far, near = ([each for each in numbered if each[0].is_far == side] for side in (True, False))
    lines = [_along(axis, face.place, face.place, face) for face, _ in near]
    back = max(2 * noise, MAX_OVERLAP_M)
    reaches = [_along(axis, face.place - back, face.place + MAX_WALL_M, face) for face, _ in far]
    for which, beside in shapely.STRtree(lines).query(reaches, "dwithin", 1e-6).T if near and far else ():
        (one, its), (other, others) = far[which], near[beside]
        if its != others and _is_wall(one, other, noise) and not _between(one, other, axis, shapes, tree):
            joined[root(others)] = root(its)
    together: dict[int, list[Face]] = {}
    for face, number in numbered:
        together.setdefault(root(number), []).append(face)
    return list(together.values())


def _along(axis: int, place: float, end: float, face: Face) -> Polygon:
    """Return the box along a face that reaches from ``place`` to ``end``, across the face."""
    ends = (place, face.start, end, face.end) if axis == 0 else (face.start, place, face.end, end)
    return shapely.box(*ends)


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
    """Return groups of the faces that lie on one line, up to noise."""
    groups: list[list[Face]] = []
    for face in faces:
        last = groups[-1] if groups else []
        if not last or face.place - last[-1].place > within or face.place - last[0].place > 2 * within:
            groups.append([])
        groups[-1].append(face)
    return groups


def _is_wall(one: Face, other: Face, noise: float) -> bool:
    """Return True if the faces are the two sides of one wall: ``one`` of the room at lesser places."""
    if not one.is_far or other.is_far or one.room == other.room:
        return False
    along, apart = min(one.end, other.end) - max(one.start, other.start), other.place - one.place
    least = MIN_FACING_M if apart > THIN_WALL_M else 2 * noise
    return -max(2 * noise, MAX_OVERLAP_M) <= apart <= MAX_WALL_M and along > least


def _between(one: Face, other: Face, axis: int, shapes: Sequence[Polygon], tree: shapely.STRtree) -> bool:
    """Return True if another room lies between two faces."""
    low, high = max(one.start, other.start), min(one.end, other.end)
    ends = (one.place, low, other.place, high) if axis == 0 else (low, one.place, high, other.place)
    gap = shapely.box(*ends)
    if other.place - one.place < 0.02:
        return False
    near = (shapes[each] for each in tree.query(gap) if each not in (one.room, other.room))
    return any(each.intersection(gap).area > 0.5 * gap.area for each in near)


def _middle(wall: Sequence[Face], half: float) -> float:
    """Return the middle of a wall; without an opposite face, the middle lies ``half`` metres outwards."""
    far, near = (_mean([face for face in wall if face.is_far == side]) for side in (True, False))
    ends = [*([far] if far is not None else []), *([near] if near is not None else [])]
    if len(ends) == 2:
        return round(sum(ends) / 2, 4)
    return round(ends[0] + (half if far is not None else -half), 4)


def _thickness(wall: Sequence[Face]) -> float:
    far, near = (_mean([face for face in wall if face.is_far == side]) for side in (True, False))
    return (near or 0.0) - (far or 0.0)


def _mean(faces: Sequence[Face]) -> float | None:
    """Return the mean place of faces, weighted by their lengths."""
    length = sum(face.end - face.start for face in faces)
    return sum(face.place * (face.end - face.start) for face in faces) / length if faces else None
