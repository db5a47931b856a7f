"""Promises of houses, as data by which ``check`` judges them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

import msgspec
from msgspec import Meta

from vitruvius.logic.errors import RequestError
from vitruvius.logic.plain import plain
from vitruvius.logic.spelling import unknown

CLEARANCE = 0.45
"""Least distance of everything from a door, on either side of its wall, metres."""
FRONTAL = 0.4572
"""Free depth in front of a door and behind it in the original's houses, metres: the paper's 1.5 feet."""
PASSAGE = 0.42
"""Least width of a passage, metres; the robot measures 0.394 m on the diagonal."""

Metres = Annotated[float, Meta(ge=0, le=1000)]

MAX_TYPES, MAX_RELATIONS, LONGEST_TYPE = 512, 64, 128
"""Number of types that a promise names; of relations of a type; of characters of a type: ``check`` compares
all with each room or piece.
"""

Type = Annotated[str, Meta(max_length=LONGEST_TYPE)]
"""Type of a room or a piece."""

Types = Annotated[tuple[Type, ...], Meta(max_length=MAX_TYPES)]

Value = TypeVar("Value")
ByType = Annotated[dict[Type, Value], Meta(max_length=MAX_TYPES)]
"""A value for each of some types."""


class Thickness(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Thickness of walls between rooms and of outer walls, metres. Outer walls are no thinner."""

    inner: Metres
    outer: Metres


Sizes = tuple[float, float, float, float]
"""Least and greatest width (or length), least and greatest depth, metres."""

Relation = tuple[float, float, float]
"""Numbers a, b and c: a times the width (or length) plus b times the depth is at most c, metres."""

Relations = Annotated[tuple[Relation, ...], Meta(max_length=MAX_RELATIONS)]


