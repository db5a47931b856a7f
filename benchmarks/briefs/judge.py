"""Checks if a house is a plan of a brief's rooms, and if it keeps the brief's lines, by geometry only."""

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

from benchmarks.briefs.boxes import (
    CLOSE,
    SIDES,
    Box,
    area,
    around,
    contact,
    cover,
    outer_parts,
    shared,
)
from vitruvius.logic.errors import HouseFileError
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Rect, Room
from vitruvius.logic.request.brief import Brief, BriefRoom, Entrance, Span

DOOR = 0.7
"""Smallest width of a door, in metres."""

WALL = 0.1
"""Smallest length of the wall that neighbouring rooms share, in metres, as in ``docs/briefs.md``."""

ROUNDED = 1e-3
"""Tolerance of an answer, in metres and as a fraction of an area."""

READ = 1e-4
"""Rounding of an area in a brief, in square metres."""


class JudgedLine(NamedTuple):
    """A line of a brief, and True if a house keeps it."""

    kind: str
    """``edge``, ``area``, or ``other``."""
    words: str
    kept: bool


# - a house -------------------------------------------------------------------


def faults(house: House, brief: Brief) -> list[str]:
    """Return the reasons why a house is no plan of the rooms of a brief, or an empty list.

    Reasons are names, overlaps, gaps, doors and windows that are in no wall, and rooms that no door leads to.
    """
    names, rooms = set(brief.names), {room.name: room for room in house.rooms}
    if rooms.keys() != names:
        return [f"the rooms are {', '.join(sorted(rooms))}, not {', '.join(sorted(names))}"]
    found = [f"{a} and {b} overlap" for a, b in combinations(rooms, 2) if cover(rooms[a].box, rooms[b].box)]
    whole, voids = around(room.box for room in house.rooms), void_boxes(house, brief)
    found += [
        f"{name} lies in a void" for name in rooms if any(cover(rooms[name].box, each) for each in voids)
    ]
    free = area(whole) - sum(area(room.box) for room in house.rooms) - sum(map(area, voids))
    if abs(free) > CLOSE * (whole[2] - whole[0] + whole[3] - whole[1]):
        found.append(f"{free:.2f} m² of the outline are no room")
    for door in house.doors:
        inside = [rooms[name].box for name in door.between if name != OUTSIDE]
        if door.length < DOOR - CLOSE:
            found.append(f"a door of {' and '.join(door.between)} is {door.length:.2f} m wide")
        if not (_in_wall(door, *inside) if len(inside) == 2 else _in_outer_wall(door, inside[0], house)):
            found.append(f"a door of {' and '.join(door.between)} is in no wall between them")
    for window in house.windows:
        if not _in_outer_wall(window, rooms[window.room].box, house):
            found.append(f"a window of {window.room} is in no outer wall")
    if lost := names - _reached(house):
        found.append(f"no door leads to {', '.join(sorted(lost))}")
    return found


def void_boxes(house: House, brief: Brief) -> list[Box]:
    """Return the voids of a brief in a house. In the bank they have a size, and a place or a corner."""
    west, north, east, south = around(room.box for room in house.rooms)
    found = []
    for void in brief.outline.voids:
        w, d = _number(void.width), _number(void.depth)
        if void.corner:
            x = west if "west" in void.corner else east - w
            y = north if "north" in void.corner else south - d
        else:
            x, y = west + _number(void.x), north + _number(void.y)
        found.append((x, y, x + w, y + d))
    return found


def _number(span: Span | None) -> float:
    if not isinstance(span, float | int):
        raise HouseFileError("a brief of which answers are scored gives each void its size and its place")
    return span


def _in_wall(segment: Rect, one: Box, other: Box) -> bool:
    """Return True if a segment lies in the wall that two boxes share."""
    wall = shared(one, other)
    return wall is not None and _lies_in(segment, one, *wall)


def _in_outer_wall(segment: Rect, box: Box, house: House) -> bool:
    """Return True if a segment lies in a side of a box where no other room is."""
    boxes = [room.box for room in house.rooms]
    return any(_lies_in(segment, box, *part) for part in outer_parts(boxes, boxes.index(box)))


def _lies_in(segment: Rect, box: Box, side: str, low: float, high: float) -> bool:
    number = SIDES.index(side)
    across, along = number % 2, 1 - number % 2
    at = segment.box
    return (
        max(abs(at[across] - box[number]), abs(at[across + 2] - box[number])) < CLOSE
        and at[along] > low - CLOSE
        and at[along + 2] < high + CLOSE
    )


def _reached(house: House) -> set[str]:
    """Return the rooms that doors lead to, from the first entrance, or else from the first room."""
    reached, new = set[str](), {house.start.name}
    while new:
        reached |= new
        ways = (set(door.between) for door in house.doors if new & set(door.between))
        new = set().union(*ways) - reached - {OUTSIDE}
    return reached


