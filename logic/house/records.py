"""Records: the JSON form of a house, read and written in each format, and the schema of ``vitruvius-2``."""

from __future__ import annotations

import json
from collections import Counter
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from vitruvius.logic.house.boxes import TOLERANCE
from vitruvius.logic.house.occupancy import OccupancyGrid
from vitruvius.logic.house.parts import (
    BODY,
    FORMAT,
    MAIN,
    MAP,
    MAX_COORDINATE_M,
    MAX_HOUSE_PIECES,
    MOST_OPENINGS,
    MOST_PIECES,
    MOST_ROOMS,
    MOST_WALLS,
    ORIGINAL,
    OUTSIDE,
    STAR,
    Door,
    FreeWall,
    Name,
    Provenance,
    Rect,
    Room,
    Window,
)
from vitruvius.logic.house.promises import Thickness
from vitruvius.logic.house.star import Star, read_star
from vitruvius.logic.house.topology_kinds import STARS, Kind, kind_of
from vitruvius.logic.spelling import unknown


class Record(msgspec.Struct, frozen=True, omit_defaults=True, forbid_unknown_fields=True):
    """House in the format ``vitruvius-2``. Lengths in metres; x grows east, y south."""

    format: Literal["vitruvius-2"]
    unit: Literal["m"]
    rooms: Annotated[tuple[Room, ...], Meta(min_length=1, max_length=MOST_ROOMS + 1)]
    doors: Annotated[tuple[Door, ...], Meta(max_length=MOST_OPENINGS)]
    windows: Annotated[tuple[Window, ...], Meta(max_length=MOST_OPENINGS)] = ()
    hub: Name | None = None
    topology: str = ""
    provenance: Provenance | None = None
    wall_thickness: Thickness | None = None
    walls: Annotated[tuple[FreeWall, ...], Meta(max_length=MOST_WALLS)] = ()
    occupancy: OccupancyGrid | None = None


def read(record: dict[str, Any]) -> tuple[Record, Any]:
    """Return the parts of a house from a record of any format, and the format's name.

    Raises ``msgspec.ValidationError`` that names the first wrong field.
    """
    if not isinstance(record, dict):
        raise msgspec.ValidationError(f"a house is a JSON object, not {type(record).__name__}")
    if "format" not in record and "roomNumber" not in record and "rooms" in record:
        record = {"format": FORMAT, "doors": [], **_known(record)}
    if record.get("format") == FORMAT:
        found, format_ = msgspec.convert(record, Record), FORMAT
        _require_names(found)
    else:
        star, format_, provenance = read_star(record)
        topology = ORIGINAL if format_ == ORIGINAL else STAR
        found = Record(FORMAT, "m", *star.parts(), (), MAIN, topology, provenance)
    _require_sizes(found, format_ != FORMAT)
    return found, format_


def _known(record: dict[str, Any]) -> dict[str, Any]:
    """Return a record without a format, to be read as the current format, if its rooms have its fields."""
    rooms = record["rooms"] if isinstance(record["rooms"], list) else []
    first = rooms[0] if rooms and isinstance(rooms[0], dict) else {}
    lacking = [key for key in ("name", "type", "x", "y", "width", "height") if key not in first]
    if lacking:
        raise msgspec.ValidationError(
            f"it names no format, and its rooms have {', '.join(map(str, [*first][:5])) or 'nothing'}, not "
            f"{', '.join(lacking)}: another program seems to have written it: give its rooms as GeoJSON"
        )
    return record


def schema() -> dict[str, Any]:
    """Return the JSON Schema of the format ``vitruvius-2``.

    The reader also requires what the schema cannot state: rooms have different names; doors and windows are
    segments, and their rooms exist; rooms and pieces have an area; a room has at most 256 pieces, a house
    8,192; the rows of a map have equally many cells, and a map has a free cell and no doors.
    """
    found = json.loads(json.dumps(msgspec.json.schema(Record)))
    found["$defs"]["House"] = found["$defs"].pop("Record") | {"title": "House"}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found, "$ref": "#/$defs/House"}


