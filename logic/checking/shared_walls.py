"""Checks of houses whose rooms share walls.

The rooms tile the outline, in the promised numbers, sizes and units.
"""

from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import Any

import shapely

from vitruvius.logic.checking.fault import Fault
from vitruvius.logic.checking.figures import figure, number
from vitruvius.logic.checking.names import named
from vitruvius.logic.checking.room import out_of
from vitruvius.logic.house.boxes import TOLERANCE, Box, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Room
from vitruvius.logic.house.promises import PASSAGE, Promises
from vitruvius.logic.spelling import numbered

MIN_COURT_M = 1.0
"""Least width of a court between rooms, metres."""


def plan_rooms(house: House, promises: Promises) -> Iterator[Fault]:
    """Yield a fault for rooms that overlap, leave a gap or lie apart, and for a wrong area or shape."""
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
    """Yield a fault for walls of another thickness than promised."""
    wanted, has = promises.wall_thickness, house.wall_thickness
    for kind in ("inner", "outer") if wanted else ():
        least, thick = getattr(wanted, kind), getattr(has, kind) if has else 0.0
        if abs(thick - least) > TOLERANCE:
            yield Fault(
                f"house: its {kind} walls are {figure(thick, least)} m thick (must be {number(least)})"
            )


def _area_violations(room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for an area out of its bounds, and for a room that is too narrow."""
    least, most = promises.room_area.get(room.type, (0.0, room.area))
    if not least - TOLERANCE <= room.area <= most + TOLERANCE:
        area = figure(room.area, least, most)
        yield f" is of {area} m² ({number(least)} to {number(most)})"
    side, narrowest = min(room.width, room.height), promises.narrowest.get(room.type, 0.0)
    if side < narrowest - TOLERANCE:
        width = figure(side, narrowest, digits=3)
        yield f" is {width} m wide at its shorter side (at least {number(narrowest)})"


def _size_violations(room: Room, promises: Promises) -> Iterator[str]:
    """Yield a text for a size out of its bounds, with either side of the room as its width."""
    bounds = promises.room_size.get(room.type), promises.room_relations.get(room.type, ())
    ways = [
        list(out_of("it", *sides, *bounds))
        for sides in ((room.width, room.height), (room.height, room.width))
    ]
    yield from (f": {line}" for line in min(ways, key=len))


def gaps(house: House) -> Any:
    """Return the area between rooms that no square as wide as a passage can leave: courts and slits."""
    floor = _floor(house)
    hulls = [shapely.Polygon(part.exterior) for part in shapely.get_parts(floor)]
    closed = shapely.union_all(hulls).buffer(PASSAGE / 2, join_style="mitre")
    return closed.buffer(-PASSAGE / 2, join_style="mitre").difference(floor)


def _filled(house: House, courts: int) -> float:
    """Return the area between rooms that belongs to no room, without the largest ``courts`` courts, m²."""
    free = gaps(house)
    half = MIN_COURT_M / 2 - TOLERANCE
    wide = free.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    parts = sorted((part.area for part in shapely.get_parts(wide)), reverse=True)
    return free.area - sum(parts[:courts])


def _floor(house: House) -> Any:
    grown = [shapely.box(*room.box).buffer(TOLERANCE, join_style="mitre") for room in house.tiles]
    return shapely.union_all(grown)


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
    """Yield a fault for each wrong part of a room, and for each room that should be a part.

    A part is wrong if it lies behind a wall or belongs to a room of another type.
    """
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
    """Yield a fault for each room whose size differs from the previous room of its type.

    The comparison is within the house, or within the unit if the house has public rooms.
    """
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
    """Yield the names of the rooms of each unit, which doors join without public rooms."""
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
    """Yield a fault for each unit that is entered from no public room, by several doors, or from outside."""
    ends = {OUTSIDE, *(room.name for room in house.rooms if room.type in promises.public)}
    for unit in _units(house, promises) if promises.public else ():
        doors = [door for door in house.doors if unit & {*door.between} and ends & {*door.between}]
        room = house.room(min(unit, key=lambda each: (len(each), each)))
        its = f"{named(room)}: its unit is entered"
        if len(doors) != 1:
            yield Fault(f"{its} by {numbered(len(doors), 'door')} (must be one)", (room.name,))
        elif doors[0].is_entrance:
            yield Fault(f"{its} from outside (must be from a public room)", (room.name,))


def _wall(one: Box, other: Box, thickness: float) -> float:
    """Return the length of the wall of this thickness between two rooms, metres; 0 if they share none."""
    spans = [min(one[k + 2], other[k + 2]) - max(one[k], other[k]) for k in (0, 1)]
    return max(*spans, 0.0) if abs(min(spans) + thickness) <= TOLERANCE else 0.0
