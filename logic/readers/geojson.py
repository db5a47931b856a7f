"""Reader of plans in GeoJSON (RFC 7946), in metres, another unit, or degrees.

``read_geojson`` classifies each feature by its properties (``_feature``), keeps one storey (``_of_storey``),
reads names and types of rooms (``_name``, ``_words``) and geometries (``_polygons``, ``_geometry``), and
converts coordinates to metres (``_flat``). A polygon is a room unless a property says otherwise. A new
property goes into one of the tables below; a new word for a type or a door goes into ``types.json``.
"""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from statistics import median
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely import Geometry, LineString, Point, STRtree
from shapely.geometry import shape

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.parts import LONGEST_NAME
from vitruvius.logic.opener import reason
from vitruvius.logic.readers.features import GEOMETRIES, features
from vitruvius.logic.readers.length_units import degrees_of, is_web_mercator, metres_to, plane
from vitruvius.logic.readers.sketch import (
    MAX_COORDINATE,
    Passage,
    Sketch,
    Space,
    chosen,
    polygons,
    require_few,
    require_plain,
)
from vitruvius.logic.readers.types import element, meant
from vitruvius.logic.spelling import numbered, printable

FORMAT = "GeoJSON"

NAMES = ("name", "Name", "NAME", "label", "id")
"""Properties that may name a room; the first that is present counts."""

WORDS = (
    "type",
    "room",
    "room_type",
    "roomType",
    "category",
    "class",
    "subtype",
    "usage",
    "use",
    "function",
    "indoor",
)
"""Properties that may state the type of a room, or that a feature is a door."""

KINDS = ("kind", "element", "feature_type", "layer", "Layer", *WORDS, *NAMES[:4])
"""Properties that may state that a feature is a door, a window or another part of a house."""

FLAGS = ("entrance", "door", "window")
"""Properties that mark a point or a line as a door or a window, as in ``door=yes``."""

ROOM_KINDS, OTHER_KINDS = ("room", "area"), ("piece", "wall")
"""Values of ``kind`` in our own exports: for rooms, and for parts that are not rooms, doors or windows."""

LEVELS = ("storey", "level", "level_id", "floor", "story")
"""Properties that may state the storey of a feature."""

METRES_TO_DEGREE = 1e5
"""Approximate number of metres per degree."""

ATOM = re.compile(r"[a-z]\w*", re.ASCII)
"""Name of a type as a grammar writes it."""

DOOR = 0.8
"""Width of a door that is drawn as a point, metres."""

MAX_ROOM_SIDE_M, MIN_ROOM_SIDE_M = 50.0, 0.01
"""Greatest and least median side of rooms, metres; beyond them the coordinates have another unit."""


class Feature(NamedTuple):
    """A feature of the file: its number, and ``what`` it is (``room``, ``door``, ``window`` ...)."""

    number: int
    what: str
    properties: Mapping[str, Any]
    geometry: Mapping[str, Any]
    id: Any


def read_geojson(
    record: Mapping[str, Any], unit: str | None, storey: str | None, types: Collection[str] | None
) -> tuple[Sketch, list[str]]:
    """Return the rooms, doors and windows of GeoJSON, in metres, and notes for the user.

    ``unit`` is a unit of ``metres_to``. Without a unit, coordinates are metres, or degrees if the rooms would
    be too small in metres. ``types`` are the grammar's types, if known. Raises ``RequestError``, which names
    the room, if this is not a plan.
    """
    passed = Counter[str]()
    read = (_feature(each, number, passed) for number, each in enumerate(features(record)))
    found = _of_storey([each for each in read if each], storey)
    rooms = [each for each in found if each.what == "room"]
    others = [each for each in found if each.what != "room"]
    require_few(len(rooms), len(others))
    if not rooms:
        beside = f", but {_counted(passed)}" if passed else ""
        raise RequestError(f"plan: it has no polygon of a room{beside}")
    drawn, unknown = list[tuple[Feature, Space]](), set[str]()
    for each in rooms:
        name = _name(each)
        literal, words = _words(each, name, types, unknown)
        whole = str(each.properties.get("part_of") or "")
        drawn += [(each, Space(name, words, part, literal, whole)) for part in _polygons(each, name)]
    shapes = [_geometry(each) for each in others]
    require_plain([*(each.shape for _, each in drawn), *shapes])
    spaces = [part for each in drawn for part in _valid(*each)]
    require_few(len(spaces), len(shapes))
    if unit is None and is_web_mercator(record):
        spaces = [each._replace(shape=degrees_of(each.shape)) for each in spaces]
        shapes = list(map(degrees_of, shapes))
    flat, notes, noise = _flat([each.shape for each in spaces], unit)
    spaces = [each._replace(shape=flat(each.shape)) for each in spaces]
    sides = _sides(spaces)
    openings = [(each.what, _in_wall(flat(some), sides)) for each, some in zip(others, shapes, strict=True)]
    doors = [
        Passage(some, what == "entrance" or None, what == "opening")
        for what, some in openings
        if what != "window"
    ]
    windows = [some for what, some in openings if what == "window"]
    if passed:
        notes.append(f"ignored beside the rooms: {_counted(passed)}")
    if unknown:
        some = ", ".join(sorted(unknown)[:8])
        notes.append(f"words of no known type, so these rooms may have any type: {some}")
    return Sketch(FORMAT, spaces, doors, windows, north_up=True, noise=noise), notes


