"""Plan from GeoJSON: rectangles side by side stay unchanged; all other rooms are made regular."""

from collections.abc import Collection, Mapping, Sequence
from itertools import combinations, pairwise
from statistics import median
from typing import Any, NamedTuple

import shapely
from msgspec import UNSET
from shapely import Geometry

from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.parts import Room
from vitruvius.logic.readers.combined import divided
from vitruvius.logic.readers.features import inner_wall
from vitruvius.logic.readers.geojson import read_geojson
from vitruvius.logic.readers.length_units import metres_to
from vitruvius.logic.readers.regular import Opening, Regular, bounds_of, passed_over, regular, unlike
from vitruvius.logic.readers.sketch import Sketch
from vitruvius.logic.readers.types import OUTSIDE, kind_of
from vitruvius.logic.shapes.lines import MAX_WALL_M, MIN_FACING_M

LEAST_WALL = 0.04
"""Least thickness of a wall, metres. Rooms nearer to each other are meant to touch."""


class Plan(NamedTuple):
    """Rooms, doors and windows of GeoJSON. Places may be off by ``noise`` metres; 0 if they are as drawn."""

    drawn: Regular
    noise: float


def from_geojson(
    record: Mapping[str, Any],
    unit: str | None = None,
    snap: float = 0.0,
    storey: str | None = None,
    types: Collection[str] | None = None,
) -> Plan:
    """Return the rooms, doors and windows of GeoJSON, with notes on the features that were ignored.

    In GeoJSON y grows north; the plan's north-west corner becomes (0, 0). If all rooms are rectangles along
    the axes, within ``snap`` metres, and no walls lie between them, they stay unchanged; otherwise
    ``regular`` converts the plan. Arguments and errors are those of ``read_geojson`` and ``regular``.
    """
    sketch, notes = read_geojson(record, unit, storey, types)
    sketch, more = divided(sketch)
    notes += more
    if thick := record.get("wall_thickness"):  # our own export: rooms end at the faces of their walls
        half = inner_wall(thick) * metres_to(unit or "m") / 2
        found = _tiles(sketch, snap, types, half)
    else:
        found = _tiles(sketch, snap, types)
    made = found or regular(sketch, None, snap, types)
    noise = 0.0 if found else max(snap, sketch.noise, 0.01)
    return Plan(made._replace(notes=[*notes, *made.notes]), noise)


def _tiles(
    sketch: Sketch, snap: float, types: Collection[str] | None, half: float | None = None
) -> Regular | None:
    """Return the plan if all rooms are rectangles, each grown by ``half`` a wall; otherwise None.

    Without ``half``, also return None if walls lie between the rooms.
    """
    spaces, kinds = sketch.spaces, [kind_of(each, types)[0] for each in sketch.spaces]
    is_room = [kind != OUTSIDE for kind in kinds]
    boxes = [each.shape.bounds for each in spaces]
    if not any(is_room) or not all(
        _is_rectangle(each.shape, box, max(snap, TOLERANCE))
        for each, box, inside in zip(spaces, boxes, is_room, strict=True)
        if inside
    ):
        return None
    inner = [box for box, inside in zip(boxes, is_room, strict=True) if inside]
    if half is None and _has_walls(inner):
        return None
    left, top = min(box[0] for box in inner), max(box[3] for box in inner)
    names = list(unlike(each.name for each in spaces))
    wholes = {name for name, each in zip(names, spaces, strict=True) if not each.whole}
    rooms, outdoors, notes = list[Room](), list[Geometry](), list[str]()

    def placed(shape: Geometry) -> Geometry:
        return shapely.transform(shape, lambda points: (points - (left, top)) * (1, -1))

    for name, each, kind, (west, south, east, north) in zip(names, spaces, kinds, boxes, strict=True):
        if kind == OUTSIDE:
            outdoors.append(placed(each.shape))
            continue
        # Edges are rounded, not sizes, so that shared edges stay shared.
        x, right, y, bottom = (round(m, 6) for m in (west - left, east - left, top - north, top - south))
        size = round(right - x, 6), round(bottom - y, 6)
        part_of = each.whole if each.whole in wholes else UNSET
        rooms.append(Room(x, y, *size, name=name, type=kind, part_of=part_of).grown(half or 0.0))
    if outdoors:
        notes.append(passed_over(each for each, inside in zip(spaces, is_room, strict=True) if not inside))
    doors = [Opening(bounds_of(placed(each.shape)), *each[1:]) for each in sketch.passages]
    windows = [Opening(bounds_of(placed(each))) for each in sketch.windows]
    return Regular(rooms, doors, windows, outdoors, [], notes)


def _has_walls(boxes: Sequence[Box]) -> bool:
    """Return True if most adjacent rooms are a wall's thickness apart."""
    gaps = [gap for one, other in combinations(boxes, 2) if (gap := _gap(one, other)) is not None]
    return bool(gaps) and median(gaps) > LEAST_WALL


def _gap(one: Box, other: Box) -> float | None:
    """Return the gap between two boxes that face each other at most a wall apart, metres; otherwise None."""
    for k in (0, 1):
        off = max(one[k], other[k]) - min(one[k + 2], other[k + 2])
        along = min(one[3 - k], other[3 - k]) - max(one[1 - k], other[1 - k])
        if abs(off) <= MAX_WALL_M and along > MIN_FACING_M:
            return off
    return None


def _is_rectangle(shape: shapely.Polygon, box: Box, near: float) -> bool:
    """Return True if the shape is its box, within ``near`` metres; its sides may have additional corners."""
    west, south, east, north = box
    ring = [(x - west, y - south) for x, y in shape.exterior.coords]
    steps = list(pairwise(ring))
    along = all(min(abs(a - b), abs(c - d)) <= near for (a, c), (b, d) in steps)
    length = sum(max(abs(a - b), abs(c - d)) for (a, c), (b, d) in steps)
    width, height = east - west, north - south
    at_edge = all(min(x, width - x) <= near or min(y, height - y) <= near for x, y in ring)
    fills = abs(shape.area - width * height) <= near * (width + height)
    return along and at_edge and fills and abs(length - 2 * (width + height)) <= 8 * near
