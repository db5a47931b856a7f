"""Conversion of a sketch to regular form: metres, along the axes, boxes that share walls without thickness.

This module handles units, rotation, noise, walls and rooms of several corners for all formats.
"""

from cmath import exp, phase
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import pairwise
from math import atan2, degrees, radians
from statistics import median
from typing import Any, NamedTuple

import shapely
from shapely import Geometry, Polygon, affinity

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.boxes import Box
from vitruvius.logic.house.parts import LONGEST_NAME, MOST_ROOMS, OUTSIDE, Room
from vitruvius.logic.readers.length_units import metres_to
from vitruvius.logic.readers.sketch import Sketch, Space, require_plain
from vitruvius.logic.readers.types import OUTSIDE as NO_ROOM
from vitruvius.logic.readers.types import kind_of
from vitruvius.logic.shapes.corners import moved, parts_of, squared
from vitruvius.logic.shapes.lines import MAX_WALL_M, common_lines
from vitruvius.logic.shapes.room_boxes import room_boxes, room_of
from vitruvius.logic.shapes.tidy import open_borders, without_slivers, without_stubs
from vitruvius.logic.spelling import numbered

MAX_CORNERS = 1 << 13
"""Number of corners of all rooms, once their sides lie along the axes."""

ANY = "room"
"""Word of the table for a room of any type."""

MAX_TURN_DEG = 0.25
"""Greatest angle of a plan that is not turned back, degrees."""

ROOM_SIDES_M = 0.7, 30.0
"""Least and greatest median side of a plan's rooms, metres."""


class Opening(NamedTuple):
    """Box of a door or a window, metres. ``is_entrance`` is None if the file does not say."""

    box: Box
    is_entrance: bool | None = None
    is_open: bool = False


class Regular(NamedTuple):
    """Rooms side by side, their doors and windows, metres, and notes for the user."""

    rooms: list[Room]
    passages: list[Opening]
    windows: list[Opening]
    outdoors: list[Geometry]
    """Balconies and other outdoor areas that are not read as rooms."""
    joints: list[tuple[str, str]]
    """Pairs of names of adjacent parts of one room."""
    notes: list[str]
    wall: float = 0.0
    """Thickness of walls in the drawing, metres."""


def regular(sketch: Sketch, unit: str | None, snap: float, types: Collection[str] | None = None) -> Regular:
    """Return a sketch as boxes side by side, with doors and windows, as a house file holds them.

    ``unit`` is the user's and replaces the file's. Corners may be off by ``snap`` metres, and by a centimetre
    in any case. ``types`` are the grammar's types, if known. Raises ``RequestError``, with the place and a
    remedy, if no house file can hold the sketch.
    """
    noise = max(snap, sketch.noise, 0.01)
    notes = [f"{sketch.guessed}: if this is wrong, give --plan-unit"] if sketch.guessed and not unit else []
    kinds = [kind_of(space, types) for space in sketch.spaces]
    spaces = [each for each, (kind, _) in zip(sketch.spaces, kinds, strict=True) if kind != NO_ROOM]
    others = [each for each, (kind, _) in zip(sketch.spaces, kinds, strict=True) if kind == NO_ROOM]
    if not spaces or len(spaces) > MOST_ROOMS:
        raise RequestError(
            f"plan: {sketch.format} has {numbered(len(spaces), 'room')}: give 1 to {MOST_ROOMS:,}"
        )
    unknown = sorted(
        {space.words[0] for space, (_, known) in zip(sketch.spaces, kinds, strict=True) if not known}
    )
    if unknown:
        notes.append(f"words of no known type, so these rooms may have any type: {', '.join(unknown[:8])}")
    require_plain([*(each.shape for each in sketch.spaces), *(each.shape for each in sketch.passages)])
    metres = metres_to(unit) if unit else sketch.unit
    _require_sizes([each.shape for each in spaces], metres, sketch.format, unit)
    turn = _turn([affinity.scale(each.shape, metres, metres, origin=(0, 0)) for each in spaces])
    if abs(turn) > MAX_TURN_DEG:
        notes.append(f"rotated by {turn:.1f} degrees, so that walls run along the axes")
    upright = _upright(spaces, metres, turn if abs(turn) > MAX_TURN_DEG else 0.0, sketch.north_up)
    inner, others = _surrounded(spaces, others, upright)
    if inner:
        notes.append(
            f"between rooms, so they may have any type: {', '.join(each.name for each in inner[:8])}"
        )
    if others:
        notes.append(passed_over(others))
    spaces += [Space(each.name, (ANY,), each.shape) for each in inner]
    solid = [(space, part) for space in spaces for part in without_slivers(upright(space.shape))]
    names = list(unlike(space.name or space.words[0] or "room" for space, _ in solid))
    shapes = [squared(name, shape, noise) for name, (_, shape) in zip(names, solid, strict=True)]
    shapes = without_stubs(names, shapes, noise, notes)
    if (corners := sum(len(each.exterior.coords) for each in shapes)) > MAX_CORNERS:
        raise RequestError(f"plan: its rooms have {corners:,} corners: at most {MAX_CORNERS:,} are read")
    lines, wall = common_lines(shapes, noise)
    on_lines = [moved(*each) for each in zip(shapes, lines, strict=True)]
    for name, shape in zip(names, on_lines, strict=True):
        if not shape.is_valid or shape.area < 0.1:
            x, y = shape.centroid.coords[0] if shape.area else shape.exterior.coords[0]
            raise RequestError(
                f"plan: {name} at x {x:.2f}, y {y:.2f} m is narrower than the walls around it: leave it "
                "out, or join it to a room beside it"
            )
    rooms, joints = room_boxes(
        [
            (name, kind_of(space, types)[0], shape)
            for name, (space, _), shape in zip(names, solid, on_lines, strict=True)
        ],
        notes,
    )
    west, north = (min(room.box[k] for room in rooms) for k in (0, 1))
    shift = (-west, -north)
    rooms = [
        room_of(affinity.translate(shapely.box(*each.box), *shift), each.name, each.type, each.part_of)
        for each in rooms
    ]

    def placed(shape: Geometry) -> Geometry:
        return affinity.translate(upright(shape), *shift)

    borders = [shapely.box(*each) for each in open_borders(shapes)] if sketch.has_walls else []
    return Regular(
        rooms,
        [
            *(Opening(bounds_of(placed(each.shape)), *each[1:]) for each in sketch.passages),
            *(Opening(bounds_of(affinity.translate(each, *shift)), is_open=True) for each in borders),
        ],
        [Opening(bounds_of(placed(each))) for each in sketch.windows],
        [placed(each.shape) for each in others],
        joints,
        notes,
        wall,
    )


