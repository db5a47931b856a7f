"""Plans of the user: rooms with given places, for which doors, windows and furniture are generated.

A plan comes from a house file or from GeoJSON. This module rejects rooms that overlap, lie apart or leave
gaps. The rules that a plan breaks are found later, in a proof (``logic.generation.given_plan``).
"""

import io
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from errno import EFBIG
from itertools import chain, combinations
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import shapely

from vitruvius.logic.checking.figures import figure
from vitruvius.logic.checking.shared_walls import gaps
from vitruvius.logic.errors import HouseFileError, PlanWarning, RequestError
from vitruvius.logic.files.house_files import load
from vitruvius.logic.house.boxes import TOLERANCE, Box, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import MAX_COORDINATE_M, MOST_ROOMS, OUTSIDE, Room
from vitruvius.logic.opener import STANDARD, content_of
from vitruvius.logic.readers import sketch
from vitruvius.logic.readers.combined import divided
from vitruvius.logic.readers.features import from_text, is_geojson
from vitruvius.logic.readers.regular import regular
from vitruvius.logic.readers.sketch import Sketch, require_none
from vitruvius.logic.request.geojson import from_geojson
from vitruvius.logic.request.openings import placed
from vitruvius.logic.request.other_formats import READ, named
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.request.snapping import snapped
from vitruvius.logic.shapes.lines import MAX_WALL_M
from vitruvius.logic.spelling import numbered

MOST_BYTES = 1 << 24
"""Largest size of a file, unpacked, in bytes."""

SNAP, MOST_SNAP = 0.01, 0.5
"""Default and greatest distance of edges that count as one wall, metres."""

MORE_SNAP = 0.02, 0.05, 0.1
"""Values of ``--snap`` that an error message may propose, metres."""

HINT = "draw all rooms to the centre lines of their walls, or all from wall to wall"

HINT_OF_WALLS = (
    f"walls between rooms are {MAX_WALL_M:g} m thick at most: draw what lies there as part of a room"
)


class Fault(NamedTuple):
    """Reason why rooms are not a plan, distance of walls that should meet, greatest ``--snap``, metres."""

    said: str
    off: float
    snap: float = MOST_SNAP / 4


def read_plan(
    source: str | Path | House | OwnPlan | Mapping[str, Any],
    unit: str | None = None,
    snap: float = SNAP,
    storey: str | None = None,
    types: Collection[str] | None = None,
) -> OwnPlan:
    """Return the plan in a house, in GeoJSON, in a plan of ResPlan, or in a file recognised by its content.

    ``unit`` is a unit of ``metres_to``; by default the file's, or metres. Edges within ``snap`` metres are
    one wall. ``storey`` names the storey to read. ``types`` are the grammar's types, if known. Warns
    (``PlanWarning``) of walls that moved and features that were ignored. Raises ``HouseFileError`` for a file
    that cannot be read, ``RequestError`` for rooms that are not a plan.
    """
    if not 0 <= snap <= MOST_SNAP:
        raise RequestError(f"snap must be 0 to {MOST_SNAP:g} m, not {snap!r}")
    if isinstance(source, OwnPlan):
        require_none(storey)
        _require_rooms(source.rooms)
        _require_plan(source)
        return source
    found = _read(source, storey)
    try:
        return _plan(found, unit, snap, storey, types)
    except RequestError as error:
        if isinstance(found, Sketch) and (more := _snap_that_does(found, unit, snap, types)):
            raise RequestError(f"{error}, or give --snap {more:g}, which reads this plan") from None
        raise


def _plan(
    found: House | Sketch | Mapping[str, Any],
    unit: str | None,
    snap: float,
    storey: str | None = None,
    types: Collection[str] | None = None,
) -> OwnPlan:
    drawn, noise, hint = None, max(snap, SNAP), HINT_OF_WALLS
    doors, windows = (), ()
    if isinstance(found, House):
        require_none(storey)
        rooms = [msgspec.structs.replace(room, children=()) for room in found.tiles]
        doors, windows, notes, hint = found.doors, found.windows, list[str](), HINT
    else:
        if isinstance(found, Sketch):
            found, said = divided(found, unit)
            drawn = regular(found, unit, snap, types)
            drawn = drawn._replace(notes=[*said, *drawn.notes])
        else:
            drawn, noise = from_geojson(found, unit, snap, storey, types)
            hint = hint if noise else HINT
        rooms, notes = drawn.rooms, drawn.notes
    _require_rooms(rooms)
    on_lines = snapped(rooms, doors, windows, snap)
    if on_lines.moved:
        how_many = f"{numbered(on_lines.moved, 'edge')} of rooms"
        notes.append(f"{how_many} moved by {on_lines.farthest:.2g} m at most, onto walls beside them: --snap")
    plan = OwnPlan(on_lines.rooms, on_lines.doors, on_lines.windows)
    if drawn:
        openings = placed(plan, drawn, noise)
        notes += openings.notes
        plan = OwnPlan(plan.rooms, openings.doors, openings.windows, has_more_doors=openings.has_more)
    for note in notes:
        warnings.warn(f"plan: {note}", PlanWarning, stacklevel=4)
    _require_plan(plan, drawn.wall if drawn and hint == HINT_OF_WALLS else None)
    return plan


