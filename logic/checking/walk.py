"""Where a square can go in a house: its configuration space, exact, since every edge is axis-aligned.

A square's centre keeps half a side, in x and in y, from every wall and piece: grow each by that much, and
what is left of the floor falls into spaces that the square cannot leave.
"""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from logic.house.boxes import TOLERANCE, Box
from logic.house.house import House
from logic.house.parts import OUTSIDE, Door, Rect, Room


def spaces(house: House, *sides: float) -> Iterator[list[Polygon]]:
    """For squares of each of these sides (metres) the places of its centre: a polygon (metres) for each part
    that the square cannot leave.

    Squares pass where there is room for the side to within the tolerance.
    """
    # Floors that touch within the tolerance are joined; the walls around them are far thicker, once grown.
    half, standing = house.half_wall, [piece.box for room in house.rooms for piece in room.pieces]
    if half:
        ways = [way_through(door, half) for door in house.doors if not door.is_entrance]
        inside = _grown([*(room.box for room in house.rooms), *ways], TOLERANCE)
        for side in sides:
            places = inside.buffer(-side / 2, join_style="mitre")
            yield list(_polygons(shapely.difference(places, _grown(standing, side / 2 - TOLERANCE))))
        return
    floors = _grown([rect.box for rect in house.rooms], TOLERANCE)
    solids = [*_walls(house), *standing]
    for side in sides:
        yield list(_polygons(shapely.difference(floors, _grown(solids, side / 2 - TOLERANCE))))


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


def way_through(opening: Rect, half: float) -> Box:
    """What a door or window takes of its wall, of which half is so thick, metres."""
    x, y = (half, 0.0) if opening.width < opening.height else (0.0, half)
    west, north, east, south = opening.box
    return west - x, north - y, east + x, south + y


def doorway(door: Door, side: float, half: float = 0.0) -> BaseGeometry:
    """Where the centre of a square is that goes through a door: the door itself, or as near as it comes to an
    entrance, which is shut, or to a door that is narrower. ``half``: of the thickness of its wall, metres.
    """
    west, north, east, south = door.box
    line = shapely.LineString([(west, north), (east, south)])
    shut = door.is_entrance or side > door.length + TOLERANCE
    return line.buffer(side / 2 + half, cap_style="flat") if shut else line


def joins_all(room: Rect, doorways: Iterable[BaseGeometry], spaces: Iterable[Polygon]) -> bool:
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
    standing = _grown([piece.box for piece in room.pieces], 0.0)
    return shapely.difference(shapely.box(*room.box), standing)


def _walls(house: House) -> Iterator[Box]:
    """Every wall as boxes without thickness: the rooms' but for the doors between them. Of a star's main room
    they are where no room is.
    """
    if main := house.main_room:
        yield from _edges(main, [room.box for room in house.cut_from(main)])
    for room in house.counted:
        doors = house.doors_of(room.name)
        yield from _edges(room, [door.box for door in doors if not door.is_entrance])


def _edges(rect: Rect, gaps: Sequence[Box]) -> Iterator[Box]:
    """What gaps leave of the edges of a rectangle, from west to east and from north to south."""
    west, north, east, south = rect.box
    for along, across in ((0, north), (0, south), (1, west), (1, east)):
        start, end = (west, east) if along == 0 else (north, south)
        cuts = [
            (gap[along] - TOLERANCE, gap[along + 2] + TOLERANCE)
            for gap in gaps
            if gap[1 - along] - TOLERANCE <= across <= gap[3 - along] + TOLERANCE
        ]
        for low, high in sorted([*cuts, (end, end)]):
            if start < (stop := min(low, end)):
                yield (start, across, stop, across) if along == 0 else (across, start, across, stop)
            start = max(start, high)


def _polygons(geometry: BaseGeometry) -> Iterator[Polygon]:
    for part in shapely.get_parts(geometry):
        if isinstance(part, Polygon) and not part.is_empty:
            yield part


def _grown(boxes: Sequence[Box], by: float) -> BaseGeometry:
    """All that boxes cover, each grown by this much (metres) on all sides."""
    west, north, east, south = np.array(boxes, float).reshape(-1, 4).T
    return shapely.union_all(shapely.box(west - by, north - by, east + by, south + by))


def _shrunk(floor: BaseGeometry, side: float) -> BaseGeometry:
    return floor.buffer(TOLERANCE - side / 2, join_style="mitre")
