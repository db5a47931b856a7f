"""What the check asks of a star: its doors, its sides, its main room and the rooms around it."""

import math
import operator
from collections import Counter
from collections.abc import Iterator
from itertools import combinations

from logic.checking.figures import apart, figure, number
from logic.checking.least_main_room import ELONGATION, least_area, side_of
from logic.house.boxes import TOLERANCE, distance, is_on_wall, overlap
from logic.house.house import House
from logic.house.parts import STAR
from logic.house.promises import Promises
from logic.spelling import numbered

SPACIOUSNESS = 2.0
"""The most that the main room may be larger than the least main room that fits its rooms."""


def star_doors(house: House, promises: Promises) -> Iterator[str]:
    """Doors of another width than promised, or on no wall that their rooms share."""
    star, names = house.star, _names(house)
    widths = [room.door.length for room in star.rooms]
    for room, name, width in zip(star.rooms, names, widths, strict=True):
        wanted = widths[0] if promises.door_width is None else promises.door_width
        if abs(width - wanted) > TOLERANCE:
            found, must = figure(width, wanted, digits=3), number(wanted, 3)
            yield f"{name}: its door is {found} m wide (must be {must})"
        if house.topology == STAR:
            if side_of(star, room) is None:
                yield f"{name}: its door is not on a wall that it shares with the main room"
        elif not any(is_on_wall(room.door, room, wall) for wall in range(4)):
            yield f"{name}: its door is not on a wall of the room"


def star_rooms(house: House, promises: Promises) -> Iterator[str]:
    """Rooms that overlap, stand too near to each other, or are larger than the main room."""
    floor, rooms, names = house.main, house.secondary, _names(house)
    slack = TOLERANCE * (floor.width + floor.height)
    for room, name in zip(rooms, names, strict=True):
        depth = overlap(room.box, floor.box)
        if house.topology == STAR and depth > TOLERANCE:
            yield f"{name} overlaps the main room by {figure(depth)} m"
        if room.area > floor.area + slack:
            its, main = apart(room.area, floor.area, holds=operator.gt)
            yield f"{name} is larger ({its} m²) than the main room ({main} m²)"
    for (one, name), (other, neighbour) in combinations(zip(rooms, names, strict=True), 2):
        depth = overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield f"{name} overlaps {neighbour} by {figure(depth)} m"
            continue
        away, gap = distance(one.box, other.box), promises.room_gap
        if gap is not None and house.topology == STAR and away < gap - TOLERANCE:
            yield f"{name} stands {figure(away, gap)} m from {neighbour} (at least {number(gap)})"


def star_sides(house: House, promises: Promises) -> Iterator[str]:
    """Too many rooms on one side of the main room."""
    star = house.star
    if promises.a_side is None or len(star.rooms) < 4 or house.topology != STAR:
        return
    most = len(star.rooms) // promises.a_side + 1
    for side, count in Counter(side_of(star, room) for room in star.rooms).items():
        if side and count > most:
            rooms = numbered(count, "room")
            yield f"house: has {rooms} on the {side} side (at most {most} of {len(star.rooms)})"


def star_main_room(house: House, promises: Promises) -> Iterator[str]:
    """A main room that is too long or too large."""
    star = house.star
    short, long = sorted((star.floor.width, star.floor.height))
    if long > ELONGATION * short + TOLERANCE:
        a, b = apart(long, short, holds=lambda a, b: a > ELONGATION * b)
        yield f"main room: is {a} by {b} m (at most {ELONGATION:g} times as long as wide)"
    if house.provenance and "keep" in house.provenance.request:
        return  # It reaches from one fixed room to the other, however far.
    if house.topology != STAR or not star.rooms or any(side_of(star, room) is None for room in star.rooms):
        return
    gap = promises.room_gap
    least = least_area(star, math.inf if gap is None else max(gap, promises.door_clearance))
    if star.floor.area > SPACIOUSNESS * least + TOLERANCE * (short + long):
        area, needed = apart(star.floor.area, least, holds=lambda a, b: a > SPACIOUSNESS * b)
        most = f"{SPACIOUSNESS:g} times the {needed} m² that its rooms need"
        yield f"main room: is of {area} m² (at most {most})"


def _names(house: House) -> list[str]:
    return [f"{room.name} ({room.type})" for room in house.secondary]
