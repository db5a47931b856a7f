"""The house: a main room, the rooms around it, their doors and their furniture.

Metres; x grows east and y grows south, so a rectangle's ``x, y`` is its north-west corner.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

import msgspec

from logic.spelling import unknown

FORMAT = "vitruvius-1"
"""Our files: a room touches the main room from outside, along the wall that holds its door."""

ORIGINAL = "original"
"""The original program's files: rooms overlap ``floor``; the main room is ``floor`` minus the rooms."""

PIXEL = 0.3048 / 8.5
"""Metres in a pixel of the original's files: 8.5 px to a foot."""

BODY = 0.287
"""Metres: side of the square body that walks in houses, and the least cell of a grid."""

FARTHEST, MOST_ROOMS, MOST_PIECES = 1000.0, 1024, 256
"""What is read of a file: metres from the origin, rooms of a house, pieces of a room."""

Orientation = Literal["", "N", "E", "S", "W"]


class Rect(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An axis-aligned rectangle, in metres."""

    x: float
    y: float
    width: float
    height: float

    @property
    def box(self) -> tuple[float, float, float, float]:
        """(west, north, east, south), metres."""
        return self.x, self.y, self.x + self.width, self.y + self.height

    @property
    def area(self) -> float:
        """Square metres."""
        return self.width * self.height


class Piece(Rect, frozen=True, forbid_unknown_fields=True):
    """An item of furniture; ``orientation`` says where its front faces, empty where it has none."""

    type: str
    orientation: Orientation = ""
    children: tuple[Piece, ...] = ()


class Door(Rect, frozen=True, forbid_unknown_fields=True):
    """An opening in a wall: a segment, so its width or its height is zero."""


class Room(Rect, frozen=True, forbid_unknown_fields=True):
    """A secondary room: a rectangle with a type, furniture and one door to the main room."""

    type: str
    children: tuple[Piece, ...]
    door: Door

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Every piece in the room, each before its own children."""
        return tuple(piece for top in self.children for piece in _family(top))


def _family(piece: Piece) -> Iterator[Piece]:
    yield piece
    for child in piece.children:
        yield from _family(child)


class Provenance(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """Where a house comes from: enough to make it again."""

    grammar: str
    grammar_hash: str
    request: dict[str, Any]
    seed: int
    index: int
    versions: dict[str, str]


class House(msgspec.Struct, frozen=True):
    """A furnished house. Rooms are named ``R0``, ``R1``... by their place in ``rooms``."""

    floor: Rect
    rooms: tuple[Room, ...]
    format: Literal["vitruvius-1", "original"] = FORMAT
    provenance: Provenance | None = None

    def only(self, *names: str) -> House:
        """The house with these rooms alone, by name (``"R0"``), for ``generate(keep=...)``.

        Raises ``ValueError`` for a name that no room has.
        """
        known = {f"R{index}": room for index, room in enumerate(self.rooms)}
        for name in names:
            if name not in known:
                raise ValueError(unknown("room", name, known))
        return House(self.floor, tuple(room for name, room in known.items() if name in names), self.format)

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> House:
        """Read a house from its JSON form; lengths without ``unit`` are the original's pixels.

        Raises ``ValueError`` (``msgspec.ValidationError``) that names the first wrong field.
        """
        return _from_dict(record)

    def to_dict(self) -> dict[str, Any]:
        """Write the house in its JSON form, in metres; ``from_dict`` gives the same house back."""
        record: dict[str, Any] = {
            "format": self.format,
            "unit": "m",
            "roomNumber": len(self.rooms),
            "floor": msgspec.to_builtins(self.floor),
        }
        for index, room in enumerate(self.rooms):
            record[f"R{index}"] = msgspec.to_builtins(room)
        if self.provenance is not None:
            record["provenance"] = msgspec.to_builtins(self.provenance)
        return record


class _Header(msgspec.Struct, forbid_unknown_fields=True):
    """All of a house's record but its rooms."""

    roomNumber: int
    floor: Rect
    format: Literal["vitruvius-1", "original"] = ORIGINAL
    unit: Literal["m"] | None = None
    provenance: Provenance | None = None


def _from_dict(record: dict[str, Any]) -> House:
    if not isinstance(record, dict):
        raise msgspec.ValidationError(f"a house is a JSON object, not {type(record).__name__}")
    is_room = {key: key[:1] == "R" and key[1:].isdecimal() for key in record}
    header = msgspec.convert({k: v for k, v in record.items() if not is_room[k]}, _Header)
    found = sum(is_room.values())
    if header.roomNumber != found:
        raise msgspec.ValidationError(f"roomNumber is {header.roomNumber}, but {found} rooms follow")
    rooms = []
    for index in range(found):
        if f"R{index}" not in record:
            raise msgspec.ValidationError(f"roomNumber is {found}, but R{index} is missing")
        try:
            rooms.append(msgspec.convert(record[f"R{index}"], Room))
        except msgspec.ValidationError as error:
            raise msgspec.ValidationError(f"R{index}: {error}") from None
    house = House(header.floor, tuple(rooms), header.format, header.provenance)
    house = house if header.unit == "m" else _scaled(house, PIXEL)
    _require_sizes(house)
    return house


def _scaled(house: House, factor: float) -> House:
    """The same house with every length multiplied by the factor."""

    def scaled(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: scaled(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [scaled(item) for item in value]
        return value * factor if isinstance(value, float) else value

    floor = msgspec.convert(scaled(msgspec.to_builtins(house.floor)), Rect)
    rooms = tuple(msgspec.convert(scaled(msgspec.to_builtins(room)), Room) for room in house.rooms)
    return House(floor, rooms, house.format, house.provenance)


def _require_sizes(house: House) -> None:
    """Refuse what is no house at all: sizes that are not positive, lengths that are not finite, and too many
    or too far parts, before anything is computed of them.
    """
    cell = house.provenance.request.get("cell", 0.0) if house.provenance else 0.0
    if type(cell) not in (int, float) or not 0 <= cell <= FARTHEST:
        raise msgspec.ValidationError(f"provenance.request.cell must be a length in metres, not {cell!r}")
    if len(house.rooms) > MOST_ROOMS:
        raise msgspec.ValidationError(f"has {len(house.rooms)} rooms: at most {MOST_ROOMS:,}")

    def require(rect: Rect, name: str) -> None:
        if not all(abs(value) <= FARTHEST for value in rect.box):
            raise msgspec.ValidationError(f"{name} lies beyond {FARTHEST:g} m or is not a number")
        if rect.width < 0 or rect.height < 0 or (rect.area == 0 and not isinstance(rect, Door)):
            raise msgspec.ValidationError(f"{name} is {rect.width} by {rect.height}: sizes must be positive")

    require(house.floor, "floor")
    for index, room in enumerate(house.rooms):
        require(room, f"R{index}")
        require(room.door, f"R{index}.door")
        if len(room.pieces) > MOST_PIECES:
            raise msgspec.ValidationError(f"R{index} has {len(room.pieces)} pieces: at most {MOST_PIECES:,}")
        if (room.door.width > 0) == (room.door.height > 0):
            raise msgspec.ValidationError(f"R{index}.door must be a segment: its width or its height is zero")
        for place, piece in enumerate(room.pieces):
            require(piece, f"R{index}, piece {place} ({piece.type})")
