"""Where a square can go in a house: its configuration space, exact, since every edge is axis-aligned.

A square's centre keeps half a side, in x and in y, from every wall and piece: grow each by that much, and
what is left of the floor falls into spaces that the square cannot leave.
"""

from collections.abc import Iterable, Iterator

import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from logic.house.boxes import TOLERANCE, Box
from logic.house.house import House
from logic.house.parts import OUTSIDE, Door, Rect, Room


def spaces(house: House, side: float) -> list[Polygon]:
    """The places of a square's centre: a polygon (metres) for each part that the square cannot leave.

    Squares pass where there is room for ``side`` (metres) to within the tolerance.
    """
    half = side / 2 - TOLERANCE
    # Floors that touch within the tolerance are joined; the walls around them are far thicker, once grown.
    floors = shapely.union_all([_grown(rect.box, TOLERANCE) for rect in house.rooms])
    solids = [*_walls(house), *(piece.box for room in house.rooms for piece in room.pieces)]
    free = shapely.difference(floors, shapely.union_all([_grown(solid, half) for solid in solids]))
    return list(_polygons(free))


def swept(space: BaseGeometry, side: float) -> BaseGeometry:
    """All that a square covers while its centre goes everywhere in a space (square metres of floor)."""
    return space.buffer(side / 2, join_style="mitre")


def first_room(house: House) -> Room:
    """The room from which a body walks through a house: that of the first entrance, else the hub, else the
    first.
    """
    entered = [name for door in house.doors if door.is_entrance for name in door.between if name != OUTSIDE]
    return next((house.room(name) for name in (*entered, house.hub) if name), house.rooms[0])


def first_space(house: House, spaces: list[Polygon], side: float) -> Polygon:
    """The space in which a square is in the first room: in a star ``floor`` minus the rooms.

    Rooms that cut the main room in parts leave several: the one with most of it. Empty where a square of
    this side (metres) does not fit into the first room.
    """
    first = first_room(house)
    others = [shapely.box(*room.box) for room in house.cut_from(first)]
    floor = shapely.difference(shapely.box(*first.box), shapely.union_all(others))
    places = _shrunk(floor, side)
    inside = [space for space in spaces if space.intersects(places)]
    return max(inside, key=lambda space: space.intersection(places).area, default=Polygon())


def doorway(door: Door, side: float) -> BaseGeometry:
    """Where the centre of a square is that goes through a door: the door itself, or as near as it comes to an
    entrance, which is shut, or to a door that is narrower.
    """
    west, north, east, south = door.box
    line = shapely.LineString([(west, north), (east, south)])
    shut = door.is_entrance or side > door.length + TOLERANCE
    return line.buffer(side / 2, cap_style="flat") if shut else line


def joins_all(room: Room, doorways: Iterable[BaseGeometry], spaces: Iterable[Polygon]) -> bool:
    """Whether a square, whose ``spaces`` in the house these are, can go from each of a room's doorways to
    each other without leaving the room.
    """
    doorways, floor = list(doorways), shapely.box(*room.box)
    parts = [part for space in spaces for part in _polygons(space.intersection(floor))]
    return (
        any(all(part.distance(each) < TOLERANCE for each in doorways) for part in parts) or len(doorways) < 2
    )


def places_inside(room: Rect, side: float) -> BaseGeometry:
    """The places of the centre of a square that is wholly inside a room, were it empty."""
    return _shrunk(shapely.box(*room.box), side)


def free_floor(room: Room) -> BaseGeometry:
    """A room minus its pieces."""
    standing = shapely.union_all([shapely.box(*piece.box) for piece in room.pieces])
    return shapely.difference(shapely.box(*room.box), standing)


def _walls(house: House) -> Iterator[Box]:
    """Every wall as boxes without thickness: the rooms' but for the doors between them. Of a star's main room
    they are where no room is.
    """
    if main := house.main_room:
        rooms = shapely.union_all([_grown(room.box, TOLERANCE) for room in house.cut_from(main)])
        for edge in _edges(main):
            yield from _segments(shapely.difference(edge, rooms))
    for room in house.counted:
        doors = [door.box for door in house.doors_of(room.name) if not door.is_entrance]
        gaps = shapely.union_all([_grown(door, TOLERANCE) for door in doors])
        for edge in _edges(room):
            yield from _segments(shapely.difference(edge, gaps))


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