def _require_names(house: Record) -> None:
    """Raise an error for names that mean two rooms or none, and for a star that is none."""
    names = Counter(room.name for room in house.rooms)
    spaces = [*names, OUTSIDE]
    name, times = names.most_common(1)[0]
    if times > 1:
        raise msgspec.ValidationError(f"rooms: the name {name} appears twice")
    if OUTSIDE in names:
        raise msgspec.ValidationError(f"rooms: a room must not be named {OUTSIDE}: entrances lead there")
    used = [("hub", house.hub, names)] if house.hub else []
    used += [(f"doors[{i}]", name, spaces) for i, door in enumerate(house.doors) for name in door.between]
    used += [(f"{room.name}.part_of", room.part_of, names) for room in house.rooms if room.part_of]
    used += [(f"windows[{i}]", window.room, names) for i, window in enumerate(house.windows)]
    for place, name, known in used:
        if name not in names and name not in known:
            raise msgspec.ValidationError(f"{place}: {unknown('room', name, known)}")
    parts = {room.name for room in house.rooms if room.part_of}
    for room in house.rooms:
        if room.part_of == room.name or room.part_of in parts:
            raise msgspec.ValidationError(
                f"{room.name}.part_of: {room.part_of} is itself a part: name the room that contains it"
            )
    for index, door in enumerate(house.doors):
        if door.between[0] == door.between[1]:
            raise msgspec.ValidationError(f"doors[{index}]: joins {door.between[0]} with itself")
    if kind_of(house.topology) in STARS:
        try:
            Star.of(house.rooms, house.doors, house.hub or "")
        except ValueError as error:
            raise msgspec.ValidationError(f"topology {house.topology}: {error}") from None


def _require_sizes(house: Record, in_star: bool) -> None:
    """Raise an error for values that no house has, before any computation with them.

    These are sizes that are not positive, lengths that are not finite, and parts that are too many or too far
    away.
    """
    _require_map(house)
    cell = house.provenance.request.get("cell", 0.0) if house.provenance else 0.0
    if type(cell) not in (int, float) or (cell and not BODY <= cell <= MAX_COORDINATE_M):
        raise msgspec.ValidationError(f"provenance.request.cell must be a length in metres, not {cell!r}")

    def require(rect: Rect, name: str) -> None:
        if not all(abs(value) <= MAX_COORDINATE_M for value in rect.box):
            raise msgspec.ValidationError(f"{name} lies beyond {MAX_COORDINATE_M:g} m or is not a number")
        if rect.width < 0 or rect.height < 0 or (rect.area == 0 and not isinstance(rect, Door | Window)):
            raise msgspec.ValidationError(f"{name} is {rect.width} by {rect.height}: sizes must be positive")

    if thick := house.wall_thickness:
        if kind_of(house.topology) is not Kind.SHARED_WALLS:
            kind = MAP if house.topology == MAP else STAR
            raise msgspec.ValidationError(f"wall_thickness: a {kind} does not support it: leave it out")
        if not 0 < thick.inner <= thick.outer <= MAX_COORDINATE_M:
            said = f"{thick.inner} and {thick.outer}"
            why = "must be more than 0 m, and inner walls must not be thicker than outer ones"
            raise msgspec.ValidationError(f"wall_thickness: {why}, not {said}")
    for index, wall in enumerate(house.walls):
        if not all(abs(value) <= MAX_COORDINATE_M for value in (wall.x1, wall.y1, wall.x2, wall.y2)):
            text = f"walls[{index}] lies beyond {MAX_COORDINATE_M:g} m or is not a number"
            raise msgspec.ValidationError(text)
        if wall.thickness < 0 or (wall.x1, wall.y1) == (wall.x2, wall.y2):
            raise msgspec.ValidationError(f"walls[{index}] must have a length, and a thickness of at least 0")
    furniture = 0
    for room in house.rooms:
        furniture += len(room.pieces)
        if furniture > MAX_HOUSE_PIECES:
            raise msgspec.ValidationError(f"rooms: more than {MAX_HOUSE_PIECES:,} pieces together")
        require(room, "floor" if in_star and room.name == house.hub else room.name)
        if len(room.pieces) > MOST_PIECES:
            raise msgspec.ValidationError(
                f"{room.name} has {len(room.pieces)} pieces: at most {MOST_PIECES:,}"
            )
        for place, piece in enumerate(room.pieces):
            require(piece, f"{room.name}, piece {place} ({piece.type})")
    for kind, openings in (("doors", house.doors), ("windows", house.windows)):
        for index, each in enumerate(openings):
            name = f"{each.between[0]}.door" if in_star and isinstance(each, Door) else f"{kind}[{index}]"
            require(each, name)
            if (each.width > 0) == (each.height > 0):
                raise msgspec.ValidationError(f"{name} must be a segment: its width or its height is zero")


def _require_map(house: Record) -> None:
    """Raise an error for a map that cannot be read, and if the map and the topology contradict each other."""
    grid = house.occupancy
    if (grid is None) != (kind_of(house.topology) is not Kind.MAP):
        raise msgspec.ValidationError(
            f"occupancy: a house of the topology {MAP} needs it, and no other house may have it"
        )
    if grid is None:
        return
    if fault := grid.fault():
        raise msgspec.ValidationError(f"occupancy: {fault}")
    if house.doors or house.windows:
        raise msgspec.ValidationError("doors, windows: a map has none, because its cells are its walls")
    if max(abs(a - b) for a, b in zip(house.rooms[0].box, grid.box, strict=True)) > TOLERANCE:
        raise msgspec.ValidationError(
            f"{house.rooms[0].name}: the first room of a map must cover the whole map"
        )