def _feature(feature: Any, number: int, passed: Counter[str]) -> Feature | None:
    """Return the feature with its classification; None if it is not a room, a door or a window.

    Ignored features are counted in ``passed``, except furniture and free walls of our own exports.
    """
    where = f"plan: features[{number}]"
    if not isinstance(feature, Mapping):
        raise RequestError(f"{where}: must be a feature, not {type(feature).__name__}")
    properties, geometry = feature.get("properties") or {}, feature.get("geometry")
    if not isinstance(properties, Mapping):
        raise RequestError(f"{where}: its properties must be an object, not {type(properties).__name__}")
    kind = geometry.get("type") if isinstance(geometry, Mapping) else None
    what = _what(properties, kind in GEOMETRIES)
    if properties.get("kind") in OTHER_KINDS:
        return None
    if not isinstance(geometry, Mapping) or what == "part" or (not what and kind not in GEOMETRIES):
        passed[printable(str(kind))[:40] if kind else "feature without geometry"] += 1
        return None
    return Feature(number, what or "room", properties, geometry, feature.get("id"))


def _what(properties: Mapping[str, Any], is_area: bool) -> str:
    """Return the classification that a feature's properties state, such as ``door``; empty for a room."""
    if properties.get("kind") in ROOM_KINDS:
        return ""
    said = (properties.get(key) for key in KINDS)
    found = next((what for word in said if isinstance(word, str) and (what := element(word))), "")
    if not found and not is_area:
        found = next((key for key in FLAGS if properties.get(key) not in (None, "", "no", False)), "")
    if found == "door" and properties.get("opening") is True:
        return "opening"
    return found


def _of_storey(found: Sequence[Feature], storey: str | None) -> list[Feature]:
    """Return the features of one storey. Features without a storey belong to every storey."""
    levels = [
        next((str(each.properties[key]) for key in LEVELS if key in each.properties), "") for each in found
    ]
    of_rooms = dict.fromkeys(
        level for each, level in zip(found, levels, strict=True) if level and each.what == "room"
    )
    if len(of_rooms) < 2 and storey is None:
        return list(found)
    if not of_rooms:
        raise RequestError("plan: no room says its storey, as in level: leave --storey out")
    one = list(of_rooms)[chosen(list(of_rooms), storey)]
    return [each for each, level in zip(found, levels, strict=True) if level in (one, "")]


def _words(
    room: Feature, name: str, types: Collection[str] | None, unknown: set[str]
) -> tuple[str, tuple[str, ...]]:
    """Return the room's type if the file states one of the grammar's, and the words for its type, best first.

    A word that is neither a type of the grammar nor known to mean one is added to ``unknown``.
    """
    own = room.properties.get("type")
    if own is not None and not isinstance(own, str):
        raise RequestError(
            f"plan: features[{room.number}]: the type of room {name} is a word, not {own!r}"[:200]
        )
    if own == "" and room.properties.get("kind") == "room":
        return "", ()  # our own export: any type
    if own and (own in types if types is not None else ATOM.fullmatch(own) and meant([own]) != ("", True)):
        return own, ()
    said = [word for key in WORDS if isinstance(word := room.properties.get(key), str) and word.strip()]
    words = (*said, *([name] if meant([name])[1] else []))
    kind, is_known = meant(words)
    if own and not is_known and ATOM.fullmatch(own):
        return own, ()  # The maker raises the error that the grammar has no such type.
    if said and not (is_known and kind == meant(words, types)[0]):
        unknown.add(said[0][:40])
    return "", words if is_known else ()


def _name(room: Feature) -> str:
    """Return the name of a room: any words or a number of the file, else a name such as ``R3``."""
    said = [room.properties[key] for key in NAMES if room.properties.get(key) not in (None, "")]
    said += [room.id] if room.id not in (None, "") else []
    for value in said:
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            continue
        text = f"{value:g}" if isinstance(value, float) else str(value)
        words = " ".join("".join(each if each.isprintable() else " " for each in text).split())
        if words:
            return words[:LONGEST_NAME]
    return f"R{room.number}"


def _polygons(room: Feature, name: str) -> Iterator[shapely.Polygon]:
    """Yield the polygons of a room. Raises ``RequestError`` for invalid corners."""
    where = f"plan: features[{room.number}]: room {name}"
    rings = room.geometry.get("coordinates")
    parts: Any = rings if room.geometry.get("type") == "MultiPolygon" else [rings]
    if (
        not isinstance(parts, Sequence)
        or not parts
        or not all(isinstance(part, Sequence) and part for part in parts)
    ):
        raise RequestError(f"{where} has no corners")
    for part in parts:
        shell, *holes = ([*_corners(ring, where)] for ring in part)
        if len({*shell}) < 4:
            raise RequestError(f"{where} has {len({*shell})} corners: a rectangle has four")
        try:
            found = shapely.Polygon(shell, holes)
        except (shapely.errors.ShapelyError, ValueError) as error:
            raise RequestError(f"{where}: {reason(error)[:80]}") from None
        yield found


