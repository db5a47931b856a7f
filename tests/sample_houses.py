"""Houses for tests: drawn as text, or random, in either convention of files."""

import copy
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from tests.reference import Reference
from vitruvius.logic import House, Piece, Rect, Star, StarRoom, load
from vitruvius.sim import DEFAULT
from vitruvius.sim.tasks.tasks import PAPER

FIXTURES = Path(__file__).parent / "fixtures"
"""Folder of the original program's own house and a recording of it: see the README there."""

ONE_ROOM = """
aaaa....
aA.+....
aaaa....
"""
"""Room ``a`` with a piece in it, west of the main room; ``+`` is its door's cell."""

Sides = tuple[float, float, float, float]


def drawn(text: str, cell: float = 0.9) -> House:
    """Return a house from text, a square ``cell`` metres a side for each character.

    ``.`` is the main room (a rectangle), a small letter a secondary room, its capital a piece in it. ``+`` is
    a cell of the adjacent room, open to the main room next to it, over the cell's length.
    """
    rows = text.strip("\n").split("\n")
    letters = np.array([list(row) for row in rows])

    def box(mask: np.ndarray) -> Sides:
        y, x = np.nonzero(mask)
        north, west = y.min(), x.min()
        east, south = x.max() + 1, y.max() + 1
        return (
            float(west * cell),
            float(north * cell),
            float((east - west) * cell),
            float((south - north) * cell),
        )

    doors = {}
    for y, x in np.argwhere(letters == "+"):
        around = {(0, 1): "", (0, -1): "", (1, 0): "", (-1, 0): ""}
        for dy, dx in around:
            if 0 <= y + dy < letters.shape[0] and 0 <= x + dx < letters.shape[1]:
                around[dy, dx] = str(letters[y + dy, x + dx])
        room = next(c.lower() for c in around.values() if c.isalpha())
        dy, dx = next(way for way, c in around.items() if c == ".")
        west, north = (x + (dx > 0)) * cell, (y + (dy > 0)) * cell
        doors[room] = Rect(float(west), float(north), cell * (dx == 0), cell * (dy == 0))
    rooms = []
    for name in sorted({c for c in letters.ravel() if c.islower()}):
        piece = letters == name.upper()
        pieces = (Piece(*box(piece), type="table"),) if piece.any() else ()
        rooms.append(StarRoom(*box(letters == name), type="bedroom", children=pieces, door=doors[name]))
    return House.of_star(Star(Rect(*box(letters == ".")), tuple(rooms)))


def changed_star(house: House, **changes: Any) -> House:
    """Return a star with another ``floor`` or other ``rooms``."""
    return House.of_star(msgspec.structs.replace(house.star, **changes), house.topology, house.provenance)


def example(whole_pixels: bool = False, name: str = "example1") -> House:
    """Return a house of the original program.

    ``whole_pixels`` cuts its lengths to whole pixels, as in the original's simulator.
    """
    path = PAPER / "house.json" if name == "2019-2-15" else FIXTURES / f"{name}.json"
    return load(path, whole_pixels=whole_pixels)[0]


def random_house(seed: int, original: bool = False) -> House:
    """Return a main room with up to one furnished room on each side.

    The rooms touch the main room, or overlap it as in the original's files. Pieces may overlap each other and
    stand anywhere except near the door.
    """
    rng = np.random.default_rng(seed)
    width, height = rng.uniform(3.5, 7, 2).tolist()
    x, y = rng.uniform(0, 3, 2).tolist()
    floor = Rect(x, y, width, height)
    rooms = []
    for side in rng.permutation(4)[: rng.integers(1, 5)]:
        along = floor.width if side % 2 == 0 else floor.height
        length, depth = rng.uniform(0.5, 0.85) * along, rng.uniform(2, 3.5)
        overlap = rng.uniform(0.2, 1.0) if original else 0.0
        start = rng.uniform(0.08, 0.92) * (along - length)
        door_at = start + rng.uniform(0.1, length - 0.9)
        before, after = overlap - depth, -overlap
        if side % 2 == 0:  # north, south
            y = floor.y + before if side == 0 else floor.y + floor.height + after
            wall = y + depth if side == 0 else y
            room = Rect(floor.x + start, y, length, depth)
            door = Rect(floor.x + door_at, wall, 0.762, 0.0)
        else:  # east, west
            x = floor.x + before if side == 3 else floor.x + floor.width + after
            wall = x + depth if side == 3 else x
            room = Rect(x, floor.y + start, depth, length)
            door = Rect(wall, floor.y + door_at, 0.0, 0.762)
        rooms.append(StarRoom(*_sides(room), type="hall", children=_pieces(rng, room, door), door=door))
    return House.of_star(Star(floor, tuple(rooms)), "original" if original else "star")


def free_poses(house: House, count: int, seed: int) -> np.ndarray:
    """Return poses (count, 3) in a house where the default body is surely clear of everything."""
    rng, reference = np.random.default_rng(seed), Reference(house)
    boxes = np.array([room.box for room in house.rooms])
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    poses = []
    while len(poses) < count:
        place = rng.uniform(low, high)
        indoors = ((boxes[:, :2] < place) & (place < boxes[:, 2:])).all(axis=1).any()
        if indoors and reference.is_free(place, DEFAULT.body[0]):
            poses.append((*place, rng.integers(8) * np.pi / 4))
    return np.array(poses)


def _pieces(rng: np.random.Generator, room: Rect, door: Rect) -> tuple[Piece, ...]:
    west, north, east, south = door.box
    pieces = []
    for _ in range(3):
        width, height = rng.uniform(0.2, 0.9, 2).tolist()
        x = room.x + rng.uniform(0, room.width - width)
        y = room.y + rng.uniform(0, room.height - height)
        near_door = x < east + 0.5 and west - 0.5 < x + width and y < south + 0.5 and north - 0.5 < y + height
        if not near_door:
            pieces.append(Piece(x, y, width, height, type="table"))
    return tuple(pieces)


def _sides(rect: Rect) -> Sides:
    return rect.x, rect.y, rect.width, rect.height


RANDOM = [random_house(seed, original) for seed in range(3) for original in (False, True)]
"""Three random houses in each convention."""

FOUR_ROOMS, THREE_ROOMS = (load(FIXTURES / "houses.jsonl")[part] for part in (slice(4), slice(4, 8)))
"""Four houses of family each, made from seed 31 and kept, so that no solver starts as tests are collected."""


def changed_record(record: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a copy of a record with another value at a dotted path; ``...`` removes it."""
    record = copy.deepcopy(record)
    *way, last = [int(step) if step.isdecimal() else step for step in path.split(".")]
    place: Any = record
    for step in way:
        place = place[step]
    if value is ...:
        del place[last]
    else:
        place[last] = value
    return record
