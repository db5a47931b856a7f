"""Gaps between rooms that are too narrow for a room, such as niches: the rooms beside take them."""

from collections.abc import Callable, Sequence

import shapely
from shapely import Geometry, Polygon

from logic.house.promises import PASSAGE
from logic.readers.corners import GRID
from logic.readers.sketch import parts_of

MOST_GAP = 0.6
"""Metres: a gap that is no wider goes to a room beside it."""


def taken_up(
    rooms: Sequence[Polygon], niches: Sequence[Polygon], say: Callable[[int, Polygon], None]
) -> list[Polygon]:
    """Return boxes of rooms with the narrow gaps between them, as far as these run along a whole side of one.

    ``say(room, strip)`` hears what each takes.
    """
    found = list(rooms)
    for gap in gaps(found, niches):
        free: Geometry = gap
        beside = [room for room, box in enumerate(found) if shapely.distance(box, gap) < GRID]
        while not free.is_empty and beside:
            strips = [(_strip(found[room], side, free), room) for room in beside for side in range(4)]
            strip, room = max(strips, key=lambda each: each[0].area)
            if strip.area < MOST_GAP * GRID:
                break
            say(room, strip)
            west, north, east, south = (found[room] | strip).bounds
            found[room] = shapely.box(west, north, east, south)
            free = shapely.difference(free, strip, grid_size=GRID)
    return found


def gaps(rooms: Sequence[Polygon], niches: Sequence[Polygon] = ()) -> list[Polygon]:
    """The gaps between boxes of rooms, and niches, that are no wider than ``MOST_GAP``."""
    floor = shapely.union_all(list(rooms), grid_size=GRID)
    hulls = shapely.union_all([Polygon(each.exterior) for each in parts_of(floor)])
    closed = hulls.buffer(PASSAGE / 2, join_style="mitre").buffer(-PASSAGE / 2, join_style="mitre")
    free = parts_of(shapely.difference(shapely.union_all([closed, *niches]), floor, grid_size=GRID))
    return [each for each in free if each.buffer(-MOST_GAP / 2 - GRID, join_style="mitre").is_empty]


def _strip(room: Polygon, side: int, gap: Geometry) -> Polygon:
    """The largest box beside a whole side of a room (west, north, east or south) that lies in a gap."""
    if shapely.distance(room, gap) > GRID:
        return Polygon()
    edges = [*room.bounds]
    start, outward = edges[side], (-1 if side < 2 else 1)
    places = {float(each) for each in shapely.get_coordinates(gap)[:, side % 2]}
    best = Polygon()
    for place in sorted(places, key=lambda place: outward * place):
        if outward * (place - start) > GRID:
            edges[side], edges[(side + 2) % 4] = place, start
            west, north, east, south = edges
            strip = shapely.box(west, north, east, south)
            if shapely.difference(strip, gap, grid_size=GRID).area > GRID * strip.length:
                break
            best = strip
    return best
