"""Checks of stars: doors, sides, the main room and the rooms around it.

The original's houses are stars too, judged by the paper's constraints. They promise neither the distance
between rooms nor the least area of the main room.
"""

import math
import operator
from collections import Counter
from collections.abc import Iterator
from itertools import combinations

from vitruvius.logic.checking.fault import Fault
from vitruvius.logic.checking.figures import apart, figure, number
from vitruvius.logic.checking.least_main_room import MAX_SIDE_RATIO, least_area, side_of
from vitruvius.logic.checking.names import named
from vitruvius.logic.checking.room import out_of, sizes_of_pieces
from vitruvius.logic.house.boxes import TOLERANCE, distance, is_on_wall, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Room
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.house.topology_kinds import Kind
from vitruvius.logic.spelling import numbered

MAX_AREA_RATIO = 2.0
"""Largest ratio of the main room's area to that of the least main room that fits its rooms."""


def star_doors(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for each door of another width than promised, or on no wall that its rooms share."""
    star = house.star
    first = star.rooms[0].door.length if star.rooms else 0.0
    wanted = first if promises.door_width is None else promises.door_width
    for room, stands in zip(house.secondary, star.rooms, strict=True):
        its = f"{named(room)}: its door is"
        width = stands.door.length
        if abs(width - wanted) > TOLERANCE:
            found, must = figure(width, wanted, digits=3), number(wanted, 3)
            yield Fault(f"{its} {found} m wide (must be {must})", (room.name,))
        if house.kind is Kind.STAR:
            if side_of(star, stands) is None:
                yield Fault(f"{its} not on a wall that it shares with the main room", (room.name,))
        elif not any(is_on_wall(stands.door, stands, wall) for wall in range(4)):
            yield Fault(f"{its} not on a wall of the room", (room.name,))


def star_rooms(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for rooms that overlap, are too near to each other, or exceed the main room's area."""
    floor, rooms, names = house.main, house.secondary, _names(house)
    slack = TOLERANCE * (floor.width + floor.height)
    for room, name in zip(rooms, names, strict=True):
        depth = overlap(room.box, floor.box)
        if house.kind is Kind.STAR and depth > TOLERANCE:
            yield Fault(f"{name} overlaps the main room by {figure(depth)} m", (room.name,))
        if room.area > floor.area + slack:
            its, main = apart(room.area, floor.area, holds=operator.gt)
            yield Fault(f"{name} is larger ({its} m²) than the main room ({main} m²)", (room.name,))
    for (one, name), (other, neighbour) in combinations(zip(rooms, names, strict=True), 2):
        both, depth = (one.name, other.name), overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield Fault(f"{name} overlaps {neighbour} by {figure(depth)} m", both)
            continue
        away, gap = distance(one.box, other.box), promises.room_gap
        if gap is not None and house.kind is Kind.STAR and away < gap - TOLERANCE:
            text = f"{name} stands {figure(away, gap)} m from {neighbour} (at least {number(gap)})"
            yield Fault(text, both)


def star_sides(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for each side of the main room with too many rooms."""
    star = house.star
    if promises.a_side is None or len(star.rooms) < 4:
        return
    most = len(star.rooms) // promises.a_side + 1
    for side, count in Counter(side_of(star, room) for room in star.rooms).items():
        if side and count > most:
            rooms = numbered(count, "room")
            yield Fault(f"house: has {rooms} on the {side} side (at most {most} of {len(star.rooms)})")


def star_shape(house: House, _: Promises) -> Iterator[Fault]:
    """Yield a fault for a main room that is too long."""
    floor = house.star.floor
    short, long = sorted((floor.width, floor.height))
    if long > MAX_SIDE_RATIO * short + TOLERANCE:
        a, b = apart(long, short, holds=lambda a, b: a > MAX_SIDE_RATIO * b)
        yield Fault(f"main room: is {a} by {b} m (at most {MAX_SIDE_RATIO:g} times as long as wide)")


def star_main_room(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for a main room that is too large."""
    star = house.star
    if house.provenance and "keep" in house.provenance.request:
        return  # It reaches from one fixed room to the other, however far.
    if not star.rooms or any(side_of(star, room) is None for room in star.rooms):
        return
    gap = promises.room_gap
    least = least_area(star, math.inf if gap is None else max(gap, promises.door_clearance))
    if star.floor.area > MAX_AREA_RATIO * least + TOLERANCE * (star.floor.width + star.floor.height):
        area, needed = apart(star.floor.area, least, holds=lambda a, b: a > MAX_AREA_RATIO * b)
        most = f"{MAX_AREA_RATIO:g} times the {needed} m² that its rooms need"
        yield Fault(f"main room: is of {area} m² (at most {most})")


def star_sizes(house: House, room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for each size of a room and of its pieces out of its bounds, as seen from the door."""
    along_x = side_of(house.star, house.star.rooms[house.counted.index(room)]) in {"north", "south"}
    width, depth = (room.width, room.height) if along_x else (room.height, room.width)
    bounds = promises.room_size.get(room.type), promises.room_relations.get(room.type, ())
    yield from out_of("the room", width, depth, *bounds)
    yield from sizes_of_pieces(room, promises, along_x)


def _names(house: House) -> list[str]:
    return [named(room) for room in house.secondary]
