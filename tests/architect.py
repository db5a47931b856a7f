"""Faults that an architect would not draw, judged by doors and rectangles, without promises or rules."""

from collections import deque
from collections.abc import Iterator

from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Piece

WAYS = {"hall", "corridor", "commonCorridor", "reception"}
"""Room types on the way to other rooms: circulation, and reception."""
SLEEPS, WASHES = {"bedroom", "ward"}, {"bathroom", "wc", "washroom"}
DARK = {*WAYS, *WASHES, "storage"} - {"reception"}
"""Room types where nobody stays for long, so that they need no daylight."""
LARGEST = {"bathroom": 12.0, "wc": 4.0, "washroom": 12.0, "storage": 26.0}
"""Largest area of some room types, in square metres."""


def faults(house: House) -> Iterator[str]:
    """Yield faults: ways through living rooms, rooms out of reach, dark rooms, large service rooms."""
    ways = WAYS if any(room.type in WAYS for room in house.rooms) else WAYS | {"living"}
    direct, behind = passed(house, ways), passed(house, WAYS)
    types = {room.name: room.type for room in house.rooms} | {OUTSIDE: OUTSIDE}
    lit = {window.room for window in house.windows}
    for room in house.rooms:
        place = f"{room.name} ({room.type})"
        beyond = {types[name] for door in house.doors_of(room.name) for name in door.between} - {room.type}
        if room.type in SLEEPS and direct[room.name]:
            yield f"{place}: the way to it leads through a room where one lives"
        if room.type in WASHES and direct[room.name] and not beyond & SLEEPS:
            yield f"{place}: the way to it leads through a room where one lives, and it is no bedroom's own"
        if behind[room.name] > 1:
            yield f"{place}: is behind {behind[room.name]} rooms"
        if room.type in SLEEPS and "storage" in beyond:
            yield f"{place}: things are stored behind it"
        if room.type not in DARK and room.name not in lit:
            yield f"{place}: has no daylight"
        if room.area > LARGEST.get(room.type, room.area) + 1e-6:
            yield f"{place}: is of {room.area:.1f} m²"
        yield from (f"{place}: {said}" for said in desks_without_chairs(room.children))
        if sum(piece.type == "toilet" for piece in room.pieces) != (room.type in WASHES):
            yield f"{place}: has not one toilet, or has one where it should have none"


def desks_without_chairs(pieces: tuple[Piece, ...]) -> Iterator[str]:
    """Yield a fault for each desk without a chair in front of it that is turned to it."""
    for desk in pieces:
        if desk.type == "writingDesk":
            chairs = [each for each in desk.children if each.type == "chair"]
            if [in_front(desk, each) for each in chairs] != [True]:
                yield f"nobody sits at its desk, which has {len(chairs)} chairs"


def in_front(piece: Piece, seat: Piece) -> bool:
    """Return True if a seat stands at the middle of a piece's front, turned to the piece."""
    at = "NESW".index(piece.orientation)
    (west, north, east, south), (x1, y1, x2, y2) = piece.box, seat.box
    gap = (north - y2, x1 - east, y1 - south, west - x2)[at]
    off = (west + east - x1 - x2, north + south - y1 - y2)[at % 2] / 2
    return max(abs(gap), abs(off)) < 1e-6 and seat.orientation == "NESW"[(at + 2) % 4]


def passed(house: House, ways: set[str]) -> dict[str, int]:
    """Return the least number of rooms on the way from outside to each room; ``ways`` do not count."""
    types = {room.name: room.type for room in house.rooms}
    found, left = {OUTSIDE: 0}, deque([OUTSIDE])
    while left:
        name = left.popleft()
        for door in house.doors_of(name):
            (other,) = {*door.between} - {name}
            more = found[name] + (name != OUTSIDE and types[name] not in ways)
            if other != OUTSIDE and more < found.get(other, len(types)):
                found[other] = more
                left.append(other)
    return found
