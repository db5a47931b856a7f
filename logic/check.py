"""The independent check: whether a house keeps its promises, in plain geometry.

It reads coordinates alone and shares nothing with the rules that made the house. The lengths here hold
for houses of every grammar; what a shipped grammar promises beyond them stands in ``promises.json``.
"""

import math
from collections import Counter
from collections.abc import Iterator
from itertools import combinations

import msgspec
import shapely

from logic.boxes import BACK, TOLERANCE, WALLS, distance, excess, is_on_wall, overlap, walls_touched
from logic.house import BODY, FORMAT, House, Room
from logic.least_main_room import ELONGATION, least_area, side_of
from logic.promises import (
    PROMISES,
    Promises,
    arrangement_violations,
    count_violations,
    front_violations,
    size_violations,
)
from logic.walk import free_floor, main_space, places_inside, spaces, swept

CLEARANCE = 0.45
"""Metres: nothing stands nearer to a door, on either side of its wall."""
PASSAGE = 0.42
"""Metres: the least width of a passage (the body measures 0.394 m on the diagonal)."""
REACHABLE = 0.6
"""The least share of a room's free floor that the body reaches from the room's door."""
SLIVER = 1e-4
"""Square metres: where a square's centre has less room than this, the square only just fits: no spot."""
SPACIOUSNESS = 2.0
"""The most that the main room may be larger than the least main room that fits its rooms."""

DEFAULT = "original"
"""The promises of houses that name no grammar: the paper's constraints, whatever the sizes."""


def check(house: House, promises: Promises | None = None) -> list[str]:
    """Judge a house: ``[]``, or its violations in words, each with its room, pieces and lengths.

    Without ``promises`` the provenance decides: those of its grammar, if shipped, or of ``DEFAULT`` for
    houses that name no grammar (the original's among them). Two promises are those of our
    own files alone, for the original does not keep their words: where a front faces, and the least area
    of the main room.
    """
    if not isinstance(house, House):
        raise TypeError(
            f"check() takes one House, not {type(house).__name__}: logic.load(file) gives a list of them"
        )
    promises = promises or promises_of(house)
    cell = house.provenance.request.get("cell", 0.0) if house.provenance else 0.0
    if cell:
        promises = _on_grid(promises, cell)
    return [
        *(_off_grid(house, cell) if cell else ()),
        *_doors(house, promises),
        *_rooms(house, promises),
        *_types(house, promises),
        *(_sides(house, promises) if house.format == FORMAT else ()),
        *(line for index in range(len(house.rooms)) for line in _furniture(house, index, promises)),
        *_walking(house),
        *_main_room(house, promises),
    ]


def promises_of(house: House) -> Promises:
    """The promises of the house's grammar, as far as its name is that of a shipped one."""
    return PROMISES.get(house.provenance.grammar if house.provenance else DEFAULT, Promises())


def _on_grid(promises: Promises, cell: float) -> Promises:
    """What is promised of a house on a grid: fixed lengths, and least ones, in whole cells."""

    def up(length: float) -> float:
        return math.ceil(length / cell - TOLERANCE) * cell

    def down(length: float) -> float:
        return math.floor(length / cell + TOLERANCE) * cell

    door = None if promises.door is None else up(promises.door)
    gap = None if promises.room_gap is None else up(promises.room_gap)
    rooms, pieces = (
        {
            name: (up(a), max(up(a), down(aa)), up(b), max(up(b), down(bb)))
            for name, (a, aa, b, bb) in sizes.items()
        }
        for sizes in (promises.rooms, promises.pieces)
    )
    return msgspec.structs.replace(promises, door=door, room_gap=gap, rooms=rooms, pieces=pieces)


