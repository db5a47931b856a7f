"""Union of the walls of a house as one area, so that no joint between two walls is visible."""

from collections.abc import Iterable, Iterator

import shapely

from vitruvius.logic.drawing.frame import grown
from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.house import House

GRID_M = 1e-4
"""Rounding of corners, metres, which makes the corners of adjacent walls equal."""

Ring = tuple[tuple[float, float], ...]
"""Corners of a closed line, metres."""


def wall_rings(house: House, beyond: float, inner: Iterable[Box] = ()) -> list[Ring]:
    """Return the borders of all walls: a point lies in a wall if an odd number of borders encloses it.

    ``beyond``: metres by which outer walls reach over the tiles. ``inner``: boxes of walls whose middles lie
    on the edges of rooms. Outer walls of outdoor rooms are parapets.
    """
    tiles = [(tile.box, tile.type in house.outdoor) for tile in house.tiles]
    indoors = _union(grown(box, beyond) for box, is_outdoor in tiles if not is_outdoor)
    whole = _union(grown(box, beyond) for box, _ in tiles)
    rooms = _union(room.box for room in house.rooms)
    walls = shapely.union(shapely.difference(whole, rooms, grid_size=GRID_M), _union(inner), grid_size=GRID_M)
    if outdoors := [room.box for room in house.rooms if room.type in house.outdoor]:
        parapets = _union(grown(box, house.parapet) for box in outdoors)
        low = shapely.difference(parapets, rooms, grid_size=GRID_M)
        walls = shapely.union(shapely.intersection(walls, indoors, grid_size=GRID_M), low, grid_size=GRID_M)
    return [*_rings(shapely.orient_polygons(walls.simplify(0)))]


def _union(boxes: Iterable[Box]) -> shapely.Geometry:
    return shapely.union_all([shapely.box(*box) for box in boxes], grid_size=GRID_M)


def _rings(area: shapely.Geometry) -> Iterator[Ring]:
    for part in shapely.get_parts(area):
        if isinstance(part, shapely.Polygon):
            for ring in (part.exterior, *part.interiors):
                yield tuple((x, y) for x, y in ring.coords[:-1])