# - the lines of a brief ------------------------------------------------------


def lines(house: House, brief: Brief) -> Iterator[JudgedLine]:
    """Yield each line of a brief, with True if the house keeps it.

    The house must have all rooms of the brief.
    """
    rooms = {room.name: room for room in house.rooms}
    doors = {frozenset(door.between) for door in house.doors}
    for one, other in brief.doors:
        yield JudgedLine("edge", f"a door joins {one} and {other}", frozenset((one, other)) in doors)
    for one, other in brief.no_doors:
        yield JudgedLine("edge", f"no door joins {one} and {other}", frozenset((one, other)) not in doors)
    for one, other in brief.next_to:
        wall = contact(rooms[one].box, rooms[other].box)
        yield JudgedLine("edge", f"{one} is next to {other}", wall > WALL - ROUNDED)
    for one, other in brief.apart:
        yield JudgedLine(
            "edge", f"{one} is not next to {other}", contact(rooms[one].box, rooms[other].box) < CLOSE
        )
    for wanted in brief.rooms:
        yield from _of_room(house, rooms[wanted.name], wanted, brief)
    if brief.entrance is not None:
        entrance = Entrance(brief.entrance) if isinstance(brief.entrance, str) else brief.entrance
        ways = [door for door in house.doors if set(door.between) == {entrance.room, OUTSIDE}]
        sides = {_side_of(door, rooms[entrance.room]) for door in ways}
        kept = bool(ways) and entrance.side in (None, *sides)
        yield JudgedLine("other", f"the house is entered by {entrance.room}", kept)
    west, north, east, south = around(room.box for room in house.rooms)
    for span, length, name in (
        (brief.outline.width, east - west, "wide"),
        (brief.outline.depth, south - north, "deep"),
    ):
        if span is not None:
            yield JudgedLine("other", f"the outline is {span} m {name}", _is_length(length, span, 0))
    if brief.area is not None:
        total = sum(area(room.box) for room in house.rooms)
        yield JudgedLine(
            "area", f"the house has {brief.area} m²", _is_area(total, brief.area, brief.tolerance)
        )


def _of_room(house: House, room: Room, wanted: BriefRoom, brief: Brief) -> Iterator[JudgedLine]:
    name, tolerance = wanted.name, brief.tolerance if wanted.tolerance is None else wanted.tolerance
    if wanted.type:
        yield JudgedLine("other", f"{name} is of type {wanted.type}", room.type == wanted.type)
    if wanted.area is not None:
        yield JudgedLine("area", f"{name} has {wanted.area} m²", _is_area(room.area, wanted.area, tolerance))
    if wanted.size is not None:
        kept = any(
            all(_is_length(length, span, tolerance) for length, span in zip(sides, wanted.size, strict=True))
            for sides in ((room.width, room.height), (room.height, room.width))
        )
        yield JudgedLine("area", f"{name} measures {wanted.size[0]} by {wanted.size[1]} m", kept)
    boxes = [each.box for each in house.rooms]
    sides = {
        side for side, low, high in outer_parts(boxes, boxes.index(room.box)) if high - low > WALL - CLOSE
    }
    if wanted.outside is True:
        yield JudgedLine("other", f"{name} has an outer wall", bool(sides))
    for side in wanted.outside or () if not isinstance(wanted.outside, bool) else ():
        yield JudgedLine("other", f"{name} has an outer wall in the {side}", side in sides)
    windows = {_side_of(window, room) for window in house.windows if window.room == name}
    for side in wanted.windows:
        yield JudgedLine("other", f"{name} has a window in the {side}", side in windows)


def _side_of(segment: Rect, room: Room) -> str:
    """Return the side of a room in which a door or a window is, or an empty text."""
    at = segment.box
    for number, side in enumerate(SIDES):
        across = number % 2
        if max(abs(at[across] - room.box[number]), abs(at[across + 2] - room.box[number])) < CLOSE:
            return side
    return ""


def _is_length(length: float, span: Span, tolerance: float) -> bool:
    least, most = span if isinstance(span, tuple) else (span * (1 - tolerance), span * (1 + tolerance))
    return least - ROUNDED <= length <= most + ROUNDED


def _is_area(found: float, span: Span, tolerance: float) -> bool:
    least, most = span if isinstance(span, tuple) else (span * (1 - tolerance), span * (1 + tolerance))
    return least * (1 - ROUNDED) - READ <= found <= most * (1 + ROUNDED) + READ


def plan_of(house: House) -> frozenset[tuple[str, str, str]]:
    """Return the pairs of rooms that share walls, with the side.

    Houses with the same pairs and sides differ only in lengths.
    """
    rooms = sorted(house.rooms, key=lambda room: room.name)
    walls = ((a, b, shared(a.box, b.box)) for a, b in combinations(rooms, 2))
    return frozenset((a.name, b.name, wall[0]) for a, b, wall in walls if wall and wall[2] - wall[1] > WALL)
