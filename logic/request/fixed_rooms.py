"""Fixed rooms: rooms of another house around which the rest is generated."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.boxes import WALLS, is_on_wall
from vitruvius.logic.house.house import House
from vitruvius.logic.house.star import Star, StarRoom
from vitruvius.logic.house.topology_kinds import Kind

SIDES = ("north", "east", "south", "west")


@dataclass(frozen=True)
class FixedRoom:
    """Fixed room: its side of the main room, and its measures as seen from there, clockwise.

    Metres: ``width`` along the wall with the door, ``depth``, and ``door`` from the room's start to the
    door's. ``along`` is the room's start on that wall and ``wall`` the wall's place, in the house's own
    coordinates.
    """

    room: StarRoom
    side: str
    width: float
    depth: float
    door: float
    along: float
    wall: float


def fixed_rooms(house: House) -> list[FixedRoom]:
    """Return all rooms of a house as fixed rooms, clockwise from the north-west corner.

    Raises ``RequestError`` if the house is no star of ours, or a door is on no wall of its room.
    """
    if house.kind is Kind.SHARED_WALLS:
        raise RequestError(f"keep: only rooms of a star can be fixed, not of the topology {house.topology!r}")
    if house.kind is Kind.ORIGINAL:
        raise RequestError("keep: rooms of the original's houses overlap the main room: they cannot be fixed")
    fixed = [_fixed(room, f"R{index}") for index, room in enumerate(house.star.rooms)]
    clockwise = {"north": 1, "east": 1, "south": -1, "west": -1}
    return sorted(fixed, key=lambda room: (SIDES.index(room.side), clockwise[room.side] * room.along))


def _fixed(room: StarRoom, name: str) -> FixedRoom:
    west, north, east, south = room.box
    door_west, door_north, door_east, door_south = room.door.box
    walls = [wall for index, wall in enumerate(WALLS) if is_on_wall(room.door, room, index)]
    if not walls:
        raise RequestError(f"keep: the door of {name} is on no wall of the room")
    # A room whose door is in its south wall stands to the north.
    match walls[0]:
        case "south":
            return FixedRoom(room, "north", room.width, room.height, door_west - west, west, south)
        case "west":
            return FixedRoom(room, "east", room.height, room.width, door_north - north, north, west)
        case "north":
            return FixedRoom(room, "south", room.width, room.height, east - door_east, east, north)
        case _:
            return FixedRoom(room, "west", room.height, room.width, south - door_south, south, east)


def from_records(records: Sequence[dict[str, Any]]) -> list[FixedRoom]:
    """Return fixed rooms from their JSON form, clockwise."""
    rooms = tuple(msgspec.convert(record, StarRoom) for record in records)
    return fixed_rooms(House.of_star(Star(rooms[0], rooms))) if rooms else []
