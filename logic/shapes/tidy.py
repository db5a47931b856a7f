"""Removal of slivers and of walls that project into a room, and search for open borders between rooms."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import shapely
from shapely import Polygon

from vitruvius.logic.house.boxes import Box
from vitruvius.logic.shapes.corners import GRID_M, parts_of, size_of, squared
from vitruvius.logic.shapes.lines import MAX_WALL_M

MAX_SLIVER_M = 0.2
"""Greatest width of a sliver, metres; narrower floor is removed."""

MAX_SCRAP_M2 = 0.5
"""Area, square metres, up to which a part is removed that only slivers join to the rest of its room."""

MAX_CONTACT_GAP_M = 0.06
"""Greatest distance of two rooms without a wall between them, metres."""


def without_slivers(shape: Polygon) -> list[Polygon]:
    """Return the parts of a room after strips narrower than ``MAX_SLIVER_M`` are removed."""
    wide = shape.buffer(-MAX_SLIVER_M / 2, join_style="mitre").buffer(MAX_SLIVER_M / 2, join_style="mitre")
    if shapely.difference(shape, wide).area < MAX_SLIVER_M**2:
        return [shape]
    return [part for part in parts_of(shape & wide) if part.area > MAX_SCRAP_M2]


def without_stubs(
    names: Sequence[str], shapes: Sequence[Polygon], noise: float, notes: list[str]
) -> list[Polygon]:
    """Remove walls that project into rooms along the axes: such a wall has both faces in one room."""
    found, half = list(shapes), MAX_WALL_M / 2
    tree = shapely.STRtree(found)
    for place, shape in enumerate(shapes):
        closed = shape.buffer(half, join_style="mitre").buffer(-half, join_style="mitre")
        near = [shapes[other] for other in tree.query(closed) if other != place]
        stubs = [
            each
            for each in parts_of(shapely.difference(closed, shape, grid_size=GRID_M))
            if each.area > 1e-3 and not any(shapely.intersection(each, other).area > 1e-3 for other in near)
        ]
        filled = shapely.union_all([shape, *stubs], grid_size=GRID_M)
        if stubs and isinstance(filled, Polygon):
            found[place] = squared(names[place], filled, noise)
            longest = max(stubs, key=lambda each: each.length)
            notes.append(f"a wall of {size_of(longest)} that stands into {names[place]} is left out")
    return found


def open_borders(shapes: Sequence[Polygon]) -> Iterator[Box]:
    """Yield the longest straight border of each pair of rooms that have no wall between them."""
    tree = shapely.STRtree(list(shapes))
    for one, other in tree.query(list(shapes), "dwithin", MAX_CONTACT_GAP_M).T.tolist():
        if one < other:
            beside = shapely.buffer(shapes[other], MAX_CONTACT_GAP_M, join_style="mitre")
            border = shapely.line_merge(shapes[one].boundary & beside)
            lines = shapely.simplify(shapely.get_parts(border), GRID_M)
            sides = [side for line in lines for side in _sides(line)]
            if sides:
                yield max(sides, key=lambda side: side[2] - side[0] + side[3] - side[1])


def _sides(line: shapely.Geometry) -> Iterator[Box]:
    for (x1, y1), (x2, y2) in pairwise(shapely.get_coordinates(line).tolist()):
        yield min(x1, x2), min(y1, y2), max(x1, x2), max(y1, y2)
