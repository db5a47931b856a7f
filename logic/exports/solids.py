"""Solid boxes of a house: walls with a thickness, a height and openings, and furniture.

In a map all cells that are not free are walls.

House files have no third dimension, so this module chooses heights, and ``looks.json`` those of furniture.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import atan2
from typing import NamedTuple

import numpy as np

from vitruvius.logic.drawing.palettes import Inks, style
from vitruvius.logic.house.boxes import TOLERANCE, Box
from vitruvius.logic.house.house import House
from vitruvius.logic.house.wall_parts import wall_parts
from vitruvius.logic.house.walls import Interval, Line, crossing, near, remaining
from vitruvius.logic.looks.looks import looks_of
from vitruvius.logic.spelling import printable

WALL_HEIGHT, DOOR_HEIGHT = 2.5, 2.0
"""Heights of walls and of doors, metres."""

PARAPET_HEIGHT = 1.0
"""Metres: of parapets around outdoor rooms, and of gates in them."""

SILL, HEAD = 0.9, 2.1
"""Heights of the lower and the upper edge of windows, metres."""

FLOOR = 0.05
"""Thickness of floors, below zero, metres."""

PIECE_HEIGHT = 0.8
"""Height of a piece whose type has no height in ``looks.json``, metres."""

INKS = Inks()
"""Colours of walls, furniture and a star's main room, as in plans."""

COLOURS = {"wall": INKS.wall, "window": "#a9cfe0", "entrance": "#9a7b56"}


PARTS = {
    "wall": [("wall", 0.0, WALL_HEIGHT)],
    "door": [("floor", -FLOOR, 0.0), ("wall", DOOR_HEIGHT, WALL_HEIGHT)],
    "opening": [("floor", -FLOOR, 0.0)],
    "entrance": [("entrance", 0.0, DOOR_HEIGHT), ("wall", DOOR_HEIGHT, WALL_HEIGHT)],
    "window": [("wall", 0.0, SILL), ("window", SILL, HEAD), ("wall", HEAD, WALL_HEIGHT)],
    "parapet": [("wall", 0.0, PARAPET_HEIGHT)],
    "gate": [("entrance", 0.0, PARAPET_HEIGHT)],
}
"""Heights between which each part of a wall is solid, metres above the floor."""


class Solid(NamedTuple):
    """Box along the axes, or turned about its centre."""

    name: str
    """Name of a room, or ``R3.bed`` for a piece, followed by a number if several solids share the name."""
    kind: str
    """floor, wall, window, entrance or piece."""
    box: Box
    """(west, north, east, south), metres."""
    bottom: float
    """Metres above the floor."""
    top: float
    colour: str
    """As in CSS, ``#rrggbb``."""
    turn: float = 0.0
    """Angle in radians, counter-clockwise as seen from above."""


def solids(house: House, thickness: float = 0.1) -> list[Solid]:
    """Return the solids of a house: floors, walls around openings, panes, entrances and furniture.

    Walls without a thickness get ``thickness`` metres, half of it on each side of the wall's line. Walls with
    no indoor room beside them are parapets. Entrances, gates and windows are shut. Names are unique and
    printable, and depend only on the house.
    """
    if house.occupancy:
        walls = _cells(house, thickness)
    else:
        walls = _thick_walls(house) if house.wall_thickness else _walls(house, thickness)
    found = [*_floors(house), *walls, *_free_walls(house, thickness), *_pieces(house)]
    found = [each._replace(name=printable(each.name)) for each in found]
    several, numbers = Counter(each.name for each in found), Counter[str]()
    for index, each in enumerate(found):
        name = each.name
        while several[name] > 1 or (name != each.name and name in several):
            name = f"{each.name}_{numbers[each.name]}"
            numbers[each.name] += 1
        found[index] = each._replace(name=name)
    return found


def _floors(house: House) -> Iterator[Solid]:
    look, main = style([house]), house.main_room
    below = house.rooms[0] if house.occupancy else main
    for room in house.rooms:
        colour = INKS.paper if room is main else look.fill(house.whole(room).type).colour
        # A floor above another floor lies higher to be visible: rooms of the original, areas of a map.
        top = 0.001 if below and room is not below else 0.0
        yield Solid(f"{room.name}.floor", "floor", room.box, -FLOOR, top, colour)


def _pieces(house: House) -> Iterator[Solid]:
    looks = looks_of(house)
    for room in house.rooms:
        for piece in room.pieces:
            height = looks.heights.get(piece.type, PIECE_HEIGHT)
            yield Solid(f"{room.name}.{piece.type}", "piece", piece.box, 0.0, height, INKS.wood)


