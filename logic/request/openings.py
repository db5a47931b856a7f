"""Doors and windows near walls of a plan, moved into these walls."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import shapely

from vitruvius.logic.house.boxes import WALLS, Box
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.readers.regular import Opening, Regular
from vitruvius.logic.readers.types import table
from vitruvius.logic.request.own_plan import OwnPlan, Wall
from vitruvius.logic.shapes.lines import MAX_WALL_M
from vitruvius.logic.spelling import numbered

REACH = MAX_WALL_M / 2 + 0.15
"""Greatest distance from a wall at which its doors and windows may be drawn, metres."""

ROUND = 0.05
"""Unit to which the widths of doors are rounded if only noise lies between, metres."""

ALL = 0.2
"""Metres by which an opening without a leaf may be shorter than its wall and still open the whole wall."""

MIN_OPENING_M = 0.4
"""Least width of a door or a window, metres."""


MAX_PLACES = 5
"""Largest number of ignored doors, and of ignored windows, that have a note each."""


class Placed(NamedTuple):
    """Doors and windows in the walls of a plan, and notes on those that are in no wall."""

    doors: tuple[Door, ...]
    windows: tuple[Window, ...]
    has_more: bool
    """True if no drawn door leads to some room, so that the house may have more doors."""
    notes: list[str]


def placed(plan: OwnPlan, drawn: Regular, noise: float) -> Placed:
    """Return the doors and windows of a drawing, moved into the nearest walls of a plan of its rooms.

    If a drawing does not state its entrance, one of the doors that lead outside is the entrance, by the types
    of their rooms; the others are garden doors. A door that is known to be no entrance, or is before a
    balcony, becomes a window in a drawing with windows. The whole wall between the parts of one room is open.
    """
    names = [room.name for room in plan.rooms]
    inner = [wall for wall in plan.walls if wall.behind is not None and wall.room < wall.behind]
    outer = [wall for wall in plan.walls if wall.behind is None]
    doors, windows, notes = list[Door](), list[Window](), list[str]()
    alone: list[str] = []
    ignored: dict[str, list[Opening]] = {"door": [], "window": []}
    knows_entrance = any(each.is_entrance for each in drawn.passages)
    in_front = list[Door]()
    for opening in (piece for each in drawn.passages for piece in _pieces(each, inner)):
        found = _nearest(opening, [*inner, *outer])
        if found is None:
            ignored["door"].append(opening)
            continue
        wall, start, end = found
        is_garden = wall.behind is None and (
            (knows_entrance and opening.is_entrance is False) or _leads_out(opening, drawn)
        )
        if is_garden and drawn.windows:
            windows.append(Window(*_segment(wall, start, end - start), names[wall.room]))
            continue
        between = names[wall.room], OUTSIDE if wall.behind is None else names[wall.behind]
        length = _rounded(end - start, noise)
        if opening.is_open and length > wall.end - wall.start - ALL:
            start, length = wall.start, wall.end - wall.start
        doors.append(Door(*_segment(wall, start, length), between, opening=opening.is_open))
        if wall.behind is None and not is_garden and (opening.is_entrance or not knows_entrance):
            in_front.append(doors[-1])
    for opening in drawn.windows:
        if found := _nearest(opening, outer):
            wall, start, end = found
            windows.append(Window(*_segment(wall, start, end - start), names[wall.room]))
        else:
            ignored["window"].append(opening)
    notes += _ignored("door", "a wall", ignored["door"])
    notes += _ignored("window", "an outer wall", ignored["window"])
    if doors:
        doors += _joints(drawn, inner, names)
        if alone := _unreached(names, doors):
            some = f"{', '.join(alone[:3])}{' and others' if alone[3:] else ''}"
            if any(not each.is_open for each in drawn.passages):
                notes.append(f"no drawn door leads to {some}: doors may be added")
    kept = _entrance_first(list(_widest(doors, notes)), in_front, plan, [] if knows_entrance else notes)
    return Placed(tuple(kept), tuple(windows), bool(doors and alone), notes)


def _ignored(what: str, where: str, openings: Sequence[Opening]) -> Iterator[str]:
    """Yield notes on openings that are ignored, the first of them each by its place."""
    for opening in openings[:MAX_PLACES]:
        yield f"a {what} at {_at(opening)} is not in {where}: ignored"
    if more := len(openings[MAX_PLACES:]):
        yield f"{numbered(more, f'more {what}')} {'is' if more == 1 else 'are'} not in {where}: ignored"


def _entrance_first(
    doors: Sequence[Door], in_front: Sequence[Door], plan: OwnPlan, notes: list[str]
) -> Sequence[Door]:
    """Return the doors with the entrance before the garden doors: a door of a hall, else of a corridor ..."""
    types, order = {room.name: room.type for room in plan.rooms}, table().entered

    def rank(door: Door) -> tuple[bool, int]:
        entered = types[_inner(door)]
        return door not in in_front, order.index(entered) if entered in order else len(order)

    leading = sorted((door for door in doors if door.is_entrance), key=rank)
    if len(leading) < 2:
        return doors
    entrance, *others = leading
    gardens = ", ".join(dict.fromkeys(map(_inner, others)))
    are = "the one of {} a garden door" if len(others) == 1 else "those of {} garden doors"
    notes.append(
        f"{len(leading)} doors lead outside: the one of {_inner(entrance)} becomes the entrance, "
        f"{are.format(gardens)}"
    )
    return sorted(doors, key=lambda door: door.is_entrance and door is not entrance)


def _inner(door: Door) -> str:
    """Return the name of the room whose door leads outside."""
    return next(name for name in door.between if name != OUTSIDE)


def _pieces(opening: Opening, inner: Sequence[Wall]) -> Iterator[Opening]:
    """Yield an opening, or one piece for each wall if an opening without a leaf spans several walls."""
    box, axis = opening.box, int(opening.box[2] - opening.box[0] > opening.box[3] - opening.box[1])
    low, high = box[1 - axis], box[3 - axis]
    spans = [
        (start, end)
        for wall in inner
        if WALLS.index(wall.side) % 2 == axis and abs(wall.place - (box[axis] + box[axis + 2]) / 2) < ROUND
        if (end := min(high, wall.end)) - (start := max(low, wall.start)) > MIN_OPENING_M
    ]
    if not opening.is_open or len(spans) < 2:
        yield opening
        return
    for start, end in spans:
        sides = (box[0], start, box[2], end) if axis == 0 else (start, box[1], end, box[3])
        yield opening._replace(box=sides)


def _nearest(opening: Opening, walls: Sequence[Wall]) -> tuple[Wall, float, float] | None:
    """Return the wall that contains an opening, and its start and end as drawn along the wall, metres."""
    box = opening.box
    axis = int(box[2] - box[0] > box[3] - box[1])  # the axis across which it is thin
    middle, low, high = (box[axis] + box[axis + 2]) / 2, box[1 - axis], box[3 - axis]
    best, least = None, REACH
    for wall in walls:
        off = abs(wall.place - middle)
        start, end = max(low, wall.start), min(high, wall.end)
        runs = WALLS.index(wall.side) % 2 == axis
        if runs and off < least and end - start > max(MIN_OPENING_M, (high - low) / 2):
            best, least = (wall, low, high), off
    return best


def _rounded(length: float, noise: float) -> float:
    """Return the length of a door without noise."""
    whole = round(length / ROUND) * ROUND
    return whole if abs(whole - length) <= 2 * noise + 1e-6 else length


def _segment(wall: Wall, start: float, length: float) -> Box:
    """Return x, y, width and height of a part of a wall, or of the whole wall."""
    length = round(min(length, wall.end - wall.start), 6)
    start = round(max(wall.start, min(start, wall.end - length)), 6)
    if WALLS.index(wall.side) % 2:
        return start, wall.place, length, 0.0
    return wall.place, start, 0.0, length


def _leads_out(opening: Opening, drawn: Regular) -> bool:
    """Return True if a door leads to a balcony or a similar area."""
    box = shapely.box(*opening.box)
    return any(shapely.distance(box, each) < REACH for each in drawn.outdoors)


def _joints(drawn: Regular, inner: Sequence[Wall], names: Sequence[str]) -> Iterator[Door]:
    for wall in inner:
        between = names[wall.room], names[wall.behind or 0]
        if between in drawn.joints or between[::-1] in drawn.joints:
            yield Door(*_segment(wall, wall.start, wall.end - wall.start), between, opening=True)


def _unreached(names: Sequence[str], doors: Sequence[Door]) -> list[str]:
    """Return the rooms outside the largest group of rooms that doors join."""
    reached = {name: {name} for name in names}
    for one, other in (door.between for door in doors if not door.is_entrance):
        joined = reached[one] | reached[other]
        reached |= dict.fromkeys(joined, joined)
    most = max(reached.values(), key=len)
    return [name for name in names if name not in most]


def _widest(doors: Sequence[Door], notes: list[str]) -> Iterator[Door]:
    """Yield one door between any two rooms, the widest."""
    best: dict[frozenset[str], Door] = {}
    narrower = dict[str, None]()
    for door in sorted(doors, key=lambda door: door.length, reverse=True):
        one, other = door.between
        if best.setdefault(frozenset(door.between), door) is not door:
            narrower[f"of two doors between {one} and {other} the wider is kept"] = None
    notes += narrower
    yield from (door for door in doors if best[frozenset(door.between)] is door)


def _at(opening: Opening) -> str:
    west, north, east, south = opening.box
    return f"x {(west + east) / 2:.2f}, y {(north + south) / 2:.2f} m"