def _off_grid(house: House, cell: float) -> Iterator[str]:
    """Edges that do not lie on the grid of the main room's corner."""
    for index, room in enumerate(house.rooms):
        parts = [("the room", room), ("its door", room.door)]
        parts += zip(_piece_names(room), room.pieces, strict=True)
        for name, rect in parts:
            for edge, origin in zip(rect.box, (house.floor.x, house.floor.y) * 2, strict=True):
                off = abs((edge - origin) / cell - round((edge - origin) / cell)) * cell
                if off > TOLERANCE:
                    yield f"{_name(house, index)}: {name} stands {off:.3f} m off the grid of {cell:g} m"
                    break
    for size, name in ((house.floor.width, "wide"), (house.floor.height, "deep")):
        if abs(size / cell - round(size / cell)) * cell > TOLERANCE:
            yield f"main room: is {size:.3f} m {name}, not whole cells of {cell:g} m"


def _doors(house: House, promises: Promises) -> Iterator[str]:
    widths = [max(room.door.width, room.door.height) for room in house.rooms]
    for index, room in enumerate(house.rooms):
        wanted = widths[0] if promises.door is None else promises.door
        if abs(widths[index] - wanted) > TOLERANCE:
            yield f"{_name(house, index)}: its door is {widths[index]:.3f} m wide (must be {wanted:.3f})"
        if house.format == FORMAT:
            if side_of(house, room) is None:
                yield f"{_name(house, index)}: its door is not on a wall that it shares with the main room"
        elif not any(is_on_wall(room.door, room, wall) for wall in range(4)):
            yield f"{_name(house, index)}: its door is not on a wall of the room"


def _rooms(house: House, promises: Promises) -> Iterator[str]:
    slack = TOLERANCE * (house.floor.width + house.floor.height)
    for index, room in enumerate(house.rooms):
        depth = overlap(room.box, house.floor.box)
        if house.format == FORMAT and depth > TOLERANCE:
            yield f"{_name(house, index)} overlaps the main room by {depth:.2f} m"
        if room.area > house.floor.area + slack:
            yield (
                f"{_name(house, index)} is larger ({room.area:.2f} m²) "
                f"than the main room ({house.floor.area:.2f} m²)"
            )
    for one, other in combinations(range(len(house.rooms)), 2):
        depth = overlap(house.rooms[one].box, house.rooms[other].box)
        if depth > TOLERANCE:
            yield f"{_name(house, one)} overlaps {_name(house, other)} by {depth:.2f} m"
            continue
        apart = distance(house.rooms[one].box, house.rooms[other].box)
        if promises.room_gap is not None and house.format == FORMAT and apart < promises.room_gap - TOLERANCE:
            away = f"{apart:.2f} m from {_name(house, other)} (at least {promises.room_gap:g})"
            yield f"{_name(house, one)} stands {away}"


def _types(house: House, promises: Promises) -> Iterator[str]:
    types = Counter(room.type for room in house.rooms)
    for index, room in enumerate(house.rooms):
        if promises.counts and room.type not in promises.counts:
            yield f"{_name(house, index)} is none of the room types ({', '.join(promises.counts)})"
    basic = sum(types[kind] for kind in promises.basic)
    if promises.basic and basic < 2 <= types.total():
        yield f"house: has {basic} rooms of the basic types (at least 2 of {', '.join(promises.basic)})"
    if types.total() >= len(promises.basic):
        for kind in promises.basic:
            if not types[kind]:
                yield f"house: has no {kind} (at least 1 from {len(promises.basic)} rooms on)"


def _sides(house: House, promises: Promises) -> Iterator[str]:
    if promises.a_side is None or len(house.rooms) < 4:
        return
    most = len(house.rooms) // promises.a_side + 1
    for side, count in Counter(side_of(house, room) for room in house.rooms).items():
        if side and count > most:
            yield f"house: has {count} rooms on the {side} side (at most {most} of {len(house.rooms)})"


