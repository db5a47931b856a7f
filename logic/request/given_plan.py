"""A plan of the user's: rooms that have their places, for doors, windows and furniture to be generated in.

It is read from a house file or from GeoJSON, and refused here if it is no plan: rooms that overlap, lie apart
or leave gaps. Which rules it breaks is found later, as a proof (``logic.generation.given_plan``).
"""

import io
import json
import warnings
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations
from pathlib import Path
from typing import Any

import msgspec
import shapely

from logic.checking.figures import figure
from logic.checking.shared_walls import gaps
from logic.errors import HouseFileError, PlanWarning, RequestError
from logic.house.boxes import TOLERANCE, WALLS, Box, overlap
from logic.house.files import STANDARD, load, opened
from logic.house.house import House
from logic.house.parts import FARTHEST, MOST_ROOMS, OUTSIDE, Door, Room, Window
from logic.house.walls import remaining
from logic.request.geojson import from_geojson, is_geojson
from logic.request.other_formats import named
from logic.request.snapping import snapped
from logic.spelling import numbered

MOST_BYTES = 1 << 24
"""What is read of a GeoJSON file."""

SNAP, MOST_SNAP = 0.01, 0.5
"""Metres within which edges are one wall, and how much that may be."""

HINT = "rooms are rectangles side by side, and walls have no thickness: draw rooms to the middle of each wall"


@dataclass(frozen=True)
class Wall:
    """A part of one side of a room: on the other side is one other room, by its number, or the outside.

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

    If there are doors between rooms, there will be no others; likewise an entrance, and windows.
    """

    rooms: tuple[Room, ...]
    doors: tuple[Door, ...] = ()
    windows: tuple[Window, ...] = ()
    kept: tuple[str, ...] = ()
    """Names of the rooms whose furniture stays; the others have none yet."""

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
        """The box around all rooms: (west, north, east, south), metres."""
        west, north, east, south = zip(*(room.box for room in self.rooms), strict=True)
        return min(west), min(north), max(east), max(south)

    @cached_property
    def walls(self) -> list[Wall]:
        """The sides of all rooms, each cut at what lies behind it."""
        return [
            wall for number in range(len(self.rooms)) for side in WALLS for wall in self._side(number, side)
        ]

    def wall_of(self, opening: Door | Window) -> Wall | None:
        """The wall that a door or window lies in, on the side of its first room; None if in none."""
        names = [room.name for room in self.rooms]
        between = opening.between if isinstance(opening, Door) else (opening.room, OUTSIDE)
        room, behind = sorted((names.index(name) if name != OUTSIDE else None for name in between), key=str)
        for wall in self.walls:
            k = WALLS.index(wall.side) % 2
            start, end, place = opening.box[1 - k], opening.box[3 - k], opening.box[k]
            along = wall.start - TOLERANCE <= start and end <= wall.end + TOLERANCE
            on = abs(place - wall.place) + abs(opening.box[k + 2] - wall.place) <= TOLERANCE
            if (wall.room, wall.behind) == (room, behind) and along and on:
                return wall
        return None

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


def read_plan(source: str | Path | House | Mapping[str, Any], unit: str = "m", snap: float = SNAP) -> OwnPlan:
    """A plan from a house, from GeoJSON as a dict, or from a file of either.

    ``unit`` of GeoJSON: see ``from_geojson``. ``snap``: metres within which edges are one wall. Warns
    (``PlanWarning``) of what was moved or passed over. Raises ``HouseFileError`` for a file that cannot be
    read, ``RequestError`` for what is no plan.
    """
    if not 0 <= snap <= MOST_SNAP:
        raise RequestError(f"snap must be 0 to {MOST_SNAP:g} m, not {snap!r}")
    if isinstance(source, str | Path):
        source = _from_file(Path(source))
    if isinstance(source, House):
        rooms = [msgspec.structs.replace(room, children=()) for room in source.rooms]
        doors, windows, notes = source.doors, source.windows, list[str]()
    else:
        rooms, notes = from_geojson(source, unit, snap)
        doors, windows = (), ()
    _require_rooms(rooms)
    on_lines = snapped(rooms, doors, windows, snap)
    if on_lines.moved:
        how_many = f"{numbered(on_lines.moved, 'edge')} of rooms"
        notes.append(f"{how_many} moved by {on_lines.farthest:.2g} m at most, onto walls beside them: --snap")
    for note in notes:
        warnings.warn(f"plan: {note}", PlanWarning, stacklevel=3)
    plan = OwnPlan(on_lines.rooms, on_lines.doors, on_lines.windows)
    _require_plan(plan)
    return plan


