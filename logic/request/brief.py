"""A brief: what a user wants of the rooms of a house, each by its name.

Its form is JSON (``docs/briefs.md``). What cannot be meant is refused here; what cannot be met is found
later, as a proof that names lines of the brief (``logic.generation.brief``).
"""

import json
from collections.abc import Mapping, Sequence
from math import ceil, floor
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from logic.errors import RequestError
from logic.house.parts import OUTSIDE, Name
from logic.mismatch import mismatch
from logic.opener import content_of, from_json
from logic.spelling import unknown

MOST_BYTES = 1 << 20
"""Size of a file, unpacked."""

MOST_ROOMS = 24
"""Of a brief: the rules grow with the cube of the number of its rooms."""

TOLERANCE, LEAST_TOLERANCE = 0.1, 0.001
"""Of an area or a size that is one number: so much more or less, as a share of it."""

LEAST_SIDE = 0.5
"""Metres: no side of a room with an area is shorter; ``rules/brief/brief.pl``."""

LEAST_VOID = 1.0
"""Metres: no side of a void is shorter; ``rules/brief/brief.pl``."""

LARGEST_ROOM = 5_000.0
"""Square metres: of a room, whose area is known in steps of its width."""

LENGTHS = {"area", "size", "width", "depth"}
"""Keys of a brief's lengths and areas."""

LONGEST, LARGEST = 400.0, 100_000.0
"""Metres and square metres: what whole numbers of stage 1 can hold."""

Side = Literal["north", "east", "south", "west"]
Span = float | tuple[float, float]
"""One number, or the least and the greatest: metres, or square metres."""

Tolerance = Annotated[float, Meta(ge=0, le=0.5)]
"""A share: so much more or less."""

Pair = tuple[Name, Name]


class Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """A part of a brief's JSON."""

    comment: str = ""
    """A note for people, which the reader ignores."""


class BriefRoom(Part, frozen=True):
    """A room that is wanted. All but its name may be left out."""

    name: Name
    type: str = ""
    """One of the grammar's."""
    label: str = ""
    """What it is called in the place of a type, by a grammar that has none."""
    area: Span | None = None
    """Square metres; one number is met within the ``tolerance``."""
    size: tuple[Span, Span] | None = None
    """Its two sides, either way round, metres."""
    tolerance: Tolerance | None = None
    outside: bool | tuple[Side, ...] = False
    """Whether it has an outer wall, or which of its sides are outer walls."""
    windows: tuple[Side, ...] = ()
    """Sides in which it has a window."""


class Entrance(Part, frozen=True):
    """By which room, and which of its sides, the house is entered."""

    room: Name
    side: Side | None = None


class Void(Part, frozen=True):
    """A part of the outline that is no house, metres: a notch at a corner, or a court that lies anywhere."""

    width: Span | None = None
    depth: Span | None = None
    corner: Literal["north-west", "north-east", "south-east", "south-west"] | None = None
    x: Span | None = None
    y: Span | None = None


class Outline(Part, frozen=True):
    """The rectangle around the house, metres: its width from west to east, its depth from north to south."""

    width: Span | None = None
    depth: Span | None = None
    voids: tuple[Void, ...] = ()


class Brief(Part, frozen=True):
    """What is wanted of the rooms of a house, each by its name."""

    rooms: tuple[BriefRoom, ...]
    doors: tuple[Pair, ...] = ()
    no_doors: tuple[Pair, ...] = ()
    next_to: tuple[Pair, ...] = ()
    """Rooms that share a wall, with a door in it or without."""
    apart: tuple[Pair, ...] = ()
    """Rooms that do not share a wall."""
    other_doors: bool = False
    """True permits doors that are not in ``doors``, as far as the grammar's rules do. By default there are
    only one more door into each group of rooms that ``doors`` join, and the doors that the rules require."""
    entrance: Name | Entrance | None = None
    outline: Outline = Outline()
    area: Span | None = None
    """Area within the outline without the voids, square metres."""
    tolerance: Tolerance = TOLERANCE
    schema_: str = msgspec.field(default="", name="$schema")
    """Address of the schema by which an editor checks the file; the reader ignores it."""

    @property
    def names(self) -> list[str]:
        """Of its rooms, in their order."""
        return [room.name for room in self.rooms]

    @property
    def is_alone(self) -> bool:
        """Whether it says by itself what the house is: see ``alone``."""
        return all(room.label for room in self.rooms)


