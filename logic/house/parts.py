"""Parts of a house: rooms with furniture, the doors that join them, and windows.

Metres; x grows east and y grows south, so that a rectangle's ``x, y`` is its north-west corner.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Annotated, Any, Literal, Self

import msgspec
from msgspec import UNSET, Meta, UnsetType

from vitruvius.logic.house.promises import Promises, Type
from vitruvius.logic.plain import plain

FORMAT = "vitruvius-2"
"""Format of files for any house, with lists of rooms, doors and windows (``records.py``)."""

STAR_FORMAT = "vitruvius-1"
"""Format of files for stars only: a main room, and rooms with one door each (``star.py``)."""

STAR = "star"
"""Topology of rooms around a main room: each room touches it from outside, where its door is."""

ORIGINAL = "original"
"""Topology and files of the original program: a star whose rooms overlap ``floor``.

The main room is ``floor`` minus the rooms.
"""

MAP = "map"
"""Topology of a house that is a map of cells (``occupancy.py``), and name and type of its first room."""

MAIN, OUTSIDE = "main", "outside"
"""Names of the main room of a star, and of the outside, where a door may lead."""

PIXEL = 0.3048 / 8.5
"""Metres per pixel of the original's files: 8.5 px per foot."""

BODY = 0.287
"""Side of the robot, a square that moves through houses, and least cell of a grid, metres."""

MAX_COORDINATE_M, MOST_ROOMS, MOST_PIECES, MOST_OPENINGS, MOST_WALLS = 1000.0, 1024, 256, 4096, 65536
"""Limits of a file: metres from the origin, and numbers of rooms, pieces of a room, openings, free walls."""

MAX_HOUSE_PIECES = 8192
"""Largest number of pieces in all rooms of a house together."""

# Limits in the published schema; the reader states the others in words (``records.py``).
Place = Annotated[float, Meta(extra_json_schema={"minimum": -MAX_COORDINATE_M, "maximum": MAX_COORDINATE_M})]
Length = Annotated[float, Meta(extra_json_schema={"minimum": 0, "maximum": 2 * MAX_COORDINATE_M})]

LONGEST_NAME = 64
"""Largest number of characters of a room's name."""

WORDS = r"^[^\s\x00-\x1f\x7f]([^\x00-\x1f\x7f]*[^\s\x00-\x1f\x7f])?$"
"""Pattern of any letters, with spaces between them."""

Name = Annotated[str, Meta(pattern=WORDS, max_length=LONGEST_NAME)]
"""Name of a room in words, as ``explain`` takes it: ``R3.bed``, ``Living Room.sofa``."""

Orientation = Literal["", "N", "E", "S", "W"]


def _hold_plain(part: msgspec.Struct) -> None:
    for name in part.__struct_fields__:
        if hasattr(value := getattr(part, name), "tolist"):
            msgspec.structs.force_setattr(part, name, plain(value))


class Rect(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Axis-aligned rectangle, in metres."""

    x: Place
    y: Place
    width: Length
    height: Length

    def __post_init__(self) -> None:
        """Replace numbers of another library, such as NumPy's, by Python's."""
        # Written out for speed, since a file has many rectangles.
        if not (type(self.x) is type(self.y) is type(self.width) is type(self.height) is float):
            _hold_plain(self)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """(west, north, east, south), metres."""
        return self.x, self.y, self.x + self.width, self.y + self.height

    @property
    def area(self) -> float:
        """Area, square metres."""
        return self.width * self.height

    def grown(self, by: float) -> Self:
        """Return the rectangle enlarged by ``by`` metres on each side."""
        if not by:
            return self
        sides = {
            "x": self.x - by,
            "y": self.y - by,
            "width": self.width + 2 * by,
            "height": self.height + 2 * by,
        }
        return msgspec.structs.replace(self, **sides)

    @property
    def length(self) -> float:
        """Longer side, metres, which is the length of a segment."""
        return max(self.width, self.height)


class Piece(Rect, frozen=True, forbid_unknown_fields=True):
    """Item of furniture. ``orientation`` is the direction of its front, empty without a front."""

    type: Type
    orientation: Orientation = ""
    children: tuple[Piece, ...] = ()


def pieces_of(children: tuple[Piece, ...]) -> tuple[Piece, ...]:
    """Return every piece of a room, each before its own children."""
    return tuple(piece for top in children for piece in _family(top))


def _family(piece: Piece) -> Iterator[Piece]:
    yield piece
    for child in piece.children:
        yield from _family(child)


class Room(Rect, frozen=True, forbid_unknown_fields=True):
    """Room: a rectangle with a name, a type and furniture."""

    name: Name
    type: Type
    children: tuple[Piece, ...] = ()
    storey: Literal[0] = 0
    part_of: Name | UnsetType = UNSET
    """Name of the room that it is a part of, without a wall between them."""

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Every piece in the room, each before its own children."""
        return pieces_of(self.children)


class Door(Rect, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """Door in the wall between two rooms, or between a room and ``outside``.

    The door is a segment, so its width or its height is zero.
    """

    between: tuple[Name, Name]
    opening: bool = False
    """True for a door without a leaf, which is never shut."""

    @property
    def is_entrance(self) -> bool:
        """True if the door leads outside."""
        return OUTSIDE in self.between


class Window(Rect, frozen=True, forbid_unknown_fields=True):
    """Window in an outer wall of a room: a segment."""

    room: Name


class FreeWall(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """Free-standing wall at any angle: a segment with a thickness, half of it on each side.

    In files it is a list of these five numbers, metres.
    """

    x1: Place
    y1: Place
    x2: Place
    y2: Place
    thickness: Length

    def __post_init__(self) -> None:
        """Replace numbers of another library, such as NumPy's, by Python's."""
        _hold_plain(self)

    @property
    def box(self) -> tuple[float, float, float, float] | None:
        """Box of the wall (west, north, east, south), metres, if it runs along an axis; else None."""
        (west, north, east, south), half = self.around.box, self.thickness / 2
        if west == east:
            return west - half, north, east + half, south
        return (west, north - half, east, south + half) if north == south else None

    @property
    def around(self) -> Rect:
        """Rectangle around its two ends, metres."""
        (west, east), (north, south) = sorted((self.x1, self.x2)), sorted((self.y1, self.y2))
        return Rect(west, north, east - west, south - north)

    @property
    def oriented(self) -> tuple[float, float, float, float, float, float]:
        """Its middle, the unit vector along it, half its length and half its thickness, metres."""
        x, y, length = self.x2 - self.x1, self.y2 - self.y1, hypot(self.x2 - self.x1, self.y2 - self.y1)
        middle = (self.x1 + self.x2) / 2, (self.y1 + self.y2) / 2
        return *middle, x / length, y / length, length / 2, self.thickness / 2

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Its four corners, metres, clockwise as seen from above, with y south."""
        x, y, u, v, half, thick = self.oriented
        along, across = (half * u, half * v), (-thick * v, thick * u)
        return tuple(
            (x + a * along[0] + b * across[0], y + a * along[1] + b * across[1])
            for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        )


class Provenance(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """Origin of a house, with all data to generate it again."""

    grammar: str
    grammar_hash: str
    request: dict[str, Any]
    seed: int
    index: int
    versions: dict[str, str]
    promises: Promises | None = None
    """Promises of the grammar's houses in plain geometry, by which ``vitruvius check`` judges them."""
    gave_way: tuple[str, ...] = ()
    """Typical rules of the grammar that gave way to the request's statements about rooms."""
