"""Houses that are no stars, made by hand with all edges on a grid of 0.3 m: flats with shared walls.

``python -m tests.plans`` writes them to ``fixtures/plans.jsonl``.
"""

from collections.abc import Iterable
from itertools import combinations

import numpy as np

from tests.sample_houses import FIXTURES
from vitruvius.logic import Door, House, Piece, Room, Window, save
from vitruvius.logic.house.parts import OUTSIDE

CELL, DOOR = 0.3, 0.9

Place = tuple[float, float, float, float]


def room(name: str, kind: str, place: Place, *pieces: Piece) -> Room:
    """Return a room at x, y, width, height, metres; its pieces are placed in it."""
    x, y, width, height = (round(value, 9) for value in place)
    inside = tuple(
        Piece(
            round(x + each.x, 9), round(y + each.y, 9), each.width, each.height, each.type, each.orientation
        )
        for each in pieces
    )
    return Room(x, y, width, height, name, kind, inside)


def wall(one: Room, other: Room) -> tuple[bool, float, float, float]:
    """Return the wall that two rooms share: True if it runs along x, its place, its start and its end."""
    (a, b, c, d), (e, f, g, h) = one.box, other.box
    for at in {c, a} & {g, e}:
        if min(d, h) > max(b, f):
            return False, at, max(b, f), min(d, h)
    (at,) = {d, b} & {h, f}
    return True, at, max(a, e), min(c, g)


def joined(rooms: Iterable[Room], one: str, other: str, start: float, width: float = DOOR) -> Door:
    """Return a door between two rooms, ``start`` metres from the west or north end of their shared wall."""
    by_name = {each.name: each for each in rooms}
    along_x, at, low, _ = wall(by_name[one], by_name[other])
    low = round(low + start, 9)
    place = (low, at, width, 0.0) if along_x else (at, low, 0.0, width)
    return Door(*place, between=(one, other))


def flat() -> House:
    """Return a corridor between two bands of rooms; the bathroom R2 is behind the bedroom R1."""
    bed, wardrobe = Piece(1.2, 0.0, 1.5, 2.1, "bed", "S"), Piece(0.0, 1.2, 0.6, 1.5, "wardrobe", "E")
    wet = Piece(0.9, 0.0, 0.6, 0.6, "toilet", "S"), Piece(1.5, 1.5, 0.6, 0.6, "sink", "W")
    rooms = (
        room("R0", "corridor", (0, 3.6, 10.2, 1.2)),
        room("R1", "bedroom", (0, 0, 3.6, 3.6), bed, wardrobe),
        room("R2", "bathroom", (3.6, 0, 2.1, 3.6), *wet),
        room("R3", "bedroom", (5.7, 0, 4.5, 3.6), bed, Piece(3.9, 0.6, 0.6, 1.8, "wardrobe", "W")),
        room("R4", "hall", (0, 4.8, 1.8, 3.6)),
        room("R5", "bathroom", (1.8, 4.8, 2.1, 3.6), Piece(0.9, 3.0, 0.6, 0.6, "toilet", "N")),
        room("R6", "kitchen", (3.9, 4.8, 2.7, 3.6), Piece(0.0, 3.0, 2.7, 0.6, "desk", "N")),
        room("R7", "living", (6.6, 4.8, 3.6, 3.6), Piece(0.9, 2.7, 1.8, 0.9, "sofa", "N")),
    )
    doors = [
        *(joined(rooms, "R0", name, 0.6) for name in ("R3", "R5", "R6", "R7")),
        joined(rooms, "R0", "R4", 0.3),
        joined(rooms, "R0", "R1", 2.1),
        joined(rooms, "R1", "R2", 2.1),
        joined(rooms, "R6", "R7", 1.2, 1.2),
        Door(0.6, 8.4, DOOR, 0.0, ("R4", OUTSIDE)),
    ]
    windows = (
        Window(0.9, 0.0, 1.5, 0.0, "R1"),
        Window(7.2, 0.0, 1.8, 0.0, "R3"),
        Window(4.5, 8.4, 1.2, 0.0, "R6"),
        Window(10.2, 5.7, 0.0, 1.8, "R7"),
    )
    return House(rooms, tuple(doors), windows, "R0", "ring")


