"""What the check asks of a star: its doors, its sides, its main room and the rooms around it."""

import math
from collections import Counter
from collections.abc import Iterator
from itertools import combinations

from logic.boxes import TOLERANCE, distance, is_on_wall, overlap
from logic.house import House
from logic.least_main_room import ELONGATION, least_area, side_of
from logic.parts import STAR
from logic.promises import CLEARANCE, Promises

SPACIOUSNESS = 2.0
"""The most that the main room may be larger than the least main room that fits its rooms."""


def star_doors(house: House, promises: Promises) -> Iterator[str]:
    """Doors of another width than promised, or on no wall that their rooms share."""
    star, names = house.star, _names(house)
    widths = [room.door.length for room in star.rooms]
    for room, name, width in zip(star.rooms, names, widths, strict=True):
        wanted = widths[0] if promises.door is None else promises.door
        if abs(width - wanted) > TOLERANCE:
            yield f"{name}: its door is {width:.3f} m wide (must be {wanted:.3f})"
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
            yield f"{name} overlaps the main room by {depth:.2f} m"
        if room.area > floor.area + slack:
            yield f"{name} is larger ({room.area:.2f} m²) than the main room ({floor.area:.2f} m²)"
    for (one, name), (other, neighbour) in combinations(zip(rooms, names, strict=True), 2):
        depth = overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield f"{name} overlaps {neighbour} by {depth:.2f} m"
            continue
        apart = distance(one.box, other.box)
        if promises.room_gap is not None and house.topology == STAR and apart < promises.room_gap - TOLERANCE:
            yield f"{name} stands {apart:.2f} m from {neighbour} (at least {promises.room_gap:g})"


def star_sides(house: House, promises: Promises) -> Iterator[str]:
    """Too many rooms on one side of the main room."""
    star = house.star
    if promises.a_side is None or len(star.rooms) < 4 or house.topology != STAR:
        return
    most = len(star.rooms) // promises.a_side + 1
    for side, count in Counter(side_of(star, room) for room in star.rooms).items():
        if side and count > most:
            yield f"house: has {count} rooms on the {side} side (at most {most} of {len(star.rooms)})"


def star_main_room(house: House, promises: Promises) -> Iterator[str]:
    """A main room that is too long or too large."""
    star = house.star
    short, long = sorted((star.floor.width, star.floor.height))
    if long > ELONGATION * short + TOLERANCE:
        yield f"main room: is {long:.2f} by {short:.2f} m (at most {ELONGATION:g} times as long as wide)"
    if house.provenance and "keep" in house.provenance.request:
        return  # It reaches from one fixed room to the other, however far.
    if house.topology != STAR or not star.rooms or any(side_of(star, room) is None for room in star.rooms):
        return
    least = least_area(star, math.inf if promises.room_gap is None else max(promises.room_gap, CLEARANCE))
    if star.floor.area > SPACIOUSNESS * least + TOLERANCE * (short + long):
        yield (
            f"main room: is of {star.floor.area:.2f} m² "
            f"(at most {SPACIOUSNESS:g} times the {least:.2f} m² that its rooms need)"
        )


def _names(house: House) -> list[str]:
    return [f"{room.name} ({room.type})" for room in house.secondary]
