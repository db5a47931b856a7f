"""Briefs: requirements on the rooms of a house, each room by its name.

The form is JSON (``docs/briefs.md``). This module rejects briefs that make no sense. A brief that no house
can satisfy is found later, with a proof that names lines of the brief (``logic.generation.brief``).
"""

import json
from collections.abc import Mapping, Sequence
from math import ceil, floor
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.parts import OUTSIDE, Name
from vitruvius.logic.mismatch import mismatch
from vitruvius.logic.opener import content_of, from_json
from vitruvius.logic.spelling import unknown

MOST_BYTES = 1 << 20
"""Largest size of a file, unpacked, in bytes."""

MOST_ROOMS = 24
"""Largest number of rooms of a brief, as the rules grow with the cube of the number."""

TOLERANCE, LEAST_TOLERANCE = 0.1, 0.001
"""Default and least tolerance of an area or a size that is one number, as a fraction of it."""

LEAST_SIDE = 0.5
"""Least side of a room with an area, metres: ``rules/brief/brief.pl``."""

LEAST_VOID = 1.0
"""Least side of a void, metres: ``rules/brief/brief.pl``."""

LARGEST_ROOM = 5_000.0
"""Largest area of a room, square metres, since stage 1 knows an area in steps of the width."""

LENGTHS = {"area", "size", "width", "depth"}
"""Keys of a brief's lengths and areas."""

LONGEST, LARGEST = 400.0, 100_000.0
"""Largest length in metres and area in square metres, so that whole numbers of stage 1 can hold them."""

Side = Literal["north", "east", "south", "west"]
Span = float | tuple[float, float]
"""One number, or a least and a greatest one: metres, or square metres."""

Tolerance = Annotated[float, Meta(ge=0, le=0.5)]
"""Fraction by which a value may be greater or less."""

Pair = tuple[Name, Name]


class Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """Part of a brief's JSON."""

    comment: str = ""
    """Note for people, which the reader ignores."""


class BriefRoom(Part, frozen=True):
    """Requirements on a room. All but its name may be left out."""

    name: Name
    type: str = ""
    """Room type of the grammar."""
    label: str = ""
    """Name of its kind, instead of a type, for a brief without a grammar."""
    area: Span | None = None
    """Area in square metres; one number allows for the ``tolerance``."""
    size: tuple[Span, Span] | None = None
    """Its two sides in any order, metres."""
    tolerance: Tolerance | None = None
    outside: bool | tuple[Side, ...] = False
    """True if it has an outer wall, or the sides that are outer walls."""
    windows: tuple[Side, ...] = ()
    """Sides with a window."""


class Entrance(Part, frozen=True):
    """Room, and optionally its side, by which one enters the house."""

    room: Name
    side: Side | None = None


class Void(Part, frozen=True):
    """Part of the outline that lies outside the house, metres: a notch at a corner, or a court anywhere."""

    width: Span | None = None
    depth: Span | None = None
    corner: Literal["north-west", "north-east", "south-east", "south-west"] | None = None
    x: Span | None = None
    y: Span | None = None


class Outline(Part, frozen=True):
    """Rectangle around the house, metres: its width from west to east, its depth from north to south."""

    width: Span | None = None
    depth: Span | None = None
    voids: tuple[Void, ...] = ()


class Brief(Part, frozen=True):
    """Requirements on the rooms of a house, each room by its name."""

    rooms: tuple[BriefRoom, ...]
    doors: tuple[Pair, ...] = ()
    no_doors: tuple[Pair, ...] = ()
    next_to: tuple[Pair, ...] = ()
    """Rooms that share a wall, with a door in it or without."""
    apart: tuple[Pair, ...] = ()
    """Rooms that do not share a wall."""
    other_doors: bool = False
    """True permits doors that are not in ``doors``, as far as the grammar's rules do.

    By default there are only one more door into each group of rooms that ``doors`` join, and the doors that
    the rules require.
    """
    entrance: Name | Entrance | None = None
    outline: Outline = Outline()
    area: Span | None = None
    """Area within the outline without the voids, square metres."""
    tolerance: Tolerance = TOLERANCE
    schema_: str = msgspec.field(default="", name="$schema")
    """Address of the schema by which an editor checks the file; the reader ignores it."""

    @property
    def names(self) -> list[str]:
        """Names of its rooms, in their order."""
        return [room.name for room in self.rooms]

    @property
    def is_alone(self) -> bool:
        """True if the brief alone defines the house: see ``alone``."""
        return all(room.label for room in self.rooms)


def read_brief(source: str | Path | Mapping[str, Any] | Brief) -> Brief:
    """Return the brief in a JSON form or in a JSON file. Raises ``RequestError`` if it makes no sense."""
    if isinstance(source, str | Path):
        try:
            source = from_json(content_of(source, MOST_BYTES), Any)
        except OSError as error:
            raise RequestError(f"brief: {source} cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise RequestError(f"brief: {source} is not JSON: {error}") from None
    try:
        brief = source if isinstance(source, Brief) else msgspec.convert(source, Brief)
    except msgspec.ValidationError as error:
        raise RequestError(f"brief: {mismatch(error, source, Brief)}") from None
    _require_sense(brief)
    return brief


def schema() -> dict[str, Any]:
    """Return the JSON Schema of a brief."""
    found = json.loads(json.dumps(msgspec.json.schema(Brief)))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}


