"""What is right in answers to the bank's briefs: by geometry alone, the same for every generator."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import msgspec
import numpy as np

from benchmarks.briefs.bank import BriefEntry
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
from logic.errors import HouseFileError
from logic.house.files import opened
from logic.house.house import House
from logic.house.parts import OUTSIDE, Rect, Room
from logic.request.brief import Brief, BriefRoom, Entrance, Span
from logic.spelling import unknown

DOOR = 0.7
"""Metres: a door is at least so wide."""

WALL = 0.1
"""Metres: rooms that are next to each other share at least so much wall, as ``docs/briefs.md`` says."""

ROUNDED = 1e-3
"""Metres, and as a share of an area: how much an answer may be off."""


class Answer(msgspec.Struct, frozen=True, omit_defaults=True):
    """What a generator makes of a brief: houses, or that it is impossible; with neither, no answer."""

    brief: str
    """The name of its entry in the bank."""
    houses: tuple[dict[str, Any], ...] = ()
    """In the form of ``docs/house.schema.json``: the first one is judged, all count for diversity."""
    impossible: bool = False
    because: tuple[str, ...] = ()
    """The lines that are in conflict, in words."""
    seconds: float | None = None
    """Processor time until the first house or the proof."""


class JudgedLine(NamedTuple):
    """A line of a brief, and whether a house keeps it."""

    kind: str
    """``edge``, ``area``, or ``other``."""
    words: str
    kept: bool


def read_answers(path: Path) -> list[Answer]:
    """Answers as JSON Lines. Raises ``HouseFileError`` with the line that is none."""
    found = []
    with opened(path) as file:
        for number, line in enumerate(file, start=1):
            try:
                found.append(msgspec.json.decode(line, type=Answer))
            except msgspec.DecodeError as error:
                raise HouseFileError(f"{path}:{number}: no answer: {error}") from None
    return found


# - a house -------------------------------------------------------------------


def faults(house: House, brief: Brief) -> list[str]:
    """Why a house is no plan of the rooms of a brief: names, overlaps, gaps, doors and windows that are in no
    wall, rooms that are not reached; none where it is one.
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
    """The voids of a brief in a house. They have a size, and a place or a corner, in the bank."""
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
    """Whether a segment lies in the wall that two boxes share."""
    wall = shared(one, other)
    return wall is not None and _lies_in(segment, one, *wall)


def _in_outer_wall(segment: Rect, box: Box, house: House) -> bool:
    """Whether a segment lies in a side of a box where no other room is."""
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
    """The rooms that doors lead to, from the first entrance; from the first room where there is none."""
    reached, new = set[str](), {house.start.name}
    while new:
        reached |= new
        ways = (set(door.between) for door in house.doors if new & set(door.between))
        new = set().union(*ways) - reached - {OUTSIDE}
    return reached


# - the lines of a brief ------------------------------------------------------


def lines(house: House, brief: Brief) -> Iterator[JudgedLine]:
    """Each line of a brief, of whose rooms a house has all, and whether the house keeps it."""
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
    """The side of a room in which a door or a window is; nothing where it is in none."""
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
    return least * (1 - ROUNDED) <= found <= most * (1 + ROUNDED)


# - answers -------------------------------------------------------------------


class JudgedAnswer(NamedTuple):
    """An answer, judged."""

    entry: BriefEntry
    said: str
    """``house``, ``impossible`` or ``nothing``."""
    faults: list[str]
    lines: list[JudgedLine]
    plans: int
    """How many houses it has, and how many of these differ in which rooms share walls, at which side."""
    different: int
    seconds: float | None

    @property
    def right(self) -> bool:
        """Whether a house keeps all, or the brief is not known to have one and the answer says so."""
        if self.said == "house":
            return not self.faults and all(line.kept for line in self.lines)
        return self.said == "impossible" and self.entry.answer != "house"


def judged(entry: BriefEntry, answer: Answer | None) -> JudgedAnswer:
    """Judge an answer."""
    if answer is None or not (answer.houses or answer.impossible):
        return JudgedAnswer(entry, "nothing", [], [], 0, 0, answer and answer.seconds)
    if answer.impossible:
        return JudgedAnswer(entry, "impossible", [], [], 0, 0, answer.seconds)
    brief = entry.read
    try:
        houses = [House.from_dict(record) for record in answer.houses]
    except ValueError as error:
        return JudgedAnswer(entry, "house", [f"no house: {error}"], [], 0, 0, answer.seconds)
    wrong = faults(houses[0], brief)
    kept = (
        list(lines(houses[0], brief)) if {room.name for room in houses[0].rooms} == set(brief.names) else []
    )
    return JudgedAnswer(
        entry, "house", wrong, kept, len(houses), len(set(map(plan_of, houses))), answer.seconds
    )


def plan_of(house: House) -> frozenset[tuple[str, str, str]]:
    """Which rooms share walls, and at which side: houses of which it is the same differ in lengths alone."""
    rooms = sorted(house.rooms, key=lambda room: room.name)
    walls = ((a, b, shared(a.box, b.box)) for a, b in combinations(rooms, 2))
    return frozenset((a.name, b.name, wall[0]) for a, b, wall in walls if wall and wall[2] - wall[1] > WALL)


def judged_all(bank: Sequence[BriefEntry], answers: Iterable[Answer]) -> list[JudgedAnswer]:
    """Judge the answer to each brief, and that there is none. Raises ``HouseFileError`` for one to a brief
    that there is not, and for a second one.
    """
    known, found = {entry.name for entry in bank}, dict[str, Answer]()
    for answer in answers:
        if answer.brief not in known:
            raise HouseFileError(f"answers: {unknown('brief', answer.brief, known)}")
        if answer.brief in found:
            raise HouseFileError(f"answers: {answer.brief} has two")
        found[answer.brief] = answer
    return [judged(entry, found.get(entry.name)) for entry in bank]


def score(answers: Sequence[JudgedAnswer]) -> dict[str, Any]:
    """The figures of a table: counts, and shares from 0 to 1; None where there is nothing to count."""
    houses = [each for each in answers if each.said == "house"]
    proofs = [each for each in answers if each.said == "impossible"]
    of_kind: Mapping[str, list[bool]] = defaultdict(list)
    for each in houses:
        for line in each.lines:
            of_kind[line.kind].append(line.kept)
    known = [each for each in answers if each.entry.answer == "impossible"]
    return {
        "briefs": len(answers),
        "right": share([each.right for each in answers]),
        "houses": len(houses),
        "valid": share([not each.faults for each in houses]),
        "all lines kept": share([each.right for each in houses]),
        "edges kept": share(of_kind["edge"]),
        "areas kept": share(of_kind["area"]),
        "other lines kept": share(of_kind["other"]),
        "impossible": len(proofs),
        "false refutations": sum(each.entry.answer == "house" for each in proofs),
        "known impossible, named so": share([each.said == "impossible" for each in known]),
        "different plans": mean([each.different / each.plans for each in houses if each.plans > 1]),
        "seconds": {
            rooms: spread(some)
            for rooms in sorted({each.entry.rooms for each in answers})
            if (
                some := [
                    each.seconds for each in answers if each.entry.rooms == rooms and each.seconds is not None
                ]
            )
        },
    }


def share(kept: Sequence[bool]) -> float | None:
    """How many of these are so."""
    return mean(list(map(float, kept)))


def mean(values: Sequence[float]) -> float | None:
    """Of some values; None of none."""
    return sum(values) / len(values) if values else None


def spread(seconds: Sequence[float]) -> tuple[float, float]:
    """The median, and the 95th percentile."""
    return median(seconds), float(np.percentile(seconds, 95))
