"""What the check asks of a house that is no star: rooms that tile its outline, doors in walls that two of
them share, an entrance, and windows in outer walls.
"""

from collections.abc import Collection, Iterator
from itertools import combinations, pairwise
from typing import Any, Generic, TypeVar

import numpy as np
import shapely

from logic.checking.fault import Fault
from logic.checking.figures import figure, number
from logic.checking.names import named
from logic.checking.room import out_of
from logic.house.boxes import TOLERANCE, Box, is_on_wall, overlap
from logic.house.house import House
from logic.house.parts import OUTSIDE, Door, Rect, Room, Window
from logic.house.promises import PASSAGE, Promises
from logic.spelling import article, numbered

T = TypeVar("T", bound=Rect)

COURT = 1.0
"""Metres: no court between rooms is narrower."""

BEFORE = 0.3
"""Metres: what stands nearer before a window hides it."""


def plan_rooms(house: House, promises: Promises) -> Iterator[Fault]:
    """Rooms that overlap, leave a gap, lie apart, or have another area or shape than promised."""
    between = 2 * house.half_wall
    for one, other in combinations(house.rooms, 2):
        depth = overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield Fault(f"{named(one)} overlaps {named(other)} by {figure(depth)} m", (one.name, other.name))
        elif depth + between > TOLERANCE:
            near = f"is {figure(max(0.0, -depth), between)} m from {named(other)}"
            yield Fault(f"{named(one)} {near} (walls are {number(between)} m thick)", (one.name, other.name))
    yield from _other_walls(house, promises)
    if (parts := shapely.get_num_geometries(_floor(house))) > 1:
        yield Fault(f"house: its rooms lie in {parts} parts that do not touch")
    if (gap := _filled(house, promises.courts)) > 1e-3:
        yield Fault(f"house: {figure(gap)} m² between its rooms are no room's")
    for room in house.rooms:
        for said in (_area_violations(room, promises), _size_violations(room, promises)):
            yield from (Fault(named(room) + each, (room.name,)) for each in said)


def _other_walls(house: House, promises: Promises) -> Iterator[Fault]:
    """Walls of another thickness than promised."""
    wanted, has = promises.wall_thickness, house.wall_thickness
    for kind in ("inner", "outer") if wanted else ():
        least, thick = getattr(wanted, kind), getattr(has, kind) if has else 0.0
        if abs(thick - least) > TOLERANCE:
            yield Fault(
                f"house: its {kind} walls are {figure(thick, least)} m thick (must be {number(least)})"
            )


def _area_violations(room: Room, promises: Promises) -> Iterator[str]:
    """An area out of its bounds, or a room that is too narrow."""
    least, most = promises.room_area.get(room.type, (0.0, room.area))
    if not least - TOLERANCE <= room.area <= most + TOLERANCE:
        area = figure(room.area, least, most)
        yield f" is of {area} m² ({number(least)} to {number(most)})"
    side, narrowest = min(room.width, room.height), promises.narrowest.get(room.type, 0.0)
    if side < narrowest - TOLERANCE:
        width = figure(side, narrowest, digits=3)
        yield f" is {width} m wide at its shorter side (at least {number(narrowest)})"


def _size_violations(room: Room, promises: Promises) -> Iterator[str]:
    """A size out of its bounds, whichever of its sides is the width."""
    bounds = promises.room_size.get(room.type), promises.room_relations.get(room.type, ())
    ways = [
        list(out_of("it", *sides, *bounds))
        for sides in ((room.width, room.height), (room.height, room.width))
    ]
    yield from (f": {line}" for line in min(ways, key=len))


def gaps(house: House) -> Any:
    """What squares as wide as a passage close between rooms: courtyards of any size, and slits."""
    floor = _floor(house)
    hulls = [shapely.Polygon(part.exterior) for part in shapely.get_parts(floor)]
    closed = shapely.union_all(hulls).buffer(PASSAGE / 2, join_style="mitre")
    return closed.buffer(-PASSAGE / 2, join_style="mitre").difference(floor)


def _filled(house: House, courts: int) -> float:
    """Of how many square metres between its rooms a house has none, but for so many courts."""
    free = gaps(house)
    half = COURT / 2 - TOLERANCE
    wide = free.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    parts = sorted((part.area for part in shapely.get_parts(wide)), reverse=True)
    return free.area - sum(parts[:courts])


def _floor(house: House) -> Any:
    grown = [shapely.box(*room.box).buffer(TOLERANCE, join_style="mitre") for room in house.tiles]
    return shapely.union_all(grown)