def read_brief(source: str | Path | Mapping[str, Any] | Brief) -> Brief:
    """A brief, from its JSON form or a file of it. Raises ``RequestError`` for what cannot be meant."""
    if isinstance(source, str | Path):
        try:
            source = from_json(content_of(source, MOST_BYTES), Any)
        except OSError as error:
            raise RequestError(f"brief: {source} cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise RequestError(f"brief: {source} is no JSON: {error}") from None
    try:
        brief = source if isinstance(source, Brief) else msgspec.convert(source, Brief)
    except msgspec.ValidationError as error:
        raise RequestError(f"brief: {mismatch(error, source, Brief)}") from None
    _require_sense(brief)
    return brief


def schema() -> dict[str, Any]:
    """The JSON Schema of a brief."""
    found = json.loads(json.dumps(msgspec.json.schema(Brief)))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}


def alone(brief: Brief) -> Brief:
    """The brief without a grammar, whose types of rooms are labels."""
    rooms = [
        msgspec.structs.replace(room, type="", label=room.label or room.type or room.name)
        for room in brief.rooms
    ]
    return msgspec.structs.replace(brief, rooms=tuple(rooms))


def tolerance_of(brief: Brief, room: BriefRoom) -> float:
    """That of a room, or of the brief."""
    return brief.tolerance if room.tolerance is None else room.tolerance


def bounds(span: Span, tolerance: float) -> tuple[float, float]:
    """The least and the greatest that is meant."""
    if isinstance(span, tuple):
        return span
    return span * (1 - tolerance), span * (1 + tolerance)


def area_range(span: Span, tolerance: float) -> tuple[int, int]:
    """Square centimetres; of some width, however exact it is meant: sizes are sampled in it."""
    least, most = bounds(span, max(tolerance, LEAST_TOLERANCE))
    if most < least * (1 + 2 * LEAST_TOLERANCE):
        middle = (least + most) / 2
        least, most = middle * (1 - LEAST_TOLERANCE), middle * (1 + LEAST_TOLERANCE)
    return floor(1e4 * least + 1e-6), ceil(1e4 * most - 1e-6)


def room_area_range(span: Span, tolerance: float) -> tuple[int, int]:
    """Square centimetres, at least what the least sides make."""
    least, most = area_range(span, tolerance)
    return max(least, round(1e4 * LEAST_SIDE**2)), most


def length_range(span: Span, tolerance: float) -> tuple[int, int]:
    """Millimetres."""
    least, most = bounds(span, tolerance)
    return floor(1e3 * least + 1e-6), ceil(1e3 * most - 1e-6)


def _require_sense(brief: Brief) -> None:
    """Refuse what cannot be meant."""
    if not 1 <= len(brief.rooms) <= MOST_ROOMS:
        raise RequestError(f"brief: rooms: 1 to {MOST_ROOMS} rooms, not {len(brief.rooms)}")
    names = brief.names
    for number, room in enumerate(brief.rooms):
        where = f"brief: rooms[{number}]"
        if room.name in names[:number]:
            raise RequestError(
                f"{where}: rooms[{names.index(room.name)}] is named {room.name} too: give each its own name"
            )
        if room.name == OUTSIDE:
            raise RequestError(f"{where}: {OUTSIDE} is no name of a room")
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
                raise RequestError(f"{where}: {name}: a void is {LEAST_VOID:g} m wide and deep or more")
        for name, span in (("x", void.x), ("y", void.y)):
            _require_span(f"{where}: {name}", span, is_place=True)
        if void.corner and (void.x is not None or void.y is not None):
            raise RequestError(f"{where}: a notch at a corner is there: leave out x and y, or corner")
        if brief.area is not None and None in (void.width, void.depth):
            raise RequestError(
                "brief: area: a house with voids has an area where these have a width and a depth"
            )


def _require_pairs(key: str, pairs: Sequence[Pair], names: Sequence[str]) -> None:
    for number, pair in enumerate(pairs):
        for name in pair:
            if name not in names:
                raise RequestError(f"brief: {key}[{number}]: {unknown('room', name, names)}")
        if pair[0] == pair[1]:
            raise RequestError(f"brief: {key}[{number}]: {pair[0]} and itself: name two rooms")


def _require_span(where: str, span: Span | None, largest: float = LONGEST, *, is_place: bool = False) -> None:
    """Raise ``RequestError`` for a range out of bounds; only a place may be 0, and areas have ``largest``."""
    if span is None:
        return
    least, most = span if isinstance(span, tuple) else (span, span)
    unit = "m" if largest == LONGEST else "m²"
    if least > most:
        words = f"the least comes first: [{most:g}, {least:g}], not [{least:g}, {most:g}]"
    elif least < 0 or (least == 0 and not is_place):
        words = f"must be {'at least 0' if is_place else 'above 0'}, not {least:g} {unit}"
    elif most > largest:
        words = f"must be at most {largest:g} {unit}, not {most:g}: lengths are metres, areas square metres"
    else:
        return
    raise RequestError(f"{where}: {words}")
