"""The independent check: whether a house keeps its promises, in plain geometry.

It reads coordinates alone and shares nothing with the rules that made the house. What it judges by is data:
the promises of a grammar travel with its houses, those of the shipped ones stand in ``promises.json`` too.
"""

import math
from collections import Counter
from collections.abc import Iterator
from itertools import combinations

import msgspec
import shapely

from logic.checking.figures import apart, figure, number, percent
from logic.checking.least_main_room import side_of
from logic.checking.room import arrangement_violations, count_violations, front_violations, size_violations
from logic.checking.shared_walls import plan_doors, plan_rooms, plan_units, plan_windows
from logic.checking.star import star_doors, star_main_room, star_rooms, star_sides
from logic.checking.walk import (
    doorway,
    first_room,
    first_space,
    free_floor,
    joins_all,
    places_inside,
    spaces,
    swept,
)
from logic.house.boxes import BACK, TOLERANCE, WALLS, distance, excess, front, overlap, walls_touched
from logic.house.house import House
from logic.house.parts import BODY, ORIGINAL, OUTSIDE, Door, Room
from logic.house.promises import FRONTAL, Promises

REACHABLE = 0.6
"""The least share of a room's free floor that the body reaches from the room's doors."""
SLIVER = 1e-4
"""Square metres: where a square's centre has less room than this, the square only just fits: no spot."""


def violations(house: House, promises: Promises) -> list[str]:
    """What a house breaks of these promises, in words, each with its room, pieces and lengths.

    What is asked of the rooms and doors together depends on the topology: of a star by ``star.py``, of all
    others by ``shared_walls.py``. The original's houses are judged by the paper's constraints: furniture
    keeps clear of a door in front of it and behind it, not beside it, and rooms may be empty. They do not
    promise where a front faces, how wide passages are, nor the least area of the main room.
    """
    cell = house.provenance.request.get("cell", 0.0) if house.provenance else 0.0
    if cell:
        promises = _on_grid(promises, cell)
    grid = _off_grid(house, cell) if cell else ()
    inside = (line for room in house.counted for line in _furniture(house, room, promises))
    if house.is_star:
        return [
            *grid,
            *star_doors(house, promises),
            *star_rooms(house, promises),
            *_area(house, promises),
            *_types(house, promises),
            *star_sides(house, promises),
            *inside,
            *_walking(house, max(promises.passage, SLIVER)),
            *star_main_room(house, promises),
        ]
    return [
        *grid,
        *plan_rooms(house, promises),
        *_area(house, promises),
        *plan_doors(house, promises),
        *plan_units(house, promises),
        *plan_windows(house, promises),
        *_types(house, promises),
        *inside,
        *_walking(house, max(promises.passage, SLIVER)),
    ]


def _on_grid(promises: Promises, cell: float) -> Promises:
    """What is promised of a house on a grid: fixed lengths, and least ones, in whole cells."""

    def up(length: float) -> float:
        return math.ceil(length / cell - TOLERANCE) * cell

    def down(length: float) -> float:
        return math.floor(length / cell + TOLERANCE) * cell

    door = None if promises.door_width is None else up(promises.door_width)
    gap = None if promises.room_gap is None else up(promises.room_gap)
    rooms, pieces = (
        {
            name: (up(a), max(up(a), down(aa)), up(b), max(up(b), down(bb)))
            for name, (a, aa, b, bb) in sizes.items()
        }
        for sizes in (promises.room_size, promises.piece_size)
    )
    clearance = up(promises.door_clearance)
    # A side is rounded by itself, so a share of the room's and an area are not kept to.
    rounded = {"room_size": rooms, "piece_size": pieces, "shares": {}, "tops": {}}
    return msgspec.structs.replace(
        promises, door_width=door, door_clearance=clearance, room_gap=gap, **rounded
    )