def plan_doors(house: House, promises: Promises) -> Iterator[Fault]:
    """Doors that are too narrow, on no wall that both rooms share, or not as the grammar lets rooms open."""
    rooms = {room.name: room for room in house.tiles}
    tiles, openings, gardens = _Rects(rooms.values()), _Rects(house.doors), {*house.garden_doors}
    for door in house.doors:
        name, names = _between(house, door), _joined(door)
        joined = [rooms[each] for each in names]
        one, other = (rooms[each].type if each in rooms else OUTSIDE for each in door.between)
        least = promises.least_door(one, other)
        least = PASSAGE if least is None else least
        if door.length < least - TOLERANCE:
            width = figure(door.length, least, digits=3)
            yield Fault(f"{name}: is {width} m wide (at least {number(least)})", names)
        if len(joined) == 1:
            yield from _not_outer(house, tiles, door, joined[0], f"{name}:")
        elif not _is_shared(door, *joined):
            yield Fault(f"{name}: is not on a wall that they share", names)
        if (
            promises.opens
            and door not in gardens
            and not (other in promises.opens.get(one, ()) or one in promises.opens.get(other, ()))
        ):
            yield Fault(f"{name}: {one} and {other} do not open into each other", names)
        if (promises.openings or promises.parts) and door.opening and not promises.are_open(one, other):
            yield Fault(f"{name}: has no leaf (must have one)", names)
    leafless = np.array([door.opening for door in house.doors])
    for index, one in enumerate(house.doors):
        meet = openings.met_by(one)
        if one.opening:  # Another wall may begin at the end of an opening.
            meet &= ~leafless | (openings.shared(one.box) > TOLERANCE)
        for other in openings.where(meet, index + 1):
            text = f"{_between(house, one)}: meets the {_between(house, other)}"
            yield Fault(text, _joined(one) + _joined(other))
    if promises.entrance and not any(door.is_entrance for door in house.doors):
        yield Fault("house: has no door to the outside")


def plan_corners(house: House, _: Promises) -> Iterator[Fault]:
    """Yield a fault for each door or window that reaches past a corner of its room into the wall across."""
    rooms = {room.name: room for room in house.rooms}
    windows = [
        (window, (window.room,), f"{named(rooms[window.room])}: {_window(window)}")
        for window in house.windows
    ]
    doors = [(door, _joined(door), f"{_between(house, door)}:") for door in house.doors]
    for opening, names, its in (*doors, *windows):
        k = _along(opening)
        ends = [(rooms[name].box[k], rooms[name].box[k + 2]) for name in names]
        juts = max(max(start - opening.box[k], opening.box[k + 2] - end) for start, end in ends)
        # An opening that reaches farther is on no wall of the room.
        if TOLERANCE < juts <= house.half_wall + TOLERANCE:
            yield Fault(f"{its} reaches {figure(juts)} m into the wall across", names)