def keeping(plan: OwnPlan, house: House) -> OwnPlan:
    """The plan in which all rooms of a house are as they are there, with their types and furniture.

    Raises ``RequestError`` where the plan has another room in the place of one of them, or no doors: what is
    kept stands clear of the doors that there were.
    """
    rooms = {room.name: room for room in house.rooms}
    places = {room.name: room.box for room in plan.rooms}
    if not rooms:
        raise RequestError('keep: the house has no room to keep: name some, as in keep=house.only("R0")')
    for name, room in rooms.items():
        if (
            name not in places
            or max(abs(a - b) for a, b in zip(room.box, places[name], strict=True)) > TOLERANCE
        ):
            raise RequestError(f"keep: the plan has no {name} where it is: give the plan of the same house")
    if not plan.doors:
        raise RequestError("keep: the plan has no doors: give a house with them, as --plan FILE")
    return msgspec.structs.replace(
        plan, rooms=tuple(rooms.get(room.name, room) for room in plan.rooms), kept=tuple(rooms)
    )


def _from_file(path: Path) -> House | dict[str, Any]:
    content = _content(path)
    try:
        record = json.loads(content)
    except (ValueError, RecursionError):
        record = None  # A file that is absent or no JSON; JSON Lines are no GeoJSON.
    if isinstance(record, dict) and is_geojson(record):
        return record
    if what := named(content):
        raise HouseFileError(f"{path}: {what}")
    # The standard input is read once.
    houses = load(path, io.BytesIO(content) if path == STANDARD else None)
    if len(houses) > 1:
        raise RequestError(f"plan: {path} holds {len(houses)} houses: give a file of one")
    return houses[0]


def _content(path: Path) -> bytes:
    """What a file or the standard input holds; nothing where it cannot be read: ``load`` says why."""
    try:
        with opened(path) as file:
            return file.read(MOST_BYTES)
    except (OSError, EOFError, zlib.error):
        return b""


def _require_rooms(rooms: Sequence[Room]) -> None:
    """Refuse rooms that are none, each by its name."""
    if len(rooms) > MOST_ROOMS:
        raise RequestError(f"plan: it has {numbered(len(rooms), 'room')}: at most {MOST_ROOMS:,} are read")
    names = [room.name for room in rooms]
    for room in rooms:
        if names.count(room.name) > 1 or room.name == OUTSIDE:
            raise RequestError(f"plan: the name {room.name!r} is another room's: give each room its own")
        if not max(map(abs, room.box)) <= FARTHEST or min(room.width, room.height) < TOLERANCE:
            size = f"{room.width:g} by {room.height:g} m at x {room.x:g}, y {room.y:g}"
            raise RequestError(
                f"plan: {room.name} is {size}: a room has a size, within {FARTHEST:g} m of (0, 0)"
            )


def _require_plan(plan: OwnPlan) -> None:
    """Refuse rooms that are no plan, each by its name."""
    for fault in _covers(plan):
        raise RequestError(f"plan: {fault}")
    for fault in chain(_overlaps(plan), _apart(plan), _gaps(plan)):
        raise RequestError(f"plan: {fault}: {HINT}")
    for fault in _misplaced(plan):
        raise RequestError(f"plan: {fault}")


