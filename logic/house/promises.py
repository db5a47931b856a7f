"""What houses promise, as data: what ``check`` judges them by."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from logic.errors import RequestError
from logic.plain import plain
from logic.spelling import unknown

CLEARANCE = 0.45
"""Metres: nothing stands nearer to a door, on either side of its wall."""
FRONTAL = 0.4572
"""Metres: the paper's 1.5 feet, which the original's houses keep clear in front of a door and behind it."""
PASSAGE = 0.42
"""Metres: the least width of a passage (the body measures 0.394 m on the diagonal)."""

Metres = Annotated[float, Meta(ge=0, le=1000)]


class Thickness(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Thickness of walls between rooms and of outer walls, metres. Outer walls are no thinner."""

    inner: Metres
    outer: Metres


Sizes = tuple[float, float, float, float]
"""Least and greatest width (or length), least and greatest depth, metres."""

Relation = tuple[float, float, float]
"""Numbers a, b and c: a times the width (or length) plus b times the depth is at most c, metres."""


class Promises(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """Promises of a grammar. A field that is empty promises nothing. Lengths in metres."""

    door_width: Metres | None = None
    """Width of every door of a star (None: any width that is the same in the whole house), and least width of
    doors in other houses, metres.
    """
    door_widths: dict[str, dict[str, Metres]] = {}
    """Width of doors by room type and by the type of the other room or ``outside``, metres."""
    door_clearance: Metres = CLEARANCE
    """Least distance of furniture from a door, metres."""
    passage: Metres = PASSAGE
    """Side of a square that can move to every place where it fits, metres."""
    front: Metres | None = None
    """Depth of free floor in front of a piece that is used from there, metres; None for ``passage``."""
    room_gap: Metres | None = None
    """Least distance of two rooms, metres."""
    basic: tuple[str, ...] = ()
    """Room types: from two rooms on two rooms are of these, from ``len(basic)`` on one is of each."""
    a_side: int | None = None
    """From four rooms on at most ``rooms // a_side + 1`` of them are on one side of the main room."""
    room_size: dict[str, Sizes] = {}
    """Sizes by room type. In a star the width runs along the wall with the door; elsewhere either way."""
    room_relations: dict[str, tuple[Relation, ...]] = {}
    """Relations of width and depth, by room type; not on a grid."""
    room_area: dict[str, tuple[float, float]] = {}
    """Least and greatest area by room type in other houses, square metres."""
    whole_area: dict[str, tuple[float, float]] = {}
    """Least and greatest area of a room with its parts, by room type, square metres."""
    house_area: tuple[float, float] | None = None
    """Least and greatest area of all rooms of a house, including a star's main room, square metres."""
    house_size: tuple[Relation, ...] = ()
    """Relations of the width, from west to east, and the depth of the box around all rooms, or around each
    unit in a house of units.
    """
    same_size: dict[str, bool] = {}
    """Room types whose rooms are equally large in other houses, or in a unit: whether some may lie across."""
    narrowest: dict[str, float] = {}
    """Least shorter side by room type in other houses, metres."""
    wall_thickness: Thickness | None = None
    """Thickness of walls; None for any thickness."""
    opens: dict[str, tuple[str, ...]] = {}
    """For each room type, and for ``outside``, those that it may open into; a door needs one direction."""
    degree: dict[str, tuple[int, int]] = {}
    """Least and greatest number of other rooms that doors join to a room, by room type; public rooms do not
    count.
    """
    openings: dict[str, tuple[str, ...]] = {}
    """Room types, by room type, towards which a door may have no leaf."""
    parts: dict[str, tuple[str, ...]] = {}
    """Room types of the rooms that a room of a type belongs to, without a wall between them."""
    entrance: bool = False
    """True if a house has a door to the outside."""
    public: tuple[str, ...] = ()
    """Room types that units are entered from: without such rooms, each part of a house that doors join has
    one door to them, and none to the outside.
    """
    courts: int = 0
    """Number of boxes between rooms that may belong to no room, at least a metre both ways."""
    lit: tuple[str, ...] = ()
    """Room types that have a window."""
    outdoor: tuple[str, ...] = ()
    """Room types that are outside: they have no window and no part in ``house_area``, and light others."""
    turning: dict[str, float] = {}
    """Side of a square that is free in each room, by room type, metres."""
    even_rows: dict[str, tuple[str, ...]] = {}
    """Piece types in the even rows, by room type."""
    hides: tuple[str, ...] = ()
    """Piece types that do not stand before a window."""
    empty: tuple[str, ...] = ()
    """Room types of a star that may have no furniture."""
    piece_size: dict[str, Sizes] = {}
    """Sizes by piece type; the length runs along the back."""
    piece_relations: dict[str, tuple[Relation, ...]] = {}
    """Relations of length and depth, by piece type; not on a grid."""
    counts: dict[str, dict[str, tuple[int, int]]] = {}
    """Least and greatest number of pieces, by room type and piece type. There are no other room types."""
    companions: dict[str, dict[str, tuple[int, int]]] = {}
    """For each piece type with companions, how many it has; turned at a wall none, but for ``at_head``."""
    at_head: tuple[str, ...] = ()
    """Piece types that have their companions when they are turned too: one, at the head."""
    at_wall: tuple[str, ...] = ()
    """Piece types that never stand in the middle of a room: they touch a wall."""
    turns: tuple[str, ...] | None = None
    """Piece types that may stand with a side to a wall, their back to something else; None for all."""
    free_foot: tuple[str, ...] = ()
    """Piece types that, turned, have their head to a wall or to another piece, and nothing at their foot."""
    clear_front: tuple[str, ...] = ()
    """Piece types that are used from their front: it is free in front of them, all along."""
    spans: dict[str, tuple[float, float]] = {}
    """Piece types that take a share of their wall: the least and the greatest."""
    shares: dict[str, tuple[float, float]] = {}
    """Piece types each of whose sides takes a share of the room's: the least and the greatest."""
    tops: dict[str, tuple[float, float]] = {}
    """Of each piece type: least and greatest area, square metres."""
    meet: tuple[str, ...] = ()
    """Piece types of which one stands at a wall; at neighbouring walls they touch, none is opposite alone."""

    def beside(self, other: "Promises") -> "Promises":
        """These promises, and what is promised in another way alone."""
        return msgspec.structs.replace(other, **given(self))

    def suits(self, room: str, piece: str) -> bool:
        """Whether a room of this type may have such a piece, by itself or as a companion."""
        if room not in self.counts:
            return True
        tops = self.counts[room]
        return piece in tops or any(piece in self.companions.get(top, {}) for top in tops)

    def least_door(self, one: str, other: str) -> float | None:
        """The least width of a door between rooms of these types, metres."""
        by_pair = self.door_widths.get(one, {}).get(other), self.door_widths.get(other, {}).get(one)
        return next((width for width in by_pair if width is not None), self.door_width)

    def are_open(self, one: str, other: str) -> bool:
        """Whether a door between rooms of these types may be without a leaf."""
        pairs = ((one, other), (other, one))
        return any(b in self.openings.get(a, ()) or b in self.parts.get(a, ()) for a, b in pairs)


PROMISES = msgspec.json.decode(Path(__file__).with_suffix(".json").read_bytes(), type=dict[str, Promises])
"""What is said of the shipped grammars, and of the original's houses, apart from their rules: a wrong rule
shows as a broken promise.
"""


def given(promises: Promises) -> dict[str, Any]:
    """The fields of promises that say something."""
    silent = msgspec.structs.asdict(Promises())
    said = msgspec.structs.asdict(promises)
    return {name: value for name, value in said.items() if value != silent[name]}


def read_promises(stated: Mapping[str, Any], others: Promises) -> Promises:
    """Promises of which some are stated, by the names of fields, and the others are as given.

    Raises ``RequestError`` for a name that is no field, and for a value that none can have.
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
