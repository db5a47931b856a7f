"""Walls of a plan that nearly coincide, moved onto one line."""

from collections import Counter
from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple, TypeVar

from msgspec.structs import replace

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.boxes import TOLERANCE
from vitruvius.logic.house.parts import Door, Rect, Room, Window

R = TypeVar("R", bound=Rect)


class Snapped(NamedTuple):
    """Rooms, doors and windows on common lines, number of moved edges, and the largest move, metres."""

    rooms: tuple[Room, ...]
    doors: tuple[Door, ...]
    windows: tuple[Window, ...]
    moved: int
    farthest: float


def snapped(
    rooms: Sequence[Room], doors: Sequence[Door], windows: Sequence[Window], within: float
) -> Snapped:
    """Move near edges of rooms onto one line, that of most of them, if rooms nearly share walls.

    Edges are near within ``within`` metres. Otherwise nothing moves, since ends of walls may lie as near.
    Doors and windows move with their walls. Raises ``RequestError`` if lines follow each other so that an
    edge would move further than ``within``.
    """
    if not _nearly_shared(rooms, within):
        return Snapped(tuple(rooms), tuple(doors), tuple(windows), 0, 0.0)
    lines = [_lines([edge for room in rooms for edge in room.box[k::2]], within, "xy"[k]) for k in (0, 1)]
    moves = [abs(lines[k % 2][value] - value) for room in rooms for k, value in enumerate(room.box)]
    moved = [move for move in moves if move > TOLERANCE]
    new = tuple(_on_lines(room, lines) for room in rooms)
    new_doors = tuple(_with_wall(each, lines, within) for each in doors)
    new_windows = tuple(_with_wall(each, lines, within) for each in windows)
    return Snapped(new, new_doors, new_windows, len(moved), max(moved, default=0.0))


def _nearly_shared(rooms: Sequence[Room], within: float) -> bool:
    """Return True if walls of two rooms face each other at most ``within`` metres apart, not on one line.

    They must overlap over more than ``within`` metres.
    """
    boxes = [room.box for room in rooms]
    for one, other in permutations(boxes, 2):
        for k in (0, 1):
            off, along = other[k] - one[k + 2], min(one[3 - k], other[3 - k]) - max(one[1 - k], other[1 - k])
            if TOLERANCE < abs(off) <= within and along > within:
                return True
    return False


def _lines(values: Sequence[float], within: float, axis: str) -> dict[float, float]:
    """Return for each value the line that it lies on."""
    counts, groups = Counter(values), list[list[float]]()
    for value in sorted(counts):
        if not groups or value - groups[-1][-1] > max(within, TOLERANCE):
            groups.append([])
        groups[-1].append(value)
    lines = {}
    for group in groups:
        line = max(group, key=lambda value: counts[value])
        if max(line - group[0], group[-1] - line) > max(within, TOLERANCE):
            raise RequestError(
                f"plan: edges at {axis} {group[0]:g} to {group[-1]:g} m lie less than {within:g} m apart, "
                "one after the other: it is unclear which form one wall. Draw them on one line, or give a "
                "smaller --snap"
            )
        lines |= dict.fromkeys(group, line)
    return lines


def _on_lines(room: Room, lines: Sequence[dict[float, float]]) -> Room:
    west, north, east, south = (lines[k % 2][value] for k, value in enumerate(room.box))
    if max(abs(a - b) for a, b in zip((west, north, east, south), room.box, strict=True)) <= TOLERANCE:
        return room
    return replace(room, x=west, y=north, width=round(east - west, 9), height=round(south - north, 9))


def _with_wall(opening: R, lines: Sequence[dict[float, float]], within: float) -> R:
    """Return a door or window on the line nearest to it, with its length unchanged."""
    axis = int(opening.height == 0)  # the axis across which it has no length
    place = opening.box[axis]
    near = min(lines[axis], key=lambda value: abs(value - place))
    if not TOLERANCE < abs(lines[axis][near] - place) <= 2 * within + TOLERANCE:
        return opening
    return replace(opening, **{"xy"[axis]: lines[axis][near]})
