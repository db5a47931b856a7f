"""Houses as rows of a table: flat columns for selection, and the house itself, nested, in float64.

A row's ``sha256`` is the hash of its house's canonical JSON: the record ``vitruvius-2`` without its
provenance, with sorted keys, no white space, numbers as Python writes them, in UTF-8. A house that reached a
limit is a row without a house, whose ``verdict`` is ``limit``.
"""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

import msgspec

from vitruvius.logic.dataset.splits import split_of
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece, Provenance
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.opener import from_json

HOUSE, LIMIT = "house", "limit"
"""Values of the column ``verdict``."""

SIDES = "x", "y", "width", "height"

Row = dict[str, Any]
"""Row, by column."""


class Columns(msgspec.Struct, frozen=True):
    """Columns of a row from which its house is read or generated again."""

    id: str
    seed: Annotated[int, msgspec.Meta(ge=0, lt=2**31)]
    index: Annotated[int, msgspec.Meta(ge=0, lt=2**31)]
    grammar: str
    grammar_hash: str
    request: str
    verdict: Literal["house", "limit"]
    sha256: str | None
    house: dict[str, Any] | None = None

    def __post_init__(self) -> None:
        """Raise ``ValueError`` if the verdict contradicts the rest of the row."""
        if (self.verdict == HOUSE) != (self.house is not None):
            raise ValueError(f"its verdict is {self.verdict}, but it has {'a' if self.house else 'no'} house")

    @property
    def asked(self) -> dict[str, Any]:
        """Request of the house. Raises ``ValueError`` if the column is no JSON."""
        return from_json(self.request.encode(), dict[str, Any])


def columns_of(row: Row) -> Columns:
    """Return the columns of a row. Raises ``ValueError`` if it is no row of a set."""
    return msgspec.convert(row, Columns)


def canonical(value: Any) -> str:
    """Return JSON that is the same for equal values."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def house_sha256(house: House) -> str:
    """Return the hash that identifies a house in any file format, with any provenance."""
    record = house.converted().to_dict()
    record.pop("provenance", None)
    return hashlib.sha256(canonical(record).encode()).hexdigest()


def source(grammar: str, grammar_hash: str, request: Mapping[str, Any], seed: int, index: int) -> Row:
    """Return the columns that determine a row's house."""
    asked = canonical(request)
    series = hashlib.sha256(f"{grammar_hash}\n{asked}".encode()).hexdigest()[:12]
    return {
        "id": f"{grammar}-{series}-{seed}-{index}",
        "split": split_of(seed),
        "seed": seed,
        "index": index,
        "grammar": grammar,
        "grammar_hash": grammar_hash,
        "request": asked,
    }


def house_row(house: House) -> Row:
    """Return the row of a house with provenance."""
    made = house.provenance
    assert made is not None, "a generated house needs provenance"
    said = source(made.grammar, made.grammar_hash, made.request, made.seed, made.index)
    return said | {
        "rooms": len(house.counted),
        "types": [room.type for room in house.counted],
        "area": math.fsum(room.area for room in house.rooms if room.type not in house.outdoor),
        "verdict": HOUSE,
        "why": None,
        "sha256": house_sha256(house),
        "house": _nested(house),
    }


def limit_row(said: Row, why: str) -> Row:
    """Return the row of a house that reached a limit, with the columns that determine it and the reason."""
    none = {"types": None, "area": None, "verdict": LIMIT, "why": why, "sha256": None, "house": None}
    return said | {"rooms": json.loads(said["request"])["rooms"], **none}


def house_of(row: Row, versions: dict[str, str], promises: Promises | None) -> House | None:
    """Return the house of a row, with its set's versions and promises, or None if the row is a limit.

    Raises ``ValueError`` if it is no row of a set.
    """
    columns = columns_of(row)
    if columns.house is None:
        return None
    named = columns.grammar, columns.grammar_hash
    made = Provenance(*named, columns.asked, columns.seed, columns.index, versions, promises)
    try:
        return House.from_dict(_record(columns.house, made))
    except (AttributeError, KeyError, TypeError, OverflowError, RecursionError) as error:
        raise ValueError(f"its house is wrong: {type(error).__name__}: {error}") from None


def _nested(house: House) -> Row:
    """Return the column ``house``: rooms, doors and windows, and the pieces of all rooms."""
    west, north, east, south = zip(*(room.box for room in house.rooms), strict=True)
    x, y = min(west), min(north)
    return {
        "topology": house.topology,
        "hub": house.hub,
        "wall_thickness": msgspec.to_builtins(house.wall_thickness),
        "floor": {"x": x, "y": y, "width": max(east) - x, "height": max(south) - y},
        "rooms": [
            {"name": room.name, "type": room.type, **_sides(room), "part_of": room.part_of or None}
            for room in house.rooms
        ],
        "doors": [
            {"between": list(door.between), "opening": door.opening, **_sides(door)} for door in house.doors
        ],
        "windows": [{"room": window.room, **_sides(window)} for window in house.windows],
        "pieces": list(_pieces(house)),
    }


def _pieces(house: House) -> Iterator[Row]:
    """Yield all pieces, each before its children, which refer to it by its index in the list."""
    number = 0

    def family(piece: Piece, room: str, parent: int | None) -> Iterator[Row]:
        nonlocal number
        place, number = number, number + 1
        named = {"room": room, "parent": parent, "type": piece.type, "orientation": piece.orientation}
        yield {**named, **_sides(piece)}
        for child in piece.children:
            yield from family(child, room, place)

    for room in house.rooms:
        for piece in room.children:
            yield from family(piece, room.name, None)


def _record(nested: Row, made: Provenance) -> Row:
    """Return the record ``vitruvius-2`` of the column ``house``."""
    children: dict[str | int, list[Row]] = {room["name"]: [] for room in nested["rooms"]}
    for place, piece in enumerate(nested["pieces"]):
        named, own = {"type": piece["type"], "orientation": piece["orientation"], **_in(piece)}, list[Row]()
        above = piece["room"] if piece["parent"] is None else piece["parent"]
        children[above].append(named | {"children": own})
        children[place] = own
    rooms = [
        {"name": room["name"], "type": room["type"], **_in(room), "children": children[room["name"]]}
        | ({"part_of": room["part_of"]} if room["part_of"] else {})
        for room in nested["rooms"]
    ]
    return {
        "format": "vitruvius-2",
        "unit": "m",
        "topology": nested["topology"],
        "hub": nested["hub"] or None,
        "wall_thickness": nested["wall_thickness"],
        "rooms": rooms,
        "doors": [
            {**_in(door), **{key: door[key] for key in ("between", "opening")}} for door in nested["doors"]
        ],
        "windows": [{**_in(window), "room": window["room"]} for window in nested["windows"]],
        "provenance": msgspec.to_builtins(made),
    }


def _sides(rect: Any) -> Row:
    return {side: float(getattr(rect, side)) for side in SIDES}


def _in(record: Row) -> Row:
    return {side: record[side] for side in SIDES}