def passed_over(others: Iterable[Space]) -> str:
    """Return the note on areas that are no rooms."""
    return f"ignored, because they are not rooms: {', '.join(sorted({each.name for each in others})[:8])}"


def bounds_of(shape: Geometry) -> Box:
    """Return the box around a shape, in Python's numbers."""
    west, north, east, south = shapely.bounds(shape)
    return float(west), float(north), float(east), float(south)


def unlike(names: Iterable[str]) -> Iterator[str]:
    """Yield distinct names: repeated names get numbers, as in ``Bedroom 2``, and none is ``outside``."""
    names = [_words(name) for name in names]
    taken, seen = set(names), {OUTSIDE}
    for name in names:
        own, number = name, 1
        while own in seen or (own != name and own in taken):
            number += 1
            own = f"{name[: LONGEST_NAME - 5]} {number}"
        seen.add(own)
        yield own


def _words(name: str) -> str:
    words = "".join(each if each.isprintable() else " " for each in name)
    return " ".join(words.split())[:LONGEST_NAME] or "room"


def _surrounded(
    spaces: Sequence[Space], others: Sequence[Space], upright: Callable[[Any], Any]
) -> tuple[list[Space], list[Space]]:
    """Divide ``others``, such as loggias, into those that rooms enclose or that join rooms, and the rest."""
    if not others:
        return [], []
    floor = shapely.union_all([upright(space.shape) for space in spaces])
    outlines = [Polygon(part.exterior) for part in parts_of(floor.buffer(MAX_WALL_M / 2, join_style="mitre"))]
    found: tuple[list[Space], list[Space]] = [], []
    for each in others:
        shape = upright(each.shape)
        beside = [part for part in outlines if shapely.dwithin(part, shape, MAX_WALL_M / 2)]
        is_inner = len(beside) > 1 or any(part.covers(shape) for part in beside)
        found[not is_inner].append(each)
    return found


def _require_sizes(shapes: Sequence[Polygon], metres: float, format: str, unit: str | None) -> None:
    """Raise ``RequestError`` if sizes are implausible for rooms in metres; ``unit`` is the user's."""
    sides = [
        metres * side
        for west, south, east, north in (shape.bounds for shape in shapes)
        for side in (east - west, north - south)
    ]
    middle = median(sides)
    if not ROOM_SIDES_M[0] <= middle <= ROOM_SIDES_M[1]:
        off = "shorter" if middle < 1 else "longer"
        why = f"{unit} is not its unit: give another with" if unit else "these are not rooms in metres: give"
        raise RequestError(
            f"plan: half of the sides of rooms of {format} are {off} than {middle:.2g} m: {why} --plan-unit"
        )


def _turn(shapes: Sequence[Polygon]) -> float:
    """Return the angle of the walls against the axes, -45 to 45 degrees, weighted by squared lengths."""
    total = 0j
    for shape in shapes:
        for (a, b), (c, d) in pairwise(shape.exterior.coords):
            length = abs(complex(c - a, d - b))
            total += length**2 * exp(4j * atan2(d - b, c - a))
    return degrees(phase(total) / 4)


def _upright(spaces: Sequence[Space], metres: float, turn: float, north_up: bool) -> Callable[[Any], Any]:
    """Return a function that converts a shape of the file to metres along the axes, with y growing south."""
    x, y = shapely.union_all([each.shape for each in spaces]).centroid.coords[0]

    def upright(shape: Geometry) -> Geometry:
        shape = affinity.translate(shape, -x, -y)
        shape = affinity.rotate(shape, -radians(turn), origin=(0, 0), use_radians=True)
        return affinity.scale(shape, metres, -metres if north_up else metres, origin=(0, 0))

    return upright