def _valid(room: Feature, space: Space) -> list[Space]:
    """Return the parts of a room, made valid. Raises ``RequestError`` for a room without area."""
    if parts := list(polygons(space.shape)):
        return [space._replace(shape=part) for part in parts]
    raise RequestError(
        f"plan: features[{room.number}]: room {space.name} has no area: draw it again, or leave it out"
    )


def _corners(ring: Any, where: str) -> Iterator[tuple[float, float]]:
    for point in ring if isinstance(ring, Sequence) else ():
        numbers = point[:2] if isinstance(point, Sequence) and not isinstance(point, str) else ()
        if len(numbers) < 2 or not all(
            type(each) in (int, float) and abs(each) <= MAX_COORDINATE for each in numbers
        ):
            raise RequestError(
                f"{where}: a corner is two numbers, x and y, of {MAX_COORDINATE:.0e} at most, "
                f"not {str(point)[:40]!r}"
            )
        yield float(numbers[0]), float(numbers[1])


def _geometry(opening: Feature) -> Geometry:
    """Return the geometry of a door or a window. Raises ``RequestError`` if it is invalid."""
    try:
        found = shapely.force_2d(shape(dict(opening.geometry)))
        if found.is_empty or not (abs(shapely.get_coordinates(found)) < MAX_COORDINATE).all():
            raise ValueError
        return found
    except (shapely.errors.ShapelyError, ValueError, TypeError, KeyError, IndexError, AttributeError):
        raise RequestError(f"plan: features[{opening.number}]: its geometry is invalid") from None


def _flat(shapes: Sequence[shapely.Polygon], unit: str | None) -> tuple[Any, list[str], float]:
    """Return a function that converts a geometry to metres, notes, and the rounding of corners, metres.

    Raises ``RequestError`` if rooms have implausible sizes in metres; the message proposes a unit.
    """
    factor = metres_to(unit or "m")
    bounds = [each.bounds for each in shapes]
    middle = factor * median(
        side for west, south, east, north in bounds for side in (east - west, north - south)
    )
    on_earth = all(abs(edge) <= (180, 90)[k % 2] for box in bounds for k, edge in enumerate(box))
    if middle < MIN_ROOM_SIDE_M and on_earth and unit is None:
        project = plane(shapes)
        lon, lat = shapely.union_all(shapes).centroid.coords[0]
        said = f"degrees of longitude and latitude, made metres around {lon:.5f}, {lat:.5f}"
        return (lambda some: shapely.transform(some, project)), [said], _rounding(shapes)
    if middle < MIN_ROOM_SIDE_M:
        size = f"half of the rooms' sides are shorter than {middle:.2g} {unit or 'm'}"
        raise RequestError(f"plan: {size}: these are not rooms in metres: give --plan-unit")
    if middle > MAX_ROOM_SIDE_M:
        size = f"half of the rooms' sides are longer than {middle / factor:,.0f}"
        guess = {"mm": middle > 700, "cm": middle > 100}
        found = next((name for name, is_so in guess.items() if is_so and factor == 1), None)
        words = {"mm": "millimetres", "cm": "centimetres, or pixels"}
        like = f"these look like {words[found] if found else 'pixels'}"
        metres = f" {found}, or" if found else ""
        raise RequestError(
            f"plan: {like} ({size}): say --plan-unit{metres} the metres per unit, as in --plan-unit 0.02"
        )
    if factor == 1:
        return (lambda some: some), [], 0.0
    return (lambda some: shapely.transform(some, lambda points: points * factor)), [], 0.0


def _rounding(shapes: Sequence[shapely.Polygon]) -> float:
    """Return the metres of the last decimal of degrees; with six decimals, as many programs write, 0.1 m."""
    corners = shapely.get_coordinates(shapes)
    decimals = next(
        (d for d in range(6, 9) if np.allclose(corners, np.round(corners, d), rtol=0, atol=1e-11)), 9
    )
    return round(METRES_TO_DEGREE * 10.0**-decimals, 2)


def _sides(spaces: Sequence[Space]) -> STRtree:
    """Return the sides of all rooms, in their order."""
    rings = [shapely.get_coordinates(each.shape.exterior) for each in spaces]
    ends = np.concatenate([np.stack([ring[:-1], ring[1:]], 1) for ring in rings])
    sides: Any = shapely.linestrings(ends)
    return STRtree(sides[shapely.length(sides) > 0])


def _in_wall(opening: Geometry, sides: STRtree) -> Geometry:
    """Return the geometry of an opening; a point becomes a line along the nearest wall of a room."""
    if not isinstance(opening, Point):
        return opening
    side: Any = sides.geometries[sides.query_nearest(opening).min()]
    start = max(0.0, min(side.project(opening) - DOOR / 2, side.length - DOOR))
    return LineString([side.interpolate(start), side.interpolate(start + DOOR)])


def _counted(passed: Counter[str]) -> str:
    return ", ".join(numbered(number, kind) for kind, number in sorted(passed.items()))
