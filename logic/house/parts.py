"""The parts of a house: rooms with their furniture, the doors that join them, and windows.

Metres; x grows east and y grows south, so a rectangle's ``x, y`` is its north-west corner.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Annotated, Any, Literal, Self

import msgspec
from msgspec import UNSET, Meta, UnsetType

from logic.house.promises import Promises
from logic.plain import plain

FORMAT = "vitruvius-2"
"""Files of any house: rooms, doors and windows in lists in words (``records.py``)."""

STAR_FORMAT = "vitruvius-1"
"""Files of stars alone: a main room, and rooms with one door each (``star.py``)."""

STAR = "star"
"""The topology of rooms around a main room: each touches it from outside, where its door is."""

ORIGINAL = "original"
"""The original program's topology, and its files: a star whose rooms overlap ``floor``, and the main room is
``floor`` minus the rooms.
"""

MAP = "map"
"""The topology of a house that is a map of cells (``occupancy.py``), and the name and type of all of it."""

MAIN, OUTSIDE = "main", "outside"
"""Names: of the main room of a star; of what is no room, where a door may lead."""

PIXEL = 0.3048 / 8.5
"""Metres in a pixel of the original's files: 8.5 px to a foot."""

BODY = 0.287
"""Metres: side of the square body that walks in houses, and the least cell of a grid."""

FARTHEST, MOST_ROOMS, MOST_PIECES, MOST_OPENINGS, MOST_WALLS = 1000.0, 1024, 256, 4096, 65536
"""What is read of a file: metres from the origin, rooms of a house, pieces of a room, doors or windows, walls
that stand by themselves."""

MAX_HOUSE_PIECES = 8192
"""Number of pieces in all rooms of a house together."""

# What the published schema says beside the types; the reader says it in words (``records.py``).
Place = Annotated[float, Meta(extra_json_schema={"minimum": -FARTHEST, "maximum": FARTHEST})]
Length = Annotated[float, Meta(extra_json_schema={"minimum": 0, "maximum": 2 * FARTHEST})]

LONGEST_NAME = 64
"""Characters."""

WORDS = r"^[^\s\x00-\x1f\x7f]([^\x00-\x1f\x7f]*[^\s\x00-\x1f\x7f])?$"
"""Any letters, with spaces between them."""

Name = Annotated[str, Meta(pattern=WORDS, max_length=LONGEST_NAME)]
"""Of a room, in words: as ``explain`` takes it, in ``R3.bed`` or ``Living Room.sofa``."""

Orientation = Literal["", "N", "E", "S", "W"]


def _hold_plain(part: msgspec.Struct) -> None:
    for name in part.__struct_fields__:
        if hasattr(value := getattr(part, name), "tolist"):
            msgspec.structs.force_setattr(part, name, plain(value))


class Rect(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An axis-aligned rectangle, in metres."""

    x: Place
    y: Place
    width: Length
    height: Length

    def __post_init__(self) -> None:
        """Replace numbers of another library, such as NumPy's, by Python's."""
        # Written out for speed: a file has many rectangles.
        if not (type(self.x) is type(self.y) is type(self.width) is type(self.height) is float):
            _hold_plain(self)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """(west, north, east, south), metres."""
        return self.x, self.y, self.x + self.width, self.y + self.height

    @property
    def area(self) -> float:
        """Square metres."""
        return self.width * self.height

    def grown(self, by: float) -> Self:
        """The same with so much more on each side, metres."""
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
        """The longer side, metres: of a segment, from one end to the other."""
        return max(self.width, self.height)


class Piece(Rect, frozen=True, forbid_unknown_fields=True):
    """An item of furniture; ``orientation`` says where its front faces, empty where it has none."""

    type: str
    orientation: Orientation = ""
    children: tuple[Piece, ...] = ()


def pieces_of(children: tuple[Piece, ...]) -> tuple[Piece, ...]:
    """Every piece of a room, each before its own children."""
    return tuple(piece for top in children for piece in _family(top))


def _family(piece: Piece) -> Iterator[Piece]:
    yield piece
    for child in piece.children:
        yield from _family(child)


class Room(Rect, frozen=True, forbid_unknown_fields=True):
    """A room: a rectangle with a name, a type and furniture."""

    name: Name
    type: str
    children: tuple[Piece, ...] = ()
    storey: Literal[0] = 0
    part_of: Name | UnsetType = UNSET
    """The room that it is a part of: no wall is between them."""

    @property
    def pieces(self) -> tuple[Piece, ...]:
        """Every piece in the room, each before its own children."""
        return pieces_of(self.children)


class Door(Rect, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """A door in the wall between two rooms, or between a room and ``outside``: a segment, so its width or
    its height is zero.
    """

    between: tuple[Name, Name]
    opening: bool = False
    """Whether it has no leaf, so that it is never shut."""

    @property
    def is_entrance(self) -> bool:
        """Whether it leads outside."""
        return OUTSIDE in self.between


class Window(Rect, frozen=True, forbid_unknown_fields=True):
    """A window in an outer wall of a room: a segment."""

    room: Name


class FreeWall(msgspec.Struct, frozen=True, array_like=True, forbid_unknown_fields=True):
    """A wall that stands by itself, at any angle: a segment with a thickness, half of it on each side. In
    files it is the list of these five numbers, metres.
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
        """What it fills (west, north, east, south), metres, where it runs along an axis; else None."""
        (west, north, east, south), half = self.around.box, self.thickness / 2
        if west == east:
            return west - half, north, east + half, south
        return (west, north - half, east, south + half) if north == south else None

    @property
    def around(self) -> Rect:
        """The rectangle around its two ends, metres."""
        (west, east), (north, south) = sorted((self.x1, self.x2)), sorted((self.y1, self.y2))
        return Rect(west, north, east - west, south - north)

    @property
    def oriented(self) -> tuple[float, float, float, float, float, float]:
        """Its middle, the unit vector that it runs along, half its length and half its thickness, metres."""
        x, y, length = self.x2 - self.x1, self.y2 - self.y1, hypot(self.x2 - self.x1, self.y2 - self.y1)
        middle = (self.x1 + self.x2) / 2, (self.y1 + self.y2) / 2
        return *middle, x / length, y / length, length / 2, self.thickness / 2

    @property
    def corners(self) -> tuple[tuple[float, float], ...]:
        """Its four corners, metres, clockwise as it is seen from above, y south."""
        x, y, u, v, half, thick = self.oriented
        along, across = (half * u, half * v), (-thick * v, thick * u)
        return tuple(
            (x + a * along[0] + b * across[0], y + a * along[1] + b * across[1])
            for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        )


class Provenance(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """Where a house comes from: enough to make it again."""

    grammar: str
    grammar_hash: str
    request: dict[str, Any]
    seed: int
    index: int
    versions: dict[str, str]
    promises: Promises | None = None
    """What houses of the grammar keep, by plain geometry: ``vitruvius check`` judges by it."""
    gave_way: tuple[str, ...] = ()
    """Typical rules of the grammar that gave way to what the request states of the rooms."""
