"""Rooms with given places, and the rooms behind each of their walls."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import msgspec

from vitruvius.logic.house.boxes import TOLERANCE, WALLS, Box
from vitruvius.logic.house.parts import OUTSIDE, Door, Room, Window
from vitruvius.logic.house.walls import remaining


@dataclass(frozen=True)
class Wall:
    """Part of one side of a room. On the other side is one other room, by its number, or the outside.

    Metres: ``place`` across the wall, ``start`` and ``end`` along it.
    """

    room: int
    side: str
    behind: int | None
    place: float
    start: float
    end: float


class OwnPlan(msgspec.Struct, frozen=True, forbid_unknown_fields=True, dict=True):
    """Rooms with names, types (empty: any) and places in metres, x east, y south.

    If the plan has doors between rooms, the house has no others. The same holds for an entrance, and for
    windows.
    """

    rooms: Annotated[tuple[Room, ...], msgspec.Meta(min_length=1)]
    doors: tuple[Door, ...] = ()
    windows: tuple[Window, ...] = ()
    kept: tuple[str, ...] = ()
    """Names of the rooms whose furniture stays. The other rooms have none yet."""
    has_more_doors: bool = False
    """True if doors between rooms may be added."""

    @cached_property
    def lines(self) -> list[dict[str, tuple[str, int]]]:
        """For each room and side the line that it lies on: its axis, and its number from west or north."""
        numbers = [_numbers(edge for room in self.rooms for edge in room.box[k::2]) for k in (0, 1)]
        return [
            {side: ("xy"[k % 2], numbers[k % 2][room.box[k]]) for k, side in enumerate(WALLS)}
            for room in self.rooms
        ]

    @property
    def outline(self) -> Box:
        """Box around all rooms: (west, north, east, south), metres."""
        west, north, east, south = zip(*(room.box for room in self.rooms), strict=True)
        return min(west), min(north), max(east), max(south)

    @cached_property
    def walls(self) -> list[Wall]:
        """Sides of all rooms, each divided at the corners of the rooms behind it."""
        return [
            wall for number in range(len(self.rooms)) for side in WALLS for wall in self._side(number, side)
        ]

    def wall_of(self, opening: Door | Window) -> Wall | None:
        """Return the wall that a door or window lies in, on the side of its first room, or None."""
        names = [room.name for room in self.rooms]
        between = opening.between if isinstance(opening, Door) else (opening.room, OUTSIDE)
        room, behind = sorted((names.index(name) if name != OUTSIDE else None for name in between), key=str)
        walls = (wall for wall in self.walls if (wall.room, wall.behind) == (room, behind))
        return next((wall for wall in walls if _holds(wall, opening)), None)

    def wall_around(self, window: Window) -> Wall | None:
        """Return the wall around a window with anything behind it, as a window may face an outdoor room."""
        walls = (wall for wall in self.walls if self.rooms[wall.room].name == window.room)
        return next((wall for wall in walls if _holds(wall, window)), None)

    def _side(self, number: int, side: str) -> Iterator[Wall]:
        k = WALLS.index(side)
        opposite = WALLS[(k + 2) % 4]
        box = self.rooms[number].box
        shared = []
        for other, room in enumerate(self.rooms):
            if self.lines[other][opposite] == self.lines[number][side]:
                start, end = _common(box, room.box, 1 - k % 2)
                if end - start > TOLERANCE:
                    shared.append((start, end))
                    yield Wall(number, side, other, box[k], start, end)
        for start, end in remaining((box[1 - k % 2], box[3 - k % 2]), shared):
            yield Wall(number, side, None, box[k], start, end)


def _numbers(values: Iterable[float]) -> dict[float, int]:
    """Return the number of each value in ascending order. Values within a tolerance have the same number."""
    numbers: dict[float, int] = {}
    last, number = float("-inf"), -1
    for value in sorted(set(values)):
        number += value - last > TOLERANCE
        numbers[value] = number
        last = value
    return numbers


def _common(one: Box, other: Box, axis: int) -> tuple[float, float]:
    return max(one[axis], other[axis]), min(one[axis + 2], other[axis + 2])


def _holds(wall: Wall, opening: Door | Window) -> bool:
    """Return True if the whole of an opening lies in a wall."""
    k = WALLS.index(wall.side) % 2
    start, end, place = opening.box[1 - k], opening.box[3 - k], opening.box[k]
    along = wall.start - TOLERANCE <= start and end <= wall.end + TOLERANCE
    return along and abs(place - wall.place) + abs(opening.box[k + 2] - wall.place) <= TOLERANCE