def _furniture(house: House, index: int, promises: Promises) -> Iterator[str]:
    room, place = house.rooms[index], _name(house, index)
    names = _piece_names(room)
    if not room.pieces:
        yield f"{place}: has no furniture"
    for piece, name in zip(room.pieces, names, strict=True):
        if not promises.suits(room.type, piece.type):
            yield f"{place}: {name} does not suit the room"
        juts = excess(piece.box, room.box)
        if juts > TOLERANCE:
            yield f"{place}: {name} juts {juts:.2f} m out of the room"
        for number, other in enumerate(house.rooms):
            away = distance(piece.box, other.door.box)
            if away < CLEARANCE - TOLERANCE:
                whose = "its door" if number == index else f"the door of {_name(house, number)}"
                yield f"{place}: {name} stands {away:.2f} m from {whose} (at least {CLEARANCE})"
        if piece.type in promises.at_wall and not walls_touched(piece, room):
            yield f"{place}: {name} stands in the middle of the room (must touch a wall)"
    for (one, a), (other, b) in combinations(zip(room.pieces, names, strict=True), 2):
        depth = overlap(one.box, other.box)
        if depth > TOLERANCE:
            yield f"{place}: {a} overlaps {b} by {depth:.2f} m"
    if house.format == FORMAT:
        yield from _fronts(room, place, names, promises)
        found = [
            *size_violations(room, side_of(house, room), names, promises),
            *count_violations(room, promises),
            *arrangement_violations(room, names, promises),
            *front_violations(room, names, promises, PASSAGE),
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


def _walking(house: House) -> Iterator[str]:
    bodies, squares = spaces(house, BODY), spaces(house, PASSAGE)
    main = main_space(house, bodies, BODY)
    covered = [(space, swept(space, BODY)) for space in bodies]
    for index, room in enumerate(house.rooms):
        place, door = _name(house, index), shapely.box(*room.door.box)
        if not main.intersects(places_inside(room, BODY)):
            yield f"{place}: the body ({BODY} m square) cannot get into it from the main room"
            continue
        free = free_floor(room)
        reached = shapely.union_all([floor for space, floor in covered if space.intersects(door)])
        share = reached.intersection(free).area / free.area
        if share < REACHABLE:
            yield (
                f"{place}: the body reaches {share:.0%} of its free floor from its door "
                f"(at least {REACHABLE:.0%})"
            )
        closed = [space for space in squares if space.intersection(free).area > SLIVER]
        closed = [space for space in closed if not space.intersects(door)]
        if closed:
            area = shapely.union_all([swept(space, PASSAGE) for space in closed]).intersection(free).area
            yield f"{place}: {area:.2f} m² of its floor lie behind passages narrower than {PASSAGE} m"


def _main_room(house: House, promises: Promises) -> Iterator[str]:
    short, long = sorted((house.floor.width, house.floor.height))
    if long > ELONGATION * short + TOLERANCE:
        yield f"main room: is {long:.2f} by {short:.2f} m (at most {ELONGATION:g} times as long as wide)"
    if house.provenance and "keep" in house.provenance.request:
        return  # It reaches from one fixed room to the other, however far.
    if house.format != FORMAT or not house.rooms or any(side_of(house, room) is None for room in house.rooms):
        return
    least = least_area(house, math.inf if promises.room_gap is None else max(promises.room_gap, CLEARANCE))
    if house.floor.area > SPACIOUSNESS * least + TOLERANCE * (short + long):
        yield (
            f"main room: is of {house.floor.area:.2f} m² "
            f"(at most {SPACIOUSNESS:g} times the {least:.2f} m² that its rooms need)"
        )


def _name(house: House, index: int) -> str:
    return f"R{index} ({house.rooms[index].type})"


def _piece_names(room: Room) -> list[str]:
    """The type of each piece, numbered where a room has several of it."""
    total = Counter(piece.type for piece in room.pieces)
    seen: Counter[str] = Counter()
    names = []
    for piece in room.pieces:
        seen[piece.type] += 1
        names.append(f"{piece.type} {seen[piece.type]}" if total[piece.type] > 1 else piece.type)
    return names