def _snap_that_does(
    found: Sketch, unit: str | None, snap: float, types: Collection[str] | None
) -> float | None:
    """Return the least value of ``MORE_SNAP`` with which the drawing is a plan; None if there is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        for more in MORE_SNAP:
            if more > snap:
                with suppress(RequestError):
                    _plan(found, unit, more, None, types)
                    return more
    return None


def keeping(plan: OwnPlan, house: House) -> OwnPlan:
    """Return the plan with all rooms of a house as they are there, with their types and furniture.

    Raises ``RequestError`` if the plan has another room in place of one of them. Raises it, too, for a plan
    without doors, since kept furniture stands clear of the previous doors.
    """
    rooms = {room.name: room for room in house.tiles}
    places = {room.name: room.box for room in plan.rooms}
    if not rooms:
        raise RequestError('keep: the house has no room to keep: name rooms, as in keep=house.only("R0")')
    for name, room in rooms.items():
        if (
            name not in places
            or max(abs(a - b) for a, b in zip(room.box, places[name], strict=True)) > TOLERANCE
        ):
            raise RequestError(f"keep: the plan has no {name} at the same place: give the plan of its house")
    if not plan.doors:
        raise RequestError("keep: the plan has no doors: give a house with them, as --plan FILE")
    return msgspec.structs.replace(
        plan, rooms=tuple(rooms.get(room.name, room) for room in plan.rooms), kept=tuple(rooms)
    )


def _read(
    source: str | Path | House | Mapping[str, Any], storey: str | None
) -> House | Sketch | Mapping[str, Any]:
    """Return the house, the plan of another program, or the GeoJSON in a source."""
    found = _from_file(Path(source), storey) if isinstance(source, str | Path) else source
    if isinstance(found, House):
        if found.occupancy:
            raise RequestError("plan: it is a map of cells, without rooms: draw them as GeoJSON")
        return found
    return found if isinstance(found, Sketch) else sketch(b"", found, storey) or found


def _from_file(path: Path, storey: str | None) -> House | Sketch | dict[str, Any]:
    try:
        content = content_of(path, MOST_BYTES)
        if not content.strip():
            raise HouseFileError(f"{path}: holds no house, and {READ}")
    except OSError as error:
        if error.errno == EFBIG:
            raise HouseFileError(f"{path}: {error.strerror}: a plan is of one house") from None
        content = b""  # ``load`` raises the error
    record, damage = None, ""
    try:
        record = from_text(content)
    except ValueError as error:  # An absent file, or one that is no JSON; JSON Lines are no GeoJSON.
        damage = str(error) if content else ""
    if found := sketch(content, record, storey):
        return found
    if isinstance(record, dict) and is_geojson(record):
        return record
    if what := named(content):
        raise HouseFileError(f"{path}: {what}")
    if damage and path.suffix.lower().startswith(".geojson"):
        raise HouseFileError(f"{path}: is not GeoJSON: {damage}")
    # The standard input is read once.
    houses = load(path, io.BytesIO(content) if path == STANDARD else None)
    if len(houses) > 1:
        raise RequestError(f"plan: {path} holds {len(houses)} houses: give a file of one")
    return houses[0]


def _require_rooms(rooms: Sequence[Room]) -> None:
    """Raise ``RequestError`` for invalid rooms, with their names."""
    if len(rooms) > MOST_ROOMS:
        raise RequestError(f"plan: it has {numbered(len(rooms), 'room')}: at most {MOST_ROOMS:,} are read")
    names = [room.name for room in rooms]
    for room in rooms:
        if names.count(room.name) > 1 or room.name == OUTSIDE:
            raise RequestError(f"plan: two rooms are named {room.name!r}: give each room its own name")
        if not max(map(abs, room.box)) <= MAX_COORDINATE_M or min(room.width, room.height) < TOLERANCE:
            size = f"{room.width:g} by {room.height:g} m at x {room.x:g}, y {room.y:g}"
            raise RequestError(
                f"plan: {room.name} is {size}: a room has a size, within {MAX_COORDINATE_M:g} m of (0, 0)"
            )


def _require_plan(plan: OwnPlan, wall: float | None = None) -> None:
    """Raise ``RequestError`` if rooms are not a plan. ``wall``: thickness of the drawing's walls, metres."""
    thick = wall or 0.0
    for fault in _covers(plan):
        raise RequestError(f"plan: {fault}")
    for fault in chain(_overlaps(plan, thick), _apart(plan, thick), _gaps(plan)):
        hint = HINT_OF_WALLS if wall is not None else HINT
        more, which = figure(fault.off + 0.001, digits=3), TOLERANCE < fault.off < fault.snap - 0.001
        by_snap = f" (--snap {more} merges these walls)" if which and wall is None else ""
        raise RequestError(f"plan: {fault.said}{by_snap}: {hint}")
    for fault in _misplaced(plan):
        raise RequestError(f"plan: {fault}")