def around_a_living_room() -> House:
    """Return a living room in an L, with five doors, two in one wall; hall and study also have a door."""
    rooms = (
        room("R0", "living", (3.6, 3.0, 5.4, 4.5), Piece(1.8, 3.6, 1.8, 0.9, "sofa", "N")),
        room("R1", "bedroom", (0, 3.0, 3.6, 4.5), Piece(0.0, 1.2, 2.1, 1.5, "bed", "E")),
        room("R2", "kitchen", (3.6, 0, 2.7, 3.0), Piece(0.0, 0.0, 2.7, 0.6, "desk", "S")),
        room("R3", "bathroom", (6.3, 0, 2.7, 3.0), Piece(0.0, 0.0, 0.9, 0.9, "shower")),
        room("R4", "study", (9.0, 0, 3.0, 4.8), Piece(0.6, 0.0, 1.5, 0.9, "desk", "S")),
        room("R5", "hall", (9.0, 4.8, 3.0, 2.7), Piece(0.6, 2.1, 1.5, 0.6, "cupboard", "N")),
    )
    doors = [
        joined(rooms, "R0", "R1", 3.0),
        joined(rooms, "R0", "R2", 0.6),
        joined(rooms, "R0", "R3", 0.9),
        joined(rooms, "R0", "R4", 0.3),
        joined(rooms, "R0", "R5", 0.6),
        joined(rooms, "R4", "R5", 1.2),
        Door(12.0, 5.7, 0.0, DOOR, ("R5", OUTSIDE)),
    ]
    windows = (
        Window(5.1, 7.5, 2.4, 0.0, "R0"),
        Window(0.0, 3.3, 0.0, 1.5, "R1"),
        Window(12.0, 1.2, 0.0, 1.8, "R4"),
    )
    return House(rooms, tuple(doors), windows, "R0", "ring")


def one_after_the_other() -> House:
    """Return five rooms in a U, each entered through the one before it; no hub, no furniture."""
    rooms = (
        room("R0", "hall", (0, 0, 3.0, 3.0)),
        room("R1", "kitchen", (0, 3.0, 3.0, 4.2)),
        room("R2", "living", (3.0, 4.2, 4.2, 3.0)),
        room("R3", "bedroom", (7.2, 3.0, 3.0, 4.2)),
        room("R4", "bathroom", (7.2, 0, 3.0, 3.0)),
    )
    chain = [joined(rooms, f"R{k}", f"R{k + 1}", 0.6) for k in range(4)]
    doors = (Door(0.9, 0.0, DOOR, 0.0, (OUTSIDE, "R0")), *chain)
    return House(rooms, doors, (Window(4.2, 7.2, 1.8, 0.0, "R2"),))


def random_plan(seed: int, count: int = 8) -> House:
    """Return a rectangle cut into rooms of at least 2 m a side, with doors.

    Two rooms have a door if they share 1.2 m of wall. In half of the plans the last rooms are left out, so
    that the outline has corners.
    """
    rng = np.random.default_rng(seed)
    boxes = [(0.0, 0.0, float(rng.uniform(9, 14)), float(rng.uniform(7, 11)))]
    while len(boxes) < count and max(max(box[2:]) for box in boxes) > 4.5:
        x, y, width, height = boxes.pop(max(range(len(boxes)), key=lambda k: max(boxes[k][2:])))
        if width > height:
            cut = float(rng.uniform(2, width - 2))
            boxes += [(x, y, cut, height), (x + cut, y, width - cut, height)]
        else:
            cut = float(rng.uniform(2, height - 2))
            boxes += [(x, y, width, cut), (x, y + cut, width, height - cut)]
    kept = boxes[: len(boxes) - int(rng.integers(3)) * (seed % 2)]
    rooms = tuple(Room(*box, f"R{k}", "bedroom") for k, box in enumerate(kept))
    doors = []
    for one, other in combinations(rooms, 2):
        (a, b, c, d), (e, f, g, h) = one.box, other.box
        across, along = min(c, g) - max(a, e), min(d, h) - max(b, f)
        if abs(across) < 1e-9 and along > 1.2:
            start = max(b, f) + float(rng.uniform(0, along - DOOR))
            doors.append(Door(max(a, e), start, 0.0, DOOR, (one.name, other.name)))
        elif abs(along) < 1e-9 and across > 1.2:
            start = max(a, e) + float(rng.uniform(0, across - DOOR))
            doors.append(Door(start, max(b, f), DOOR, 0.0, (one.name, other.name)))
    return House(rooms, tuple(doors), hub="R0", topology="dissection")


PLANS = {"flat": flat(), "living": around_a_living_room(), "chain": one_after_the_other()}

if __name__ == "__main__":
    save(PLANS.values(), FIXTURES / "plans.jsonl")
