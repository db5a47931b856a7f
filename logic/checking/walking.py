"""Checks that the robot gets through a house, and that squares as wide as a passage do."""

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely import Polygon, STRtree
from shapely.geometry.base import BaseGeometry

from vitruvius.logic.checking.fault import Fault
from vitruvius.logic.checking.figures import figure, number, percent
from vitruvius.logic.checking.names import named, space_name
from vitruvius.logic.checking.walk import (
    doorway,
    first_room,
    first_space,
    free_floor,
    joins_all,
    places_inside,
    spaces,
    swept,
)
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import BODY, Door, Room
from vitruvius.logic.house.promises import Promises

MIN_REACHABLE_FRACTION = 0.6
"""Least fraction of a room's free floor that the robot must reach from the room's doors."""
SLIVER_M2 = 1e-4
"""Area in square metres. A square whose centre has less area than this only just fits and does not count."""


def unentered(house: House, _: Promises) -> Iterator[Fault]:
    """Yield a fault for each room that the robot cannot enter from the first room."""
    (bodies,) = spaces(house, BODY)
    first = first_space(house, bodies, BODY)
    return (_unentered(house, room) for room in house.counted if not _enters(first, room))


def impassable(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield the faults of ``unentered``, then those of rooms with unreachable floor or narrow ways."""
    passage = max(promises.passage, SLIVER_M2)
    bodies, squares = spaces(house, BODY, passage)
    first = first_space(house, bodies, BODY)
    shapely.prepare(first)
    covered = [swept(space, BODY) for space in bodies]
    unions: dict[tuple[int, ...], BaseGeometry] = {}
    by_body, by_square = STRtree(bodies), STRtree(squares)
    for room in house.counted:
        if not _enters(first, room):
            yield _unentered(house, room)
            continue
        doors = house.doors_of(room.name)
        ways = shapely.union_all([doorway(door, BODY, house.half_wall) for door in doors])
        entered = tuple(np.sort(by_body.query(ways, "intersects")).tolist())
        if entered not in unions:
            unions[entered] = shapely.union_all([covered[index] for index in entered])
        whole = room.grown(house.half_wall).box
        near = [squares[index] for index in np.sort(by_square.query(shapely.box(*whole)))]
        for said in (
            _unreached(room, doors, unions[entered]),
            _narrow(room, doors, near, passage, house.half_wall),
        ):
            yield from (Fault(f"{named(room)}: {fault}", (room.name,)) for fault in said)


def _enters(first: Polygon, room: Room) -> bool:
    return first.intersects(places_inside(room, BODY))


def _unentered(house: House, room: Room) -> Fault:
    start = space_name(house, first_room(house))
    text = f"{named(room)}: the body ({BODY} m square) cannot get into it from {start}"
    return Fault(text, (room.name,))


def _unreached(room: Room, doors: Sequence[Door], reached: BaseGeometry) -> Iterator[str]:
    """Yield a text if too little of a room's floor is ``reached``."""
    free = free_floor(room)
    share = reached.intersection(free).area / free.area
    its = "its door" if len(doors) == 1 else "its doors"
    if share < MIN_REACHABLE_FRACTION:
        reach = f"{percent(share, MIN_REACHABLE_FRACTION)} of its free floor from {its}"
        yield f"the body reaches {reach} (at least {percent(MIN_REACHABLE_FRACTION)})"


def _narrow(
    room: Room, doors: Sequence[Door], squares: Sequence[Polygon], passage: float, half: float
) -> Iterator[str]:
    """Yield a text for places in a room that a square reaches from no door, or not from all doors."""
    free, by_square = free_floor(room), [doorway(door, passage, half) for door in doors]
    wide = shapely.union_all(by_square)
    closed = [space for space in squares if space.intersection(free).area > SLIVER_M2]
    closed = [space for space in closed if not space.intersects(wide)]
    if closed:
        area = shapely.union_all([swept(space, passage) for space in closed]).intersection(free).area
        behind = f"{figure(area)} m² of its floor lie"
        yield f"{behind} behind passages narrower than {number(passage)} m"
    elif not joins_all(room.grown(half), by_square, squares):
        yield f"no passage of {number(passage)} m joins its doors inside it"