def _covers(plan: OwnPlan) -> Iterator[str]:
    """Yield a message for each room that is drawn twice, and for each outline that is drawn as a room."""
    for room in plan.rooms:
        held = [each for each in plan.rooms if each is not room and _within(each.box, room.box)]
        if same := next((each.name for each in held if _within(room.box, each.box)), ""):
            yield f"{room.name} and {same} are the same rectangle: leave one of them out"
        elif held:
            names = ", ".join(each.name for each in held[:3])
            more = f" and {len(held) - 3} more" if len(held) > 3 else ""
            yield f"{room.name} has {names}{more} within it: if it is an outline, not a room, leave it out"


def _within(inner: Box, outer: Box) -> bool:
    west, north, east, south = (a - b for a, b in zip(inner, outer, strict=True))
    return min(west, north) >= -TOLERANCE and max(east, south) <= TOLERANCE


def _overlaps(plan: OwnPlan, wall: float) -> Iterator[Fault]:
    for one, other in combinations(plan.rooms, 2):
        if (depth := overlap(one.box, other.box)) > TOLERANCE:
            drawn = depth - wall if depth > wall + TOLERANCE else depth
            yield Fault(f"{one.name} overlaps {other.name} by {figure(drawn, digits=3)} m", depth)


def _apart(plan: OwnPlan, wall: float) -> Iterator[Fault]:
    """Yield the room nearest to the first room's group of those that no chain of shared walls joins to it."""
    reached, waiting = {0}, [0]
    while waiting:
        number = waiting.pop()
        new = {wall.behind for wall in plan.walls if wall.room == number and wall.behind is not None}
        waiting += new - reached
        reached |= new
    boxes = [shapely.box(*room.box) for room in plan.rooms]
    others = [number for number in range(len(plan.rooms)) if number not in reached]
    if others:
        pairs = ((shapely.distance(boxes[a], boxes[b]), a, b) for a in others for b in sorted(reached))
        off, room, nearest = min(pairs)
        name, first = plan.rooms[room].name, plan.rooms[0].name
        near = f", {figure(off + wall, digits=3)} m off" if off > TOLERANCE else ""
        if len(reached) > 1:
            near = f", the nearest of which is {plan.rooms[nearest].name}{near}"
        yield Fault(f"{name} shares no wall with the rooms around {first}{near}", off, MOST_SNAP)


def _gaps(plan: OwnPlan) -> Iterator[Fault]:
    """Yield the gaps between rooms, by the same function as ``check``."""
    for gap in shapely.get_parts(gaps(House(plan.rooms, (), ()))):
        if gap.area > 1e-4:
            west, north, east, south = gap.bounds
            wide = min(east - west, south - north)
            around = [room.name for room in plan.rooms if shapely.box(*room.box).distance(gap) < 1e-4]
            size = f"{figure(gap.area)} m² between {', '.join(around)} belong to no room"
            yield Fault(f"{size}, {figure(wide, digits=3)} m wide", wide)


def _misplaced(plan: OwnPlan) -> Iterator[str]:
    """Yield a message for each opening in no wall of its rooms, and for a second door between two rooms."""
    joined: set[frozenset[str]] = set()
    for door in plan.doors:
        one, other = door.between
        if unknown := {one, other} - {OUTSIDE, *(room.name for room in plan.rooms)}:
            yield f"a door names {min(unknown)}, and there is no such room"
        elif plan.wall_of(door) is None:
            yield f"the door between {one} and {other} is not in a wall that they share"
        if frozenset(door.between) in joined and not door.is_entrance:
            yield f"there are two doors between {one} and {other}: keep one of them"
        joined.add(frozenset(door.between))
    for window in plan.windows:
        if plan.wall_around(window) is None:
            yield f"a window of {window.room} at x {window.x:g}, y {window.y:g} is not in one of its walls"
