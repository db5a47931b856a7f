"""Configuration space of a square in a house, which is exact since every edge is axis-aligned.

The centre of a square keeps half a side, in x and in y, from every wall and piece. Each obstacle grows by
that much, and the rest of the floor falls into spaces that the square cannot leave.
"""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import shapely
from shapely import Polygon
from shapely.geometry.base import BaseGeometry

from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Rect, Room


def spaces(house: House, *sides: float) -> Iterator[list[Polygon]]:
    """Yield for a square of each side (metres) the polygons (metres) of the places of its centre.

    Each polygon is a part that the square cannot leave. Squares pass through gaps as wide as their side to
    within the tolerance.
    """
    # Floors that touch within the tolerance are joined. The walls around them, once grown, are far thicker.
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
    """Return the floor that a square covers while its centre visits every place of a space."""
    return space.buffer(side / 2, join_style="mitre")


def first_room(house: House) -> Room:
    """Return the room where the robot starts: that of the first entrance, else the hub, else the first."""
    entered = [name for door in house.doors if door.is_entrance for name in door.between if name != OUTSIDE]
    return next((house.room(name) for name in (*entered, house.hub) if name), house.rooms[0])


def first_space(house: House, spaces: list[Polygon], side: float) -> Polygon:
    """Return the space of a square's centre in the first room (in a star ``floor`` without the rooms).

    If rooms divide the main room into several parts, the result is the space with the largest share of it.
    The polygon is empty if a square of this side (metres) does not fit into the first room.
    """
    first = first_room(house)
    others = [shapely.box(*room.box) for room in house.cut_from(first)]
    floor = shapely.difference(shapely.box(*first.box), shapely.union_all(others))
    places = _shrunk(floor, side)
    inside = [space for space in spaces if space.intersects(places)]
    return max(inside, key=lambda space: space.intersection(places).area, default=Polygon())


def way_through(opening: Rect, half: float) -> Box:
    """Return the box that an opening takes of its wall; ``half`` is half the wall's thickness, metres."""
    x, y = (half, 0.0) if opening.width < opening.height else (0.0, half)
    west, north, east, south = opening.box
    return west - x, north - y, east + x, south + y


def doorway(door: Door, side: float, half: float = 0.0) -> BaseGeometry:
    """Return the places of a square's centre at a door.

    These are the door itself, or the places nearest to it if the door is an entrance, which is shut, or too
    narrow. ``half`` is half the thickness of its wall, metres.
    """
    west, north, east, south = door.box
    line = shapely.LineString([(west, north), (east, south)])
    shut = door.is_entrance or side > door.length + TOLERANCE
    return line.buffer(side / 2 + half, cap_style="flat") if shut else line


def joins_all(room: Rect, doorways: Iterable[BaseGeometry], spaces: Iterable[Polygon]) -> bool:
    """Return True if a square can go between all doorways of a room without leaving the room.

    ``spaces`` are the spaces of the square in the house.
    """
    doorways, floor = list(doorways), shapely.box(*room.box)
    parts = [part for space in spaces for part in _polygons(space.intersection(floor))]
    return (
        any(all(part.distance(each) < TOLERANCE for each in doorways) for part in parts) or len(doorways) < 2
    )


def places_inside(room: Rect, side: float) -> BaseGeometry:
    """Return the places of the centre of a square that is wholly inside a room, ignoring furniture."""
    return _shrunk(shapely.box(*room.box), side)


def free_floor(room: Room) -> BaseGeometry:
    """Return a room's floor without its pieces."""
    standing = _grown([piece.box for piece in room.pieces], 0.0)
    return shapely.difference(shapely.box(*room.box), standing)


def _walls(house: House) -> Iterator[Box]:
    """Yield all walls as boxes without thickness, except the doors between rooms.

    A star's main room has walls where no other room is.
    """
    if main := house.main_room:
        yield from _edges(main, [room.box for room in house.cut_from(main)])
    for room in house.counted:
        doors = house.doors_of(room.name)
        yield from _edges(room, [door.box for door in doors if not door.is_entrance])


def _edges(rect: Rect, gaps: Sequence[Box]) -> Iterator[Box]:
    """Yield the parts of a rectangle's edges outside the gaps, from west to east and from north to south."""
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
    """Return the union of boxes, each grown by ``by`` (metres) on all sides."""
    west, north, east, south = np.array(boxes, float).reshape(-1, 4).T
    return shapely.union_all(shapely.box(west - by, north - by, east + by, south + by))


def _shrunk(floor: BaseGeometry, side: float) -> BaseGeometry:
    return floor.buffer(TOLERANCE - side / 2, join_style="mitre")
