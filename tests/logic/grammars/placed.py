"""Counter of implausible furniture and doors in a hundred homes and clinics, by geometry alone.

Run it by ``./run python -m tests.logic.grammars.placed``, which takes about a minute.
"""

import sys
from collections import Counter
from collections.abc import Iterable, Iterator

from vitruvius.logic import generate
from vitruvius.logic.house.boxes import BACK, Box, overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Piece, Room

NEAR = 1.2
"""Distance in metres below which a wall blocks the view from a sofa."""
SILL = 0.3
"""Distance in metres below which a piece counts as under a window."""
ROOMS = range(4, 14)
EACH = 10


def main(*grammars: str) -> None:
    """Print the number of each oddity, and the number of houses."""
    for grammar in grammars or ("home", "clinic"):
        houses = [
            house for rooms in ROOMS for house in generate(rooms, grammar=grammar, seed=rooms, count=EACH)
        ]
        found, of = counted(houses)
        print(f"{grammar}: {len(houses)} houses, {sum(len(house.rooms) for house in houses)} rooms")
        for name, count in of.items():
            print(f"  {name}: {found[name]} of {count}")


def counted(houses: Iterable[House]) -> tuple[Counter[str], Counter[str]]:
    """Return the number of each oddity, and the number of rooms or pieces that could have it."""
    found, of = Counter[str](), Counter[str]()
    for house in houses:
        for name, odd in asked(house):
            of[name] += 1
            found[name] += odd
    return found, of


def asked(house: House) -> Iterator[tuple[str, bool]]:
    """Yield each question about a house, and True if the answer is odd."""
    without = {type_: reached(house, type_) for type_ in ("living", "bedroom", "kitchen")}
    for room in house.rooms:
        if room.type == "bedroom":
            yield "bedroom behind a living room alone", room.name not in without["living"]
        if room.type == "storage":
            yield "storage behind a bedroom alone", room.name not in without["bedroom"]
        if room.type == "bathroom":
            yield "bathroom behind a kitchen alone", room.name not in without["kitchen"]
            yield "bathroom with two toilets", sum(piece.type == "toilet" for piece in room.children) > 1
        if room.type == "treatment":
            yield "treatment without a window", all(window.room != room.name for window in house.windows)
        yield from asked_of_pieces(house, room)


def asked_of_pieces(house: House, room: Room) -> Iterator[tuple[str, bool]]:
    """Yield each question about the furniture of a room, and True if the answer is odd."""
    screens = [piece for piece in room.children if piece.type == "tvBench"]
    for piece in room.children:
        if piece.type == "sofa":
            before = to_wall(piece, room) < NEAR and not any(sees(piece, each) for each in screens)
            yield "sofa with its front to a wall", before
        if piece.type == "sofa" and screens and piece == next(p for p in room.children if p.type == "sofa"):
            yield (
                "sofa with its back or side to the television",
                not any(sees(piece, each) for each in screens),
            )
        if piece.type == "tvBench":
            windows = [window.box for window in house.windows if window.room == room.name]
            yield "television under a window", any(overlap(grown(box), piece.box) > 1e-6 for box in windows)
        if piece.type in {"writingDesk", "consultingDesk"}:
            yield "desk without a chair", not piece.children


def to_wall(piece: Piece, room: Room) -> float:
    """Return the distance from the front of a piece to the wall that it faces, metres."""
    front = (BACK[piece.orientation] + 2) % 4
    return abs(room.box[front] - piece.box[front])


def sees(piece: Piece, other: Piece) -> bool:
    """Return True if the other piece is on the front side of this one."""
    front = (BACK[piece.orientation] + 2) % 4
    return (other.box[front] - piece.box[front]) * (1 if front >= 2 else -1) > 0


def grown(box: Box) -> Box:
    """Return the zone before a window, on both sides."""
    return box[0] - SILL * (box[0] == box[2]), box[1] - SILL * (box[1] == box[3]), *_far(box)


def _far(box: Box) -> tuple[float, float]:
    return box[2] + SILL * (box[0] == box[2]), box[3] + SILL * (box[1] == box[3])


def reached(house: House, without: str) -> set[str]:
    """Return the names of rooms that one reaches from outside without passing a room of a type."""
    types = {room.name: room.type for room in house.rooms}
    found, new = set[str](), {OUTSIDE}
    while new:
        found |= new
        passed = {name for name in new if types.get(name) != without}
        new = {name for door in house.doors for name in door.between if passed & {*door.between}} - found
    return found


if __name__ == "__main__":
    main(*sys.argv[1:])