def _covers(plan: OwnPlan) -> Iterator[str]:
    """Rooms that stand twice, and outlines drawn as rooms."""
    for room in plan.rooms:
        held = [each for each in plan.rooms if each is not room and _within(each.box, room.box)]
        if same := next((each.name for each in held if _within(room.box, each.box)), ""):
            yield f"{room.name} and {same} are the same rectangle: leave one of them out"
        elif held:
            names = ", ".join(each.name for each in held[:3])
            more = f" and {len(held) - 3} more" if len(held) > 3 else ""
            yield f"{room.name} has {names}{more} within it: is it an outline, and no room? Leave it out"


def _within(inner: Box, outer: Box) -> bool:
    west, north, east, south = (a - b for a, b in zip(inner, outer, strict=True))
    return min(west, north) >= -TOLERANCE and max(east, south) <= TOLERANCE


def _overlaps(plan: OwnPlan) -> Iterator[str]:
    for one, other in combinations(plan.rooms, 2):
        if (depth := overlap(one.box, other.box)) > TOLERANCE:
            yield f"{one.name} overlaps {other.name} by {figure(depth, digits=3)} m{_by_snap(depth)}"


def _apart(plan: OwnPlan) -> Iterator[str]:
    """The first room that no way by shared walls leads to from the first of all."""
    reached, waiting = {0}, [0]
    while waiting:
        number = waiting.pop()
        new = {wall.behind for wall in plan.walls if wall.room == number and wall.behind is not None}
        waiting += new - reached
        reached |= new
    for number, room in enumerate(plan.rooms):
        if number not in reached:
            around = [shapely.box(*plan.rooms[other].box) for other in reached]
            off = min(shapely.distance(around, shapely.box(*room.box)))
            near = f", {figure(off, digits=3)} m off{_by_snap(off, MOST_SNAP)}" if off > TOLERANCE else ""
            yield f"{room.name} shares no wall with the rooms around {plan.rooms[0].name}{near}"
            return


def _gaps(plan: OwnPlan) -> Iterator[str]:
    """What lies between rooms and is none, as the check finds it too."""
    for gap in shapely.get_parts(gaps(House(plan.rooms, (), ()))):
        if gap.area > 1e-4:
            west, north, east, south = gap.bounds
            wide = min(east - west, south - north)
            around = [room.name for room in plan.rooms if shapely.box(*room.box).distance(gap) < 1e-4]
            size = f"{figure(gap.area)} m² between {', '.join(around)} are no room's"
            yield f"{size}, {figure(wide, digits=3)} m wide{_by_snap(wide)}"


def _by_snap(off: float, most: float = MOST_SNAP / 4) -> str:
    """What to do about walls that are so far apart, if they may be meant to be one."""
    more = figure(off + 0.001, digits=3)
    return f" (--snap {more} takes these walls for one)" if off + 0.001 < most else ""


def _misplaced(plan: OwnPlan) -> Iterator[str]:
    """Doors and windows that lie in no wall of their rooms, and all but one door between the same rooms."""
    joined: set[frozenset[str]] = set()
    for door in plan.doors:
        one, other = door.between
        if plan.wall_of(door) is None:
            yield f"the door between {one} and {other} is in no wall that they share"
        if frozenset(door.between) in joined:
            yield f"there are two doors between {one} and {other}: keep one of them"
        joined.add(frozenset(door.between))
    for window in plan.windows:
        if plan.wall_of(window) is None:
            yield f"a window of {window.room} at x {window.x:g}, y {window.y:g} is in no outer wall of it"


def _numbers(values: Iterable[float]) -> dict[float, int]:
    """The number of each value in their order; those that differ by a tolerance at most have the same."""
    numbers: dict[float, int] = {}
    last, number = float("-inf"), -1
    for value in sorted(set(values)):
        number += value - last > TOLERANCE
        numbers[value] = number
        last = value
    return numbers


def _common(one: Box, other: Box, axis: int) -> tuple[float, float]:
    return max(one[axis], other[axis]), min(one[axis + 2], other[axis + 2])