def _off_grid(house: House, cell: float) -> Iterator[str]:
    """Edges that do not lie on the grid of a star's main room's corner, or of the corner of the outline."""
    corners = [(house.main.x, house.main.y)] if house.is_star else [room.box[:2] for room in house.rooms]
    origins = tuple(map(min, zip(*corners, strict=True))) * 2
    for room in house.counted:
        parts = [("the room", room), *(("its door", door) for door in house.doors_of(room.name))]
        parts += (("its window", window) for window in house.windows if window.room == room.name)
        parts += zip(_piece_names(room), room.pieces, strict=True)
        for name, rect in parts:
            for edge, origin in zip(rect.box, origins, strict=True):
                off = abs((edge - origin) / cell - round((edge - origin) / cell)) * cell
                if off > TOLERANCE:
                    off_it = figure(off, digits=3)
                    yield f"{_name(room)}: {name} stands {off_it} m off the grid of {number(cell)} m"
                    break
    if not house.is_star:
        return
    for size, name in ((house.main.width, "wide"), (house.main.height, "deep")):
        if abs(size / cell - round(size / cell)) * cell > TOLERANCE:
            text = apart(
                size, digits=3, holds=lambda read: abs(read / cell - round(read / cell)) * cell > 1e-7
            )[0]
            yield f"main room: is {text} m {name}, not whole cells of {number(cell)} m"


def _area(house: House, promises: Promises) -> Iterator[str]:
    if promises.house_area:
        least, most = promises.house_area
        whole = sum(room.area for room in house.rooms)
        if not least - TOLERANCE <= whole <= most + TOLERANCE:
            area = figure(whole, least, most)
            yield f"house: is of {area} m² ({number(least)} to {number(most)})"


def _types(house: House, promises: Promises) -> Iterator[str]:
    types = Counter(room.type for room in house.counted)
    for room in house.counted:
        if promises.counts and room.type not in promises.counts:
            yield f"{_name(room)} is none of the room types ({', '.join(promises.counts)})"
    basic = sum(types[kind] for kind in promises.basic)
    if promises.basic and basic < 2 <= types.total():
        yield f"house: has {basic} rooms of the basic types (at least 2 of {', '.join(promises.basic)})"
    if types.total() >= len(promises.basic):
        for kind in promises.basic:
            if not types[kind]:
                yield f"house: has no {kind} (at least 1 from {len(promises.basic)} rooms on)"


def _furniture(house: House, room: Room, promises: Promises) -> Iterator[str]:
    place, names = _name(room), _piece_names(room)
    original = house.topology == ORIGINAL
    if house.is_star and not room.pieces and room.type not in promises.empty and not original:
        yield f"{place}: has no furniture"
    for piece, name in zip(room.pieces, names, strict=True):
        if not promises.suits(room.type, piece.type):
            yield f"{place}: {name} does not suit the room"
        juts = excess(piece.box, room.box)
        if juts > TOLERANCE:
            yield f"{place}: {name} juts {figure(juts)} m out of the room"
        # Rooms that share walls stand back to back: what is near to others' doors is behind a wall.
        for door in house.doors if house.is_star else house.doors_of(room.name):
            away = distance(piece.box, door.box)
            whose = "its door" if room.name in door.between else f"the door of {_owner(house, door)}"
            if original:
                if overlap(piece.box, front(door.box, FRONTAL)) > TOLERANCE:
                    yield f"{place}: {name} {_stands(away, 'in front of', whose, FRONTAL)}"
            elif away < promises.door_clearance - TOLERANCE:
                yield f"{place}: {name} {_stands(away, 'from', whose, promises.door_clearance)}"
        if piece.type in promises.at_wall and not walls_touched(piece, room):
            yield f"{place}: {name} stands in the middle of the room (must touch a wall)"
    for (one, a), (other, b) in combinations(zip(room.pieces, names, strict=True), 2):
        depth = overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield f"{place}: {a} overlaps {b} by {figure(depth)} m"
    if house.topology != ORIGINAL:
        yield from _fronts(room, place, names, promises)
        side = side_of(house.star, house.star.rooms[house.secondary.index(room)]) if house.is_star else ""
        found = [
            *size_violations(room, side, names, promises),
            *count_violations(room, promises),
            *arrangement_violations(room, names, promises),
            *front_violations(room, names, promises),
        ]
        yield from (f"{place}: {line}" for line in found)


