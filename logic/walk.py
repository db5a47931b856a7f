"""Where a square can go in a house: its configuration space, exact, since every edge is axis-aligned.

A square's centre keeps half a side, in x and in y, from every wall and piece: grow each by that much, and
what is left of the floor falls into spaces that the square cannot leave.
"""

from collections.abc import Iterator

import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from logic.boxes import TOLERANCE, Box
from logic.house import House, Rect, Room


def spaces(house: House, side: float) -> list[Polygon]:
    """The places of a square's centre: a polygon (metres) for each part that the square cannot leave.

    Squares pass where there is room for ``side`` (metres) to within the tolerance.
    """
    half = side / 2 - TOLERANCE
    # Floors that touch within the tolerance are joined; the walls around them are far thicker, once grown.
    floors = shapely.union_all([_grown(rect.box, TOLERANCE) for rect in (house.floor, *house.rooms)])
    solids = [*_walls(house), *(piece.box for room in house.rooms for piece in room.pieces)]
    free = shapely.difference(floors, shapely.union_all([_grown(solid, half) for solid in solids]))
    return list(_polygons(free))


def swept(space: BaseGeometry, side: float) -> BaseGeometry:
    """All that a square covers while its centre goes everywhere in a space (square metres of floor)."""
    return space.buffer(side / 2, join_style="mitre")


def main_space(house: House, spaces: list[Polygon], side: float) -> Polygon:
    """The space in which a square is in the main room: ``floor`` minus the rooms (ours only touch it).

    Rooms that cut the main room in parts leave several: the one with most of it. Empty where a square of
    this side (metres) does not fit into the main room.
    """
    rooms = shapely.union_all([shapely.box(*room.box) for room in house.rooms])
    main = shapely.difference(shapely.box(*house.floor.box), rooms)
    places = _shrunk(main, side)
    inside = [space for space in spaces if space.intersects(places)]
    return max(inside, key=lambda space: space.intersection(places).area, default=Polygon())


def places_inside(room: Rect, side: float) -> BaseGeometry:
    """The places of the centre of a square that is wholly inside a room, were it empty."""
    return _shrunk(shapely.box(*room.box), side)


def free_floor(room: Room) -> BaseGeometry:
    """A room minus its pieces."""
    standing = shapely.union_all([shapely.box(*piece.box) for piece in room.pieces])
    return shapely.difference(shapely.box(*room.box), standing)


def _walls(house: House) -> Iterator[Box]:
    """Every wall as boxes without thickness: the rooms' but for their doors, the main room's elsewhere."""
    rooms = shapely.union_all([_grown(room.box, TOLERANCE) for room in house.rooms])
    for edge in _edges(house.floor):
        yield from _segments(shapely.difference(edge, rooms))
    for room in house.rooms:
        for edge in _edges(room):
            yield from _segments(shapely.difference(edge, _grown(room.door.box, TOLERANCE)))


def _edges(rect: Rect) -> Iterator[BaseGeometry]:
    west, north, east, south = rect.box
    for line in (
        ((west, north), (east, north)),
        ((west, south), (east, south)),
        ((west, north), (west, south)),
        ((east, north), (east, south)),
    ):
        yield shapely.LineString(line)


def _segments(line: BaseGeometry) -> Iterator[Box]:
    for part in shapely.get_parts(line):
        if not part.is_empty:
            yield part.bounds


def _polygons(geometry: BaseGeometry) -> Iterator[Polygon]:
    for part in shapely.get_parts(geometry):
        if isinstance(part, Polygon) and not part.is_empty:
            yield part


def _grown(box: Box, by: float) -> Polygon:
    return shapely.box(box[0] - by, box[1] - by, box[2] + by, box[3] + by)


def _shrunk(floor: BaseGeometry, side: float) -> BaseGeometry:
    return floor.buffer(TOLERANCE - side / 2, join_style="mitre")
