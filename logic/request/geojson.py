"""Rooms of a plan from GeoJSON (RFC 7946): a rectangle along the axes for each, in metres."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from statistics import median
from typing import Any, NamedTuple

from msgspec import UNSET

from logic.errors import RequestError
from logic.house.boxes import TOLERANCE, Box
from logic.house.parts import LONGEST_NAME, MOST_ROOMS, Room
from logic.readers.features import GEOMETRIES, features, inner_wall
from logic.readers.regular import unlike
from logic.readers.sketch import FAR
from logic.readers.units import metres_to
from logic.spelling import numbered, printable

OTHER_KINDS = ("door", "window", "piece", "wall")
"""What our own exports call the parts of a house that are no rooms."""

NAMES = ("name", "Name", "NAME", "label", "id")
"""Properties that name a room, the first that is there."""

LARGEST = 50.0
"""Metres: where half of the rooms are longer than this, their unit is another one."""

SMALLEST = 0.01
"""Metres: where half of the rooms are shorter than this, their unit is another one."""


class Polygon(NamedTuple):
    """A room as a feature says it: its name as people wrote it, its type, the name of the room that it is a
    part of, if any, and its corners.
    """

    name: str
    type: str
    whole: str
    points: list[tuple[float, float]]


def from_geojson(
    record: Mapping[str, Any], unit: str = "m", snap: float = 0.0
) -> tuple[list[Room], list[str]]:
    """The rooms of GeoJSON, and what is to be said of what was passed over.

    Its y grows north: the plan's north-west corner becomes (0, 0). ``unit``: see ``metres_to``. Corners may
    lie ``snap`` metres beside those of a rectangle. Raises ``RequestError`` for what is no plan, naming the
    room.
    """
    found, passed = list[Polygon](), Counter[str]()
    for number, feature in enumerate(features(record)):
        polygon = _polygon(feature, number, passed)
        if polygon:
            found.append(polygon)
    if len(found) > MOST_ROOMS:
        raise RequestError(f"plan: it has {numbered(len(found), 'room')}: at most {MOST_ROOMS:,} are read")
    if not found:
        others = f", but {_counted(passed)}" if passed else ""
        raise RequestError(f"plan: it has no polygon that is a room{others}")
    factor = metres_to(unit)
    boxes = [_box(each, factor, snap) for each in found]
    _require_metres(boxes, factor, unit)
    left, top = min(box[0] for box in boxes), max(box[3] for box in boxes)
    rooms = []
    names = list(unlike(each.name for each in found))
    wholes = {name for name, each in zip(names, found, strict=True) if not each.whole}
    for each, name, (west, south, east, north) in zip(found, names, boxes, strict=True):
        # Edges are rounded, not sizes: what two rooms share stays shared.
        x, right, y, bottom = (round(m, 6) for m in (west - left, east - left, top - north, top - south))
        size = round(right - x, 6), round(bottom - y, 6)
        whole = each.whole if each.whole in wholes else UNSET
        rooms.append(Room(x, y, *size, name=name, type=each.type, part_of=whole))
    if thick := record.get("wall_thickness"):  # our own export: rooms end at the faces of their walls
        inner = inner_wall(thick) * factor
        rooms = [room.grown(inner / 2) for room in rooms]
    notes = [f"passed over beside the rooms: {_counted(passed)}"] if passed else []
    return rooms, notes


def _polygon(feature: Any, number: int, passed: Counter[str]) -> Polygon | None:
    """A feature as a room. What is none is counted in ``passed``, but for what our own exports say is
    another part of a house.
    """
    where = f"plan: features[{number}]"
    if not isinstance(feature, Mapping):
        raise RequestError(f"{where}: is no feature, but {type(feature).__name__}")
    properties, geometry = feature.get("properties") or {}, feature.get("geometry")
    if not isinstance(properties, Mapping):
        raise RequestError(f"{where}: its properties are no object, but {type(properties).__name__}")
    if properties.get("kind") in OTHER_KINDS:
        return None
    kind = geometry.get("type") if isinstance(geometry, Mapping) else None
    if kind not in GEOMETRIES or not isinstance(geometry, Mapping):
        passed[printable(str(kind))[:40] if kind else "feature without geometry"] += 1
        return None
    name = _name(properties, feature, number)
    type_ = properties.get("type")
    if type_ is not None and not isinstance(type_, str):
        raise RequestError(f"{where}: the type of room {name} is a word of the grammar, not {type_!r}")
    rings = geometry.get("coordinates")
    if kind == "MultiPolygon" and isinstance(rings, Sequence):
        if len(rings) != 1:
            raise RequestError(f"{where}: room {name} has {len(rings)} parts: make each of them a room")
        [rings] = rings
    whole = properties.get("part_of")
    return Polygon(
        name, type_ or "", whole if isinstance(whole, str) else "", _ring(rings, f"{where}: room {name}")
    )


def _name(properties: Mapping[str, Any], feature: Mapping[str, Any], number: int) -> str:
    """What a room is called: any words, or a number; ``R3`` where nothing is said."""
    said = [properties[key] for key in NAMES if properties.get(key) not in (None, "")]
    said += [feature["id"]] if feature.get("id") not in (None, "") else []
    for value in said:
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            continue
        text = f"{value:g}" if isinstance(value, float) else str(value)
        words = " ".join("".join(each if each.isprintable() else " " for each in text).split())
        if words:
            return words[:LONGEST_NAME]
    return f"R{number}"


def _ring(rings: Any, where: str) -> list[tuple[float, float]]:
    """The corners of a polygon without holes."""
    if not isinstance(rings, Sequence) or not rings:
        raise RequestError(f"{where} has no corners")
    if len(rings) > 1:
        raise RequestError(f"{where} has a hole: cut it into rectangles, each a room")
    points = []
    for point in rings[0] if isinstance(rings[0], Sequence) else ():
        numbers = point[:2] if isinstance(point, Sequence) and not isinstance(point, str) else ()
        if len(numbers) < 2 or not all(type(each) in (int, float) and abs(each) <= FAR for each in numbers):
            raise RequestError(
                f"{where}: a corner is two numbers, x and y, of {FAR:.0e} at most, not {str(point)[:40]!r}"
            )
        points.append((float(numbers[0]), float(numbers[1])))
    if len(set(points)) < 4:
        raise RequestError(f"{where} has {len(set(points))} corners: a rectangle has four")
    return points


def _box(room: Polygon, factor: float, snap: float) -> Box:
    """The box of a room in metres: (west, south, east, north)."""
    points = [(x * factor, y * factor) for x, y in room.points]
    xs, ys = zip(*points, strict=True)
    box = min(xs), min(ys), max(xs), max(ys)
    if not _is_rectangle(points, box, max(snap, TOLERANCE)):
        raise RequestError(
            f"plan: room {room.name} is no rectangle along the axes: cut it into rectangles, each a room"
        )
    return box


def _is_rectangle(points: Sequence[tuple[float, float]], box: Box, near: float) -> bool:
    """Whether the points go round the box, from any corner and either way; some may lie between corners, and
    each ``near`` metres beside its place.
    """
    west, south, east, north = box
    ring = [(x - west, y - south) for x, y in (*points, points[0])]
    steps = list(pairwise(ring))
    along = all(min(abs(a - b), abs(c - d)) <= near for (a, c), (b, d) in steps)
    area, length = 0.0, 0.0
    for (a, c), (b, d) in steps:
        area += (a * d - b * c) / 2
        length += max(abs(a - b), abs(c - d))
    width, height = east - west, north - south
    at_edge = all(min(x, width - x) <= near or min(y, height - y) <= near for x, y in ring)
    fills = abs(abs(area) - width * height) <= near * (width + height)
    return along and at_edge and fills and abs(length - 2 * (width + height)) <= 8 * near


def _require_metres(boxes: Sequence[Box], factor: float, unit: str) -> None:
    """Refuse rooms whose sizes are no rooms' in metres, with the unit that they look like."""
    sides = sorted(side for west, south, east, north in boxes for side in (east - west, north - south))
    middle, ways = median(sides), "say --plan-unit"
    if middle < SMALLEST:
        on_earth = all(abs(box[k] / factor) <= (180, 90)[k % 2] for box in boxes for k in range(4))
        size = f"half of the rooms' sides are shorter than {middle:.2g} {unit}"
        if on_earth and factor == 1:
            raise RequestError(
                f"plan: these look like degrees ({size}): project them to metres first, as in a GIS: "
                "a zone of UTM, say"
            )
        raise RequestError(f"plan: {size}: these are no rooms in metres: {ways}")
    if middle > LARGEST:
        size = f"half of the rooms' sides are longer than {middle / factor:,.0f}"
        guess = {"mm": middle > 700, "cm": middle > 100}
        found = next((name for name, is_so in guess.items() if is_so and factor == 1), None)
        words = {"mm": "millimetres", "cm": "centimetres, or pixels"}
        like = f"these look like {words[found] if found else 'pixels'}"
        metres = f" {found}, or" if found else ""
        raise RequestError(
            f"plan: {like} ({size}): {ways}{metres} how many metres one is, as in --plan-unit 0.02"
        )


def _counted(passed: Counter[str]) -> str:
    return ", ".join(numbered(number, kind) for kind, number in sorted(passed.items()))