def _fronts(room: Room, place: str, names: list[str], promises: Promises) -> Iterator[str]:
    """A piece at a wall has its back to it, or a side if it turns; children turn to their parent."""
    for piece, name in zip(room.pieces, names, strict=True):
        if piece.orientation not in {"", *BACK}:
            yield f"{place}: {name} faces {piece.orientation!r} (must be N, E, S, W or empty)"
        elif piece.orientation and piece in room.children:
            walls = walls_touched(piece, room)
            back = BACK[piece.orientation]
            sides = (
                {back, (back + 1) % 4, (back + 3) % 4}
                if promises.turns is None or piece.type in promises.turns
                else {back}
            )
            if walls and not sides & set(walls):
                at = " and ".join(WALLS[wall] for wall in walls)
                yield f"{place}: {name} faces {piece.orientation}, not away from its wall ({at})"


def _walking(house: House, passage: float) -> Iterator[str]:
    bodies, squares = spaces(house, BODY), spaces(house, passage)
    main, first = first_space(house, bodies, BODY), first_room(house)
    start = "the main room" if house.is_star else _name(first)
    covered = [(space, swept(space, BODY)) for space in bodies]
    for room in house.counted:
        place, doors = _name(room), house.doors_of(room.name)
        if not main.intersects(places_inside(room, BODY)):
            yield f"{place}: the body ({BODY} m square) cannot get into it from {start}"
            continue
        if house.topology == ORIGINAL:
            continue
        free = free_floor(room)
        by_body, by_square = ([doorway(door, side) for door in doors] for side in (BODY, passage))
        ways, wide = shapely.union_all(by_body), shapely.union_all(by_square)
        reached = shapely.union_all([floor for space, floor in covered if space.intersects(ways)])
        share = reached.intersection(free).area / free.area
        its = "its door" if len(doors) == 1 else "its doors"
        if share < REACHABLE:
            reach = f"{percent(share, REACHABLE)} of its free floor from {its}"
            yield f"{place}: the body reaches {reach} (at least {percent(REACHABLE)})"
        closed = [space for space in squares if space.intersection(free).area > SLIVER]
        closed = [space for space in closed if not space.intersects(wide)]
        if closed:
            area = shapely.union_all([swept(space, passage) for space in closed]).intersection(free).area
            behind = f"{figure(area)} m² of its floor lie"
            yield f"{place}: {behind} behind passages narrower than {number(passage)} m"
        elif not joins_all(room, by_square, squares):
            yield f"{place}: no passage of {number(passage)} m joins its doors inside it"


def _stands(away: float, where: str, whose: str, least: float) -> str:
    """How near something stands to a door, and how near it may."""
    return f"stands {figure(away, least)} m {where} {whose} (at least {number(least)})"


def _name(room: Room) -> str:
    return f"{room.name} ({room.type})"


def _owner(house: House, door: Door) -> str:
    """The room that a door is named by: the first that is not the hub of a star."""
    names = [name for name in door.between if name != OUTSIDE and not (house.is_star and name == house.hub)]
    return _name(house.room(names[0]))


def _piece_names(room: Room) -> list[str]:
    """The type of each piece, numbered where a room has several of it."""
    total = Counter(piece.type for piece in room.pieces)
    seen: Counter[str] = Counter()
    names = []
    for piece in room.pieces:
        seen[piece.type] += 1
        names.append(f"{piece.type} {seen[piece.type]}" if total[piece.type] > 1 else piece.type)
    return names