def alone(brief: Brief) -> Brief:
    """Return the brief without a grammar, with labels instead of room types."""
    rooms = [
        msgspec.structs.replace(room, type="", label=room.label or room.type or room.name)
        for room in brief.rooms
    ]
    return msgspec.structs.replace(brief, rooms=tuple(rooms))


def tolerance_of(brief: Brief, room: BriefRoom) -> float:
    """Return the tolerance of a room, or else that of the brief."""
    return brief.tolerance if room.tolerance is None else room.tolerance


def bounds(span: Span, tolerance: float) -> tuple[float, float]:
    """Return the least and the greatest value of a span."""
    if isinstance(span, tuple):
        return span
    return span * (1 - tolerance), span * (1 + tolerance)


def area_range(span: Span, tolerance: float) -> tuple[int, int]:
    """Return the range of an area, square centimetres, widened if necessary so that sizes can be sampled."""
    least, most = bounds(span, max(tolerance, LEAST_TOLERANCE))
    if most < least * (1 + 2 * LEAST_TOLERANCE):
        middle = (least + most) / 2
        least, most = middle * (1 - LEAST_TOLERANCE), middle * (1 + LEAST_TOLERANCE)
    return floor(1e4 * least + 1e-6), ceil(1e4 * most - 1e-6)


def room_area_range(span: Span, tolerance: float) -> tuple[int, int]:
    """Return the range of a room's area, square centimetres, at least the area with the least sides."""
    least, most = area_range(span, tolerance)
    return max(least, round(1e4 * LEAST_SIDE**2)), most


def length_range(span: Span, tolerance: float) -> tuple[int, int]:
    """Return the range of a length, millimetres."""
    least, most = bounds(span, tolerance)
    return floor(1e3 * least + 1e-6), ceil(1e3 * most - 1e-6)


def _require_sense(brief: Brief) -> None:
    """Raise ``RequestError`` for a brief that makes no sense."""
    if not 1 <= len(brief.rooms) <= MOST_ROOMS:
        raise RequestError(f"brief: rooms: give 1 to {MOST_ROOMS} rooms, not {len(brief.rooms)}")
    names = brief.names
    for number, room in enumerate(brief.rooms):
        where = f"brief: rooms[{number}]"
        if room.name in names[:number]:
            raise RequestError(
                f"{where}: rooms[{names.index(room.name)}] is named {room.name} too: give each its own name"
            )
        if room.name == OUTSIDE:
            raise RequestError(f"{where}: a room must not be named {OUTSIDE}")
        _require_span(f"{where} ({room.name}): area", room.area, LARGEST_ROOM)
        for side in room.size or ():
            _require_span(f"{where} ({room.name}): size", side)
        if (
            room.area is not None
            and area_range(room.area, tolerance_of(brief, room))[1] < 1e4 * LEAST_SIDE**2
        ):
            raise RequestError(
                f"{where} ({room.name}): area: {room.area} m² is less than the least, {LEAST_SIDE:g} m by "
                f"{LEAST_SIDE:g} m"
            )
    for key in ("doors", "no_doors", "next_to", "apart"):
        _require_pairs(key, getattr(brief, key), names)
    if brief.entrance is not None:
        entrance = brief.entrance if isinstance(brief.entrance, str) else brief.entrance.room
        if entrance not in names:
            raise RequestError(f"brief: entrance: {unknown('room', entrance, names)}")
    _require_span("brief: area", brief.area, LARGEST)
    _require_span("brief: outline.width", brief.outline.width)
    _require_span("brief: outline.depth", brief.outline.depth)
    for number, void in enumerate(brief.outline.voids):
        where = f"brief: outline.voids[{number}]"
        for name, span in (("width", void.width), ("depth", void.depth)):
            _require_span(f"{where}: {name}", span)
            if span is not None and bounds(span, 0)[1] < LEAST_VOID:
                raise RequestError(f"{where}: {name}: a void must be at least {LEAST_VOID:g} m wide and deep")
        for name, span in (("x", void.x), ("y", void.y)):
            _require_span(f"{where}: {name}", span, is_place=True)
        if void.corner and (void.x is not None or void.y is not None):
            raise RequestError(f"{where}: a corner sets the place of the notch: leave out x and y, or corner")
        if brief.area is not None and None in (void.width, void.depth):
            raise RequestError("brief: area: a house with voids needs a width and a depth of each void")


def _require_pairs(key: str, pairs: Sequence[Pair], names: Sequence[str]) -> None:
    for number, pair in enumerate(pairs):
        for name in pair:
            if name not in names:
                raise RequestError(f"brief: {key}[{number}]: {unknown('room', name, names)}")
        if pair[0] == pair[1]:
            raise RequestError(f"brief: {key}[{number}]: {pair[0]} is named twice: name two rooms")


def _require_span(where: str, span: Span | None, largest: float = LONGEST, *, is_place: bool = False) -> None:
    """Raise ``RequestError`` for a range out of bounds; only a place may be 0, and areas have ``largest``."""
    if span is None:
        return
    least, most = span if isinstance(span, tuple) else (span, span)
    unit = "m" if largest == LONGEST else "m²"
    if least > most:
        words = f"the smaller number comes first: [{most:g}, {least:g}], not [{least:g}, {most:g}]"
    elif least < 0 or (least == 0 and not is_place):
        words = f"must be {'at least 0' if is_place else 'above 0'}, not {least:g} {unit}"
    elif most > largest:
        words = f"must be at most {largest:g} {unit}, not {most:g}: lengths are metres, areas square metres"
    else:
        return
    raise RequestError(f"{where}: {words}")