def _thick_walls(house: House) -> Iterator[Solid]:
    """Yield walls that have a thickness, with the floors of doorways."""
    for kind, box in wall_parts(house):
        for name, bottom, top in PARTS[kind]:
            yield Solid(name, name, box, bottom, top, COLOURS.get(name, INKS.paper))


def _cells(house: House, thickness: float) -> Iterator[Solid]:
    """Yield all cells of a map that are not free, and walls along its edge next to free cells."""
    west, north, east, south = house.rooms[0].box
    verticals, horizontals = house.walls
    boxes = [*house.filled]
    for at, low, high in verticals:
        if near(at, (west, east)):
            boxes.append((at - thickness * near(at, [west]), low, at + thickness * near(at, [east]), high))
    for at, low, high in horizontals:
        if near(at, (north, south)):
            boxes.append((low, at - thickness * near(at, [north]), high, at + thickness * near(at, [south])))
    for box in boxes:
        yield Solid("wall", "wall", box, 0.0, WALL_HEIGHT, INKS.wall)


def _walls(house: House, thickness: float) -> Iterator[Solid]:
    half, walls = thickness / 2, house.walls
    across = [np.array(lines) for lines in reversed(walls)]
    panes, shut = (
        np.array([each.box for each in openings]).reshape(-1, 4)
        for openings in (house.windows, [door for door in house.doors if door.is_entrance])
    )
    for axis, lines in enumerate(walls):
        for line in lines:
            at, low, high = line
            ends = _reaches(line, across[axis], half)
            windows, entrances = _on(line, axis, panes), _on(line, axis, shut)
            parapets, parts = _parapets(house, line, axis), list[tuple[str, Interval]]()
            for span in remaining((low, high), windows + entrances):
                tall = remaining(span, parapets)
                parts += [("wall", each) for each in tall]
                parts += [("parapet", each) for each in remaining(span, tall)]
            parts += [("window", span) for span in windows]
            parts += [("entrance" if remaining(span, parapets) else "gate", span) for span in entrances]
            for part, (first, last) in parts:
                start, end = ends[0] if first == low else first, ends[1] if last == high else last
                box = (at - half, start, at + half, end) if axis == 0 else (start, at - half, end, at + half)
                for kind, bottom, top in PARTS[part]:
                    yield Solid(kind, kind, box, bottom, top, COLOURS[kind])
    for door in house.doors:
        if not (door.is_entrance or door.opening or house.is_outdoor(*door.between)):  # no wall is above
            west, north, east, south = door.box
            by_x, by_y = (half, 0.0) if door.height else (0.0, half)
            box = west - by_x, north - by_y, east + by_x, south + by_y
            yield Solid("wall", "wall", box, DOOR_HEIGHT, WALL_HEIGHT, INKS.wall)


def _parapets(house: House, line: Line, axis: int) -> list[Interval]:
    """Return the spans of a wall that have no indoor room beside them."""
    if not house.outdoor:
        return []
    at, low, high = line
    indoors = (room.box for room in house.rooms if not house.is_outdoor(room.name))
    spans = [(box[1 - axis], box[3 - axis]) for box in indoors if near(at, box[axis::2])]
    return remaining((low, high), spans)


def _free_walls(house: House, thickness: float) -> Iterator[Solid]:
    for wall in house.free_walls:
        x, y, east, south, half, thick = wall.oriented
        thick = thick or thickness / 2
        box = x - half, y - thick, x + half, y + thick
        yield Solid("wall", "wall", box, 0.0, WALL_HEIGHT, INKS.wall, atan2(-south, east))


def _on(line: Line, axis: int, segments: np.ndarray) -> list[Interval]:
    """Return the spans of the segments (N, 4) that lie on a wall."""
    at, low, high = line
    places, spans = segments[:, axis::2], segments[:, 1 - axis :: 2]
    on = (abs(places - at) <= TOLERANCE).all(axis=1)
    on &= (low - TOLERANCE <= spans[:, 0]) & (spans[:, 1] <= high + TOLERANCE)
    return [(start, end) for start, end in spans[on].tolist()]


def _reaches(line: Line, others: np.ndarray, half: float) -> Interval:
    """Return the ends of a wall, extended by half its thickness where it meets a wall across it.

    Therefore corners are complete, and doorways keep their width.
    """
    at, low, high = line
    return low - half * crossing(at, low, others), high + half * crossing(at, high, others)
