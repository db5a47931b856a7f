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
    """How thick walls are, metres: between rooms, and to the outside. Outer ones are no thinner."""

    inner: Metres
    outer: Metres


Sizes = tuple[float, float, float, float]
"""Least and greatest width (or length), least and greatest depth, metres."""

Relation = tuple[float, float, float]
"""Numbers a, b and c: a times the width (or length) plus b times the depth is at most c, metres."""


class Promises(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """What a grammar promises; left empty, it promises nothing more. Lengths in metres."""

    door_width: Metres | None = None
    """Metres: the width of a star's every door (None where it need only be the same throughout a house), the
    least width of others.
    """
    door_widths: dict[str, dict[str, Metres]] = {}
    """For room types, and those of the other room or ``outside``: the width of doors, metres."""
    door_clearance: Metres = CLEARANCE
    """Metres: nothing stands nearer to a door."""
    passage: Metres = PASSAGE
    """Metres: a square this wide gets everywhere that one has room for it."""
    front: Metres | None = None
    """Metres: how deep it is free in front of a piece that is used from there; None: as a passage is wide."""
    room_gap: Metres | None = None
    """Metres: as near as rooms may come to each other."""
    basic: tuple[str, ...] = ()
    """Room types: from two rooms on two rooms are of these, from ``len(basic)`` on one is of each."""
    a_side: int | None = None
    """From four rooms on at most ``rooms // a_side + 1`` of them are on one side of the main room."""
    room_size: dict[str, Sizes] = {}
    """Of each room type; in a star its width runs along the wall with its door, elsewhere either way."""
    room_relations: dict[str, tuple[Relation, ...]] = {}
    """Relations of width and depth, by room type; not on a grid."""
    room_area: dict[str, tuple[float, float]] = {}
    """Of each room type in other houses: least and greatest area, square metres."""
    whole_area: dict[str, tuple[float, float]] = {}
    """Of each room type, with the parts of such a room: least and greatest area, square metres."""
    house_area: tuple[float, float] | None = None
    """Of all rooms of a house together, with a star's main room: least and greatest area, square metres."""
    house_size: tuple[Relation, ...] = ()
    """Relations of the width, from west to east, and the depth of the box around all rooms, or around each
    unit in a house of units.
    """
    same_size: dict[str, bool] = {}
    """Room types whose rooms are equally large in other houses, or in a unit: whether some may lie across."""
    narrowest: dict[str, float] = {}
    """Of each room type in other houses: the least of its shorter side, metres."""
    wall_thickness: Thickness | None = None
    """Metres: how thick walls are; None for any thickness."""
    opens: dict[str, tuple[str, ...]] = {}
    """For each room type, and for ``outside``, those that it may open into; a door needs one direction."""
    degree: dict[str, tuple[int, int]] = {}
    """Least and greatest number of other rooms that doors join to a room, by room type; public rooms do not
    count.
    """
    openings: dict[str, tuple[str, ...]] = {}
    """Between rooms of which types alone, the first and others, a door may be without a leaf."""
    parts: dict[str, tuple[str, ...]] = {}
    """Of rooms of which types rooms of a type are parts: without a wall between them, each of one room."""
    entrance: bool = False
    """Whether a house has a door to the outside."""
    public: tuple[str, ...] = ()
    """Room types that units are entered from: without such rooms, each part of a house that doors join has
    one door to them, and none to the outside.
    """
    courts: int = 0
    """Of plans: how many boxes between rooms may be no room's, a metre or more both ways."""
    lit: tuple[str, ...] = ()
    """Room types that have a window."""
    outdoor: tuple[str, ...] = ()
    """Room types that are outside: they have no window and no part in ``house_area``, and light others."""
    turning: dict[str, float] = {}
    """Of each room type: how wide a square is free in it, metres."""
    even_rows: dict[str, tuple[str, ...]] = {}
    """Of each room type whose rows are even: the piece types that stand in them."""
    hides: tuple[str, ...] = ()
    """Piece types that do not stand before a window."""
    empty: tuple[str, ...] = ()
    """Room types of a star that may have no furniture."""
    piece_size: dict[str, Sizes] = {}
    """Of each piece type: its length runs along its back."""
    piece_relations: dict[str, tuple[Relation, ...]] = {}
    """Relations of length and depth, by piece type; not on a grid."""
    counts: dict[str, dict[str, tuple[int, int]]] = {}
    """For each room type there is, the pieces that it has: from the first to the second number of each."""
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