def plan_degrees(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for each room with too many or too few doors to other rooms."""
    ends = {OUTSIDE, *(room.name for room in house.rooms if room.type in promises.public)}
    for room in house.rooms:
        if room.type in promises.degree:
            least, most = promises.degree[room.type]
            beyond = {name for door in house.doors_of(room.name) for name in door.between}
            count = len(beyond - ends - {room.name})
            if not least <= count <= most:
                text = (
                    f"{named(room)}: has doors to {numbered(count, 'other room')} (must be {least} to {most})"
                )
                yield Fault(text, (room.name,))


def plan_outline(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for a house, or for each of its units, of another size than promised."""
    if promises.house_size:
        for names in _units(house, promises) if promises.public else [{room.name for room in house.rooms}]:
            west, north, east, south = zip(*(house.room(name).box for name in names), strict=True)
            size = max(east) - min(west), max(south) - min(north)
            first = house.room(min(names, key=lambda each: (len(each), each)))
            its = f"{named(first)}: its unit" if promises.public else "house: it"
            for said in out_of(its, *size, None, promises.house_size):
                yield Fault(said, tuple(names) if promises.public else ())


def plan_parts(house: House, promises: Promises) -> Iterator[Fault]:
    """Parts of rooms behind a wall, or of rooms of other types; rooms that should be parts."""
    rooms = {room.name: room for room in house.rooms}
    for room in house.rooms:
        whole = rooms.get(room.part_of or "")
        wanted = promises.parts.get(room.type, ())
        if wanted and (whole is None or whole.type not in wanted):
            yield Fault(
                f"{named(room)}: is no part of a room (must be of a {' or '.join(wanted)})", (room.name,)
            )
        if not room.part_of and room.type in promises.whole_area:
            least, most = promises.whole_area[room.type]
            area = sum(part.area for part in house.parts(room))
            if not least - TOLERANCE <= area <= most + TOLERANCE:
                said = f"is of {figure(area, least, most)} m² with its parts"
                yield Fault(f"{named(room)}: {said} ({number(least)} to {number(most)})", (room.name,))
        if whole is None:
            continue
        joints = [door for door in house.doors if {*door.between} == {room.name, whole.name}]
        shared, length = (
            _wall(room.box, whole.box, 2 * house.half_wall),
            sum(door.length for door in joints if door.opening),
        )
        if abs(length - shared) > TOLERANCE or not joints:
            said = f"of {figure(shared, length, digits=3)} m of wall {number(length)} are open (must be all)"
            yield Fault(f"{named(room)}: is a part of {whole.name}, and {said}", (room.name, whole.name))


def plan_sizes(house: House, promises: Promises) -> Iterator[Fault]:
    """Rooms that are of another size than those of their type before them, in the house or in their unit."""
    for unit in _units(house, promises) if promises.public else [{room.name for room in house.rooms}]:
        of_unit = [room for room in house.rooms if room.name in unit]
        types = {room.type for room in of_unit}
        for type_, turned in promises.same_size.items():
            rooms = [room for room in of_unit if room.type == type_] if type_ in types else []
            for one, other in pairwise(rooms):
                a, b = (
                    sorted(size) if turned else list(size)
                    for size in ((one.width, one.height), (other.width, other.height))
                )
                if max(abs(x - y) for x, y in zip(a, b, strict=True)) > TOLERANCE:
                    size, wanted = (f"{x:.3f} m by {y:.3f} m" for x, y in (b, a))
                    text = f"{named(other)}: is {size}, {named(one)} {wanted} (must be the same)"
                    yield Fault(text, (one.name, other.name))


def _units(house: House, promises: Promises) -> Iterator[set[str]]:
    """The names of rooms that doors join, public rooms left out."""
    public = {room.name for room in house.rooms if room.type in promises.public}
    ends = {OUTSIDE, *public}
    left = {room.name for room in house.rooms} - public
    while left:
        unit, new = set(), {min(left)}
        while new:
            unit |= new
            joined = [door.between for door in house.doors if unit & {*door.between}]
            new = {name for names in joined for name in names} - unit - ends
        left -= unit
        yield unit


def plan_units(house: House, promises: Promises) -> Iterator[Fault]:
    """Units that are entered from no public room, by several doors, or from outside."""
    ends = {OUTSIDE, *(room.name for room in house.rooms if room.type in promises.public)}
    for unit in _units(house, promises) if promises.public else ():
        doors = [door for door in house.doors if unit & {*door.between} and ends & {*door.between}]
        room = house.room(min(unit, key=lambda each: (len(each), each)))
        its = f"{named(room)}: its unit is entered"
        if len(doors) != 1:
            yield Fault(f"{its} by {numbered(len(doors), 'door')} (must be one)", (room.name,))
        elif doors[0].is_entrance:
            yield Fault(f"{its} from outside (must be from a public room)", (room.name,))


def plan_windows(house: House, promises: Promises) -> Iterator[Fault]:
    """Windows in no outer wall, over a door or another window, behind furniture; rooms that lack one."""
    rooms = {room.name: room for room in house.tiles}
    tiles, doors, windows = _Rects(rooms.values()), _Rects(house.doors), _Rects(house.windows)
    for index, window in enumerate(house.windows):
        room = rooms[window.room]
        name = f"{named(room)}: {_window(window)}"
        yield from _not_outer(house, tiles, window, room, name, promises.outdoor)
        for kind, meet in (
            ("a door", doors.met_by(window)),
            ("another window", windows.met_by(window)[:index]),
        ):
            if meet.any():
                yield Fault(f"{name} meets {kind}", (room.name,))
        for piece in room.pieces:
            if (
                piece.type in promises.hides
                and overlap(_before(window, house.half_wall), piece.box) > TOLERANCE
            ):
                yield Fault(f"{name} is behind {article(piece.type)}", (room.name,))
    lit = {window.room for window in house.windows}
    outside = {room.name for room in house.rooms if room.type in promises.outdoor}
    by_doors = {name for door in house.doors if outside & {*door.between} for name in door.between}
    by_doors |= {name for door in house.garden_doors for name in door.between}
    for room in house.rooms:
        if room.type in promises.lit and room.name not in lit | by_doors | outside:
            yield Fault(f"{named(room)}: has no window", (room.name,))
        if room.name in outside & lit:
            yield Fault(f"{named(room)}: has a window, and is outside", (room.name,))
        if room.name in outside and not _at_outer_wall(house, tiles, room):
            yield Fault(f"{named(room)}: has no outer wall, and is outside", (room.name,))


class _Rects(Generic[T]):
    """Rectangles that NumPy compares with one rectangle, all at once."""

    def __init__(self, rects: Collection[T]) -> None:
        self._rects = [*rects]
        self._boxes = np.array([rect.box for rect in rects], float).reshape(-1, 4)
        self._along = np.array([_along(rect) for rect in rects])

    def where(self, mask: Any, first: int = 0) -> Iterator[T]:
        """Yield the rectangles that a mask (N,) selects, from index ``first`` on."""
        yield from (self._rects[index] for index in np.flatnonzero(mask[first:]) + first)

    def apart(self, box: Box) -> np.ndarray:
        """Return the gap from each to a box along x and y (N, 2), metres; negative where they overlap."""
        return np.maximum(self._boxes[:, :2] - box[2:], np.subtract(box[:2], self._boxes[:, 2:]))

    def met_by(self, opening: Rect) -> np.ndarray:
        """Return which of these openings (N,) touch or overlap another opening in its wall."""
        away = np.hypot(*self.apart(opening.box).clip(0).T)
        return (away <= TOLERANCE) & (self._along == _along(opening))

    def shared(self, segment: Box) -> np.ndarray:
        """Return the length of a segment in each or on its boundary (N,), metres; negative where apart."""
        along, across = (
            np.minimum(segment[k + 2], self._boxes[:, k + 2]) - np.maximum(segment[k], self._boxes[:, k])
            for k in ((0, 1) if segment[2] - segment[0] > segment[3] - segment[1] else (1, 0))
        )
        return np.where(across >= -TOLERANCE, along, across)


def _at_outer_wall(house: House, tiles: _Rects[Room], room: Room) -> bool:
    """Whether no other room is behind a part of the room's boundary."""
    whole = room.grown(house.half_wall).box
    beside = tiles.where((tiles.apart(whole) <= PASSAGE).all(axis=1))
    others = shapely.union_all([shapely.box(*other.box) for other in beside if other.name != room.name])
    border = shapely.box(*whole).exterior
    return border.difference(others.buffer(TOLERANCE, join_style="mitre")).length > PASSAGE


def _is_shared(door: Door, one: Room, other: Room) -> bool:
    """Whether a door lies on a wall of one room that is also the facing wall of the other."""
    return any(is_on_wall(door, one, wall) and is_on_wall(door, other, (wall + 2) % 4) for wall in range(4))


def _not_outer(
    house: House, tiles: _Rects[Room], opening: Rect, room: Room, name: str, outdoor: Collection[str] = ()
) -> Iterator[Fault]:
    """Why an opening of a room, of this name, does not lead outside, or to a room of the types that are."""
    if not any(is_on_wall(opening, room, wall) for wall in range(4)):
        yield Fault(f"{name} is not on a wall of the room", (room.name,))
    entered = tiles.where(tiles.shared(opening.box) > TOLERANCE)
    into = [other for other in entered if other.name != room.name]
    for other in into:
        if other.type not in outdoor:
            yield Fault(f"{name} leads into {named(other)}, not outside", (room.name, other.name))
    if house.wall_thickness and not into:
        outside = house.wall_thickness.outer - house.half_wall
        before = _outside(opening, room, outside)
        for other in tiles.where((tiles.apart(before) <= outside).all(axis=1)):
            if other.name != room.name and overlap(other.grown(outside).box, before) > TOLERANCE:
                yield Fault(f"{name} is behind an outer wall of {named(other)}", (room.name, other.name))


def _outside(opening: Rect, room: Room, off: float) -> Box:
    """A centimetre of the outside before an opening of a room, so far off (m), where its wall ends."""
    box, axis = [*opening.box], 1 - _along(opening)
    way = 1 if box[axis] > (room.box[axis] + room.box[axis + 2]) / 2 else -1
    ends = sorted((box[axis] + way * off, box[axis] + way * (off + 0.01)))
    box[axis], box[axis + 2] = ends
    return box[0], box[1], box[2], box[3]


def _wall(one: Box, other: Box, thickness: float) -> float:
    """How much wall of this thickness two rooms share, metres; 0 where they share none."""
    spans = [min(one[k + 2], other[k + 2]) - max(one[k], other[k]) for k in (0, 1)]
    return max(*spans, 0.0) if abs(min(spans) + thickness) <= TOLERANCE else 0.0


def _along(opening: Rect) -> int:
    """The axis that an opening runs along: 0 for x, 1 for y."""
    return int(opening.height > opening.width)


def _before(window: Window, half: float) -> Box:
    """What is before a window and behind it, in a wall of which half is so thick, metres."""
    west, north, east, south = window.box
    by_x, by_y = (BEFORE + half, 0.0) if _along(window) else (0.0, BEFORE + half)
    return west - by_x, north - by_y, east + by_x, south + by_y


def _joined(door: Door) -> tuple[str, ...]:
    """The names of the rooms that a door leads into."""
    return tuple(name for name in door.between if name != OUTSIDE)


def _window(window: Window) -> str:
    return f"its window at ({window.x:.2f}, {window.y:.2f})"


def _between(house: House, door: Door) -> str:
    names = (named(house.room(name)) if name != OUTSIDE else OUTSIDE for name in door.between)
    return f"door between {' and '.join(names)}"
