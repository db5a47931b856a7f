"""Polygons along the axes: noisy corners become right angles, and polygons are cut into boxes."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from math import hypot
from typing import NamedTuple

import numpy as np
import shapely
from shapely import Geometry, Polygon

from vitruvius.logic.errors import RequestError

MAX_CHAMFER_M = 0.5
"""Greatest length of a diagonal wall that becomes a corner, metres."""

MOST_CORNERS = 200
"""Number of corners of a room, including steps that are noise."""

GRID_M = 1e-4
"""Rounding of the places of walls, metres, which keeps sides along the axes."""

MAX_LEAN_FRACTION, MAX_LEAN_M = 0.05, 0.08
"""Greatest lean of a wall from end to end: a fraction of its length plus noise, and metres in any case."""

Point = tuple[float, float]


class Side(NamedTuple):
    """A wall of a room along an axis: ``axis`` 0 for one that runs north to south, at an x."""

    axis: int
    place: float
    length: float


def squared(name: str, shape: Polygon, noise: float) -> Polygon:
    """Return the polygon with all walls along the axes. Corners may be off by ``noise`` metres.

    Raises ``RequestError`` for a diagonal wall and for an arc, with the room's name and the place.
    """
    rings = [shape.exterior, *(each for each in shape.interiors if Polygon(each).area > (4 * noise) ** 2)]
    plain = [shapely.simplify(ring, 2 * noise) for ring in rings]
    shell, *holes = (_ring(name, [(x, y) for x, y, *_ in ring.coords[:-1]], noise) for ring in plain)
    found = shapely.set_precision(Polygon(shell, holes), GRID_M, mode="pointwise")
    if not found.is_valid or found.is_empty:
        x, y = shape.representative_point().coords[0]
        raise RequestError(
            f"plan: the outline of {name} at x {x:.2f}, y {y:.2f} m crosses itself: draw it again"
        )
    return found


def _ring(name: str, corners: Sequence[Point], noise: float) -> list[Point]:
    sides = _along(_sides(name, corners, noise))
    if len(sides) > MOST_CORNERS:
        raise RequestError(
            f"plan: {name} has {len(sides)} corners: at most {MOST_CORNERS} are read: draw it with fewer"
        )
    jog = max(0.05, 3 * noise)
    while len(sides) > 4:
        # A step no larger than noise is no step: the walls beside it are one wall.
        least = min(range(len(sides)), key=lambda at: _reach(sides, at))
        if _reach(sides, least) > jog:
            break
        sides = _along([side for at, side in enumerate(sides) if at != least])
    if len(sides) < 4:
        return []
    corners = []
    for one, other in pairwise([sides[-1], *sides]):
        corners.append((one.place, other.place) if one.axis == 0 else (other.place, one.place))
    return corners


def _reach(sides: Sequence[Side], at: int) -> float:
    """Return the length of a side between its neighbours."""
    return abs(sides[at - 1].place - sides[(at + 1) % len(sides)].place)


def _sides(name: str, corners: Sequence[Point], noise: float) -> list[Side]:
    """Return the walls between corners; a short diagonal becomes two walls."""
    found, diagonals = list[Side](), list[tuple[Point, Point]]()
    for one, other in pairwise([*corners, corners[0]]):
        x, y = abs(other[0] - one[0]), abs(other[1] - one[1])
        if min(x, y) <= max(MAX_LEAN_M, 2.5 * noise + MAX_LEAN_FRACTION * max(x, y)) and min(
            x, y
        ) < 0.5 * max(x, y):
            axis = int(x > y)
            found.append(Side(axis, (one[axis] + other[axis]) / 2, max(x, y)))
        elif hypot(x, y) <= MAX_CHAMFER_M:
            found += [Side(0, one[0], y), Side(1, other[1], x)]
        else:
            diagonals.append((one, other))
    if diagonals:
        raise RequestError(
            f"plan: {name} has {_diagonal(diagonals)}: draw it as steps along the axes, or as a box"
        )
    return found


def _diagonal(diagonals: Sequence[tuple[Point, Point]]) -> str:
    (x, y), end = diagonals[0]
    arc = len(diagonals) > 3 and all(one[1] == other[0] for one, other in pairwise(diagonals[:4]))
    if arc:
        end = diagonals[-1][1]
    what = "an arc" if arc else "a diagonal wall"
    return f"{what} from x {x:.2f}, y {y:.2f} to x {end[0]:.2f}, y {end[1]:.2f} m"


def _along(sides: Sequence[Side]) -> list[Side]:
    """Merge consecutive sides along one axis into one side, at the mean of their places."""
    found: list[Side] = []
    for side in sides:
        if found and found[-1].axis == side.axis:
            found[-1] = _joined(found[-1], side)
        else:
            found.append(side)
    if len(found) > 1 and found[0].axis == found[-1].axis:
        found[0] = _joined(found.pop(), found[0])
    return found


def _joined(one: Side, other: Side) -> Side:
    length = one.length + other.length
    return Side(one.axis, (one.place * one.length + other.place * other.length) / (length or 1.0), length)


def parts_of(shape: Geometry) -> list[Polygon]:
    """Return the polygons of a geometry, without its lines and points."""
    return [part for part in shapely.get_parts(shape) if isinstance(part, Polygon)]


def size_of(box: Polygon) -> str:
    """Return the width and the height of a box, as in ``3.20 by 4.05 m``."""
    west, north, east, south = box.bounds
    return f"{east - west:.2f} by {south - north:.2f} m"


def moved(shape: Polygon, lines: tuple[Mapping[float, float], Mapping[float, float]]) -> Polygon:
    """Return the polygon with its corners moved: new places by old places, in x and in y."""

    def ring(corners: Iterable[Sequence[float]]) -> list[Point]:
        return [(lines[0][x], lines[1][y]) for x, y in corners]

    return Polygon(ring(shape.exterior.coords), [ring(each.coords) for each in shape.interiors])


def boxes(shape: Polygon) -> Iterator[Polygon]:
    """Yield the boxes of an axis-aligned polygon: the largest, then the largest in the rest, and so on."""
    rest = shape
    while rest.area > 1e-6:
        box = _largest(rest)
        yield box
        rest = shapely.difference(rest, box, grid_size=1e-9)


def _largest(shape: shapely.Geometry) -> Polygon:
    """Return the largest box in one or several polygons, with its sides on lines of their corners."""
    corners = shapely.get_coordinates(shape)
    xs, ys = (sorted({round(float(each), 9) for each in corners[:, k]}) for k in (0, 1))
    middles = ([(a + b) / 2 for a, b in pairwise(each)] for each in (xs, ys))
    grid = shapely.contains_xy(shape, *np.meshgrid(*middles)).tolist()
    best = (0.0, shapely.box(0, 0, 0, 0))
    for top in range(len(grid)):
        free = [True] * len(grid[0])
        for bottom in range(top, len(grid)):
            free = [one and other for one, other in zip(free, grid[bottom], strict=True)]
            for left, right in _runs(free):
                area = (xs[right] - xs[left]) * (ys[bottom + 1] - ys[top])
                if area > best[0] + 1e-9:
                    best = area, shapely.box(xs[left], ys[top], xs[right], ys[bottom + 1])
    return best[1]


def _runs(free: Sequence[bool]) -> Iterator[tuple[int, int]]:
    """Yield the start and end of each run of free columns."""
    start = None
    for at, is_free in enumerate([*free, False]):
        if is_free and start is None:
            start = at
        elif not is_free and start is not None:
            yield start, at
            start = None
