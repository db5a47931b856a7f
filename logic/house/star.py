"""Stars: rooms around a main room, each with one door to it, their files, and data that only stars have.

``vitruvius-1`` and the original's files hold stars; a house of any other topology has another format.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import msgspec

from vitruvius.logic.house.parts import (
    MAIN,
    MOST_ROOMS,
    ORIGINAL,
    PIXEL,
    Door,
    Piece,
    Provenance,
    Rect,
    Room,
    pieces_of,
)
from vitruvius.logic.house.promises import Type


class StarRoom(Rect, frozen=True, forbid_unknown_fields=True):
    """Room of a star: its place, type and furniture, and its one door, which leads to the main room."""

    type: Type
    children: tuple[Piece, ...]
    door: Rect

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Every piece in the room, each before its own children."""
        return pieces_of(self.children)


class Star(msgspec.Struct, frozen=True):
    """House as a star: ``floor`` is the main room, and ``rooms[k]`` is the room ``Rk``."""

    floor: Rect
    rooms: tuple[StarRoom, ...] = ()

    @classmethod
    def of(cls, rooms: Sequence[Room], doors: Sequence[Door], hub: str) -> Star:
        """Return the star of these parts. Raises ``ValueError`` for the first room that fits no star."""
        doors_of: dict[str, list[Door]] = {room.name: [] for room in rooms}
        if hub not in doors_of:
            raise ValueError("a star has a hub, its main room")
        for door in doors:
            for name in door.between:
                doors_of.setdefault(name, []).append(door)
        around, floor = [], None
        for room in rooms:
            if room.name == hub:
                floor = Rect(*_sides(room))
                continue
            its = doors_of[room.name]
            if len(its) != 1 or hub not in its[0].between:
                raise ValueError(f"{room.name}: a room of a star has one door, to {hub}")
            around.append(StarRoom(*_sides(room), room.type, room.children, Rect(*_sides(its[0]))))
        assert floor is not None
        return cls(floor, tuple(around))

    def parts(self) -> tuple[tuple[Room, ...], tuple[Door, ...]]:
        """Return the rooms ``R0``, ``R1``..., the main room last, and their doors."""
        named = [(f"R{index}", room) for index, room in enumerate(self.rooms)]
        rooms = [Room(*_sides(room), name, room.type, room.children) for name, room in named]
        main = Room(*_sides(self.floor), MAIN, MAIN)
        return (*rooms, main), tuple(Door(*_sides(room.door), (name, MAIN)) for name, room in named)


def _sides(rect: Rect) -> tuple[float, float, float, float]:
    return rect.x, rect.y, rect.width, rect.height


class _Header(msgspec.Struct, forbid_unknown_fields=True):
    """Record of a star without its rooms."""

    roomNumber: int
    floor: Rect
    format: Literal["vitruvius-1", "original"] = ORIGINAL
    unit: Literal["m"] | None = None
    provenance: Provenance | None = None


def read_star(record: dict[str, Any]) -> tuple[Star, str, Provenance | None]:
    """Return a star from its record, the name of its format and its provenance.

    Raises ``msgspec.ValidationError`` that names the first wrong field.
    """
    is_room = {key: key[:1] == "R" and key[1:].isdecimal() for key in record}
    header = msgspec.convert({k: v for k, v in record.items() if not is_room[k]}, _Header)
    found = sum(is_room.values())
    if header.roomNumber != found:
        raise msgspec.ValidationError(f"roomNumber is {header.roomNumber}, but {found} rooms follow")
    if found > MOST_ROOMS:
        raise msgspec.ValidationError(f"has {found} rooms: at most {MOST_ROOMS:,}")
    rooms = []
    for index in range(found):
        if f"R{index}" not in record:
            raise msgspec.ValidationError(f"roomNumber is {found}, but R{index} is missing")
        try:
            rooms.append(msgspec.convert(record[f"R{index}"], StarRoom))
        except msgspec.ValidationError as error:
            raise msgspec.ValidationError(f"R{index}: {error}") from None
    star = Star(header.floor, tuple(rooms))
    star = star if header.unit == "m" else _scaled(star, PIXEL)
    return star, header.format, header.provenance


def star_record(star: Star, format_: str, provenance: Provenance | None) -> dict[str, Any]:
    """Return the record of a star, in metres."""
    record: dict[str, Any] = {
        "format": format_,
        "unit": "m",
        "roomNumber": len(star.rooms),
        "floor": msgspec.to_builtins(star.floor),
    }
    for index, room in enumerate(star.rooms):
        record[f"R{index}"] = msgspec.to_builtins(room)
    if provenance is not None:
        record["provenance"] = msgspec.to_builtins(provenance)
    return record


def _scaled(star: Star, factor: float) -> Star:
    """Return the star with every length multiplied by the factor."""

    def scaled(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: scaled(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [scaled(item) for item in value]
        return value * factor if isinstance(value, float) else value

    return msgspec.convert(scaled(msgspec.to_builtins(star)), Star)