class Promises(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Promises of a grammar. A field that is empty promises nothing. Lengths in metres."""

    door_width: Metres | None = None
    """Width of every door of a star, and least width of doors in other houses, metres.

    None permits any width that is the same in a whole star.
    """
    door_widths: ByType[ByType[Metres]] = {}
    """Width of doors by room type and by the type of the other room or ``outside``, metres."""
    door_clearance: Metres = CLEARANCE
    """Least distance of furniture from a door, metres."""
    passage: Metres = PASSAGE
    """Side of a square that can move to every place where it fits, metres."""
    front: Metres | None = None
    """Depth of free floor in front of a piece that is used from there, metres; None for ``passage``."""
    room_gap: Metres | None = None
    """Least distance of two rooms, metres."""
    basic: Types = ()
    """Basic room types. From two rooms on two rooms are of these, from ``len(basic)`` on one is of each."""
    a_side: Annotated[int, Meta(ge=1)] | None = None
    """Divisor for the rooms per side of the main room: from four rooms on at most ``rooms // a_side + 1``."""
    room_size: ByType[Sizes] = {}
    """Sizes by room type. In a star the width runs along the wall with the door; elsewhere either way."""
    room_relations: ByType[Relations] = {}
    """Relations of width and depth, by room type; not on a grid."""
    room_area: ByType[tuple[float, float]] = {}
    """Least and greatest area by room type in other houses, square metres."""
    whole_area: ByType[tuple[float, float]] = {}
    """Least and greatest area of a room with its parts, by room type, square metres."""
    house_area: tuple[float, float] | None = None
    """Least and greatest area of all rooms of a house, including a star's main room, square metres."""
    house_size: Relations = ()
    """Relations of the width, from west to east, and the depth of the box around all rooms.

    In a house of units the relations hold for the box around each unit.
    """
    same_size: ByType[bool] = {}
    """Room types whose rooms are equally large in other houses, or in a unit; True if some may be turned."""
    narrowest: ByType[float] = {}
    """Least shorter side by room type in other houses, metres."""
    wall_thickness: Thickness | None = None
    """Thickness of walls; None for any thickness."""
    opens: ByType[Types] = {}
    """Room types, and ``outside``, that each room type may open into. A door needs one direction."""
    degree: ByType[tuple[int, int]] = {}
    """Least and greatest number of other rooms that doors join to a room, by room type.

    Public rooms do not count.
    """
    openings: ByType[Types] = {}
    """Room types, by room type, towards which a door may have no leaf."""
    parts: ByType[Types] = {}
    """Room types of the rooms that a room of a type belongs to, without a wall between them."""
    entrance: bool = False
    """True if a house has a door to the outside."""
    public: Types = ()
    """Room types from which units are entered.

    Without these rooms, each connected part of a house has one door to them, and none to the outside.
    """
    courts: int = 0
    """Number of boxes between rooms that may belong to no room, at least a metre both ways."""
    lit: Types = ()
    """Room types that have a window."""
    outdoor: Types = ()
    """Room types that are outdoors.

    They have no window, do not count in ``house_area``, and light other rooms.
    """
    turning: ByType[float] = {}
    """Side of a square that is free in each room, by room type, metres."""
    even_rows: ByType[Types] = {}
    """Piece types in the even rows, by room type."""
    hides: Types = ()
    """Piece types that do not stand before a window."""
    empty: Types = ()
    """Room types of a star that may have no furniture."""
    piece_size: ByType[Sizes] = {}
    """Sizes by piece type; the length runs along the back."""
    piece_relations: ByType[Relations] = {}
    """Relations of length and depth, by piece type; not on a grid."""
    counts: ByType[ByType[tuple[int, int]]] = {}
    """Least and greatest number of pieces, by room type and piece type. There are no other room types."""
    companions: ByType[ByType[tuple[int, int]]] = {}
    """Number of companions, by piece type. A turned piece at a wall has none, except for ``at_head``."""
    at_head: Types = ()
    """Piece types that keep one companion, at the head, when they are turned."""
    at_wall: Types = ()
    """Piece types that always touch a wall and never stand in the middle of a room."""
    turns: Types | None = None
    """Piece types that may stand with a side to a wall and their back to something else; None for all."""
    free_foot: Types = ()
    """Piece types that, when turned, have their head at a wall or another piece and nothing at their foot."""
    clear_front: Types = ()
    """Piece types that are used from their front, which is free along its whole length."""
    spans: ByType[tuple[float, float]] = {}
    """Least and greatest fraction of its wall that a piece takes, by piece type."""
    shares: ByType[tuple[float, float]] = {}
    """Least and greatest fraction of the room's sides that a piece's sides take, by piece type."""
    tops: ByType[tuple[float, float]] = {}
    """Least and greatest area, by piece type, square metres."""
    meet: Types = ()
    """Piece types with at most one piece at a wall, whose pieces touch at neighbouring walls.

    Two pieces never stand at opposite walls without a third one between them.
    """

    def suits(self, room: str, piece: str) -> bool:
        """Return True if a room of this type may have a piece of this type, alone or as a companion."""
        if room not in self.counts:
            return True
        tops = self.counts[room]
        return piece in tops or any(piece in self.companions.get(top, {}) for top in tops)

    def least_door(self, one: str, other: str) -> float | None:
        """Return the least width of a door between rooms of these types, metres."""
        by_pair = self.door_widths.get(one, {}).get(other), self.door_widths.get(other, {}).get(one)
        return next((width for width in by_pair if width is not None), self.door_width)

    def are_open(self, one: str, other: str) -> bool:
        """Return True if a door between rooms of these types may have no leaf."""
        pairs = ((one, other), (other, one))
        return any(b in self.openings.get(a, ()) or b in self.parts.get(a, ()) for a, b in pairs)


OLD_PROMISES = msgspec.json.decode(
    Path(__file__).with_name("old_promises.json").read_bytes(), type=dict[str, Promises]
)
"""Promises of the original's houses, and of shipped grammars as of 2026-11-25, by name.

They judge files without promises. Since that day each house carries the promises of its rules, so these
never change.
"""


def read_promises(stated: Mapping[str, Any], others: Promises) -> Promises:
    """Return promises with the stated fields replaced, by name, and the others as given.

    Raises ``RequestError`` for a name that is no field, and for a wrong value.
    """
    names = [field.name for field in msgspec.structs.fields(Promises)]
    for name in stated:
        if name not in names:
            raise RequestError(f"promises: {unknown('promise', name, names)}")
    try:
        read = msgspec.convert(plain(stated), Promises)
    except msgspec.ValidationError as error:
        raise RequestError(f"promises: {error}") from None
    return msgspec.structs.replace(others, **{name: getattr(read, name) for name in stated})
