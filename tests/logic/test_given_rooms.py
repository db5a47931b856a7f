"""Rooms of given sizes and doors: what is furnished keeps every clearance and passage, by geometry of its own."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry.base import BaseGeometry

from logic.builder import Builder
from logic.given_rooms import GivenRoom, Unfurnishable, furnished
from logic.grammar import find
from logic.parts import Rect

NEAR = 1e-6
PASSAGE, CLEARANCE, DOOR = 0.42, 0.45, 0.8
FACES = {"N": (0, -1), "E": (1, 0), "S": (0, 1), "W": (-1, 0)}


@pytest.fixture(scope="module")
def builder() -> Builder:
    return Builder(find("family"))


def rooms(seed: int, type_: str, area: tuple[float, float], doors: int) -> Iterator[GivenRoom]:
    """Rooms of this type, of an area in this range (m²), with doors at random places."""
    rng = np.random.default_rng(seed)
    while True:
        size, ratio = rng.uniform(*area), rng.uniform(0.6, 1.6)
        width, depth = float(np.sqrt(size * ratio)), float(np.sqrt(size / ratio))
        x, y = map(float, rng.uniform(-5, 5, 2))
        found: list[Rect] = []
        for _ in range(100):
            wall = int(rng.integers(4))
            start = float(rng.uniform(0, (depth if wall % 2 else width) - DOOR))
            door = [
                Rect(x + start, y, DOOR, 0.0),
                Rect(x + width, y + start, 0.0, DOOR),
                Rect(x + start, y + depth, DOOR, 0.0),
                Rect(x, y + start, 0.0, DOOR),
            ][wall]
            if all(shapely.box(*door.box).distance(shapely.box(*other.box)) > 0.05 for other in found):
                found.append(door)
            if len(found) == doors:
                yield GivenRoom(type_, Rect(x, y, width, depth), found)
                break


def parts(pieces: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    for piece in pieces:
        yield piece
        yield from parts(piece["children"])


def box(rect: dict[str, Any], by: float = 0.0) -> BaseGeometry:
    x, y = rect["x"], rect["y"]
    return shapely.box(x - by, y - by, x + rect["width"] + by, y + rect["height"] + by)


def faults(room: GivenRoom, pieces: Sequence[dict[str, Any]], clear_front: frozenset[str]) -> Iterator[str]:
    """What is wrong with a furnished room."""
    floor = shapely.box(*room.rect.box)
    everything = list(parts(pieces))
    for number, piece in enumerate(everything):
        if not floor.buffer(NEAR, join_style="mitre").contains(box(piece)):
            yield f"{piece['type']} juts out"
        for other in everything[:number]:
            if box(piece, -NEAR).intersects(box(other, -NEAR)):
                yield f"{piece['type']} overlaps {other['type']}"
        for door in room.doors:
            if box(piece).distance(shapely.box(*door.box)) < CLEARANCE - NEAR:
                yield f"{piece['type']} stands before a door"
    # The places of the centre of a square as wide as a passage, within the room.
    half = PASSAGE / 2 - NEAR
    places = floor.buffer(-half, join_style="mitre")
    places = places.difference(shapely.union_all([box(piece, half) for piece in everything]))
    spaces = [space for space in shapely.get_parts(places) if space.area > 1e-4]
    if len(spaces) != 1:
        yield f"the floor falls into {len(spaces)} parts"
    for door in room.doors:
        if not spaces or spaces[0].distance(shapely.box(*door.box)) > half + NEAR:
            yield "a door cannot be reached"
    for top in pieces:
        if top["type"] in clear_front:
            dx, dy = FACES[top["orientation"]] if top["orientation"] else (0, 0)
            before = shapely.affinity.translate(box(top, -NEAR), dx * PASSAGE, dy * PASSAGE)
            if any(before.intersects(box(piece, -2 * NEAR)) for piece in pieces if piece is not top):
                yield f"{top['type']} has something before it"


@pytest.mark.parametrize(
    ("type_", "area"), [("bedroom", (9, 16)), ("kitchen", (6, 15)), ("hall", (14, 30)), ("bathroom", (3, 8))]
)
@pytest.mark.parametrize("doors", [1, 2, 3, 5])
def test_furniture_leaves_every_door_free_and_joined_to_all_the_floor(
    builder: Builder, type_: str, area: tuple[float, float], doors: int
) -> None:
    clear = frozenset({"wardrobe", "toilet", "shower", "sink", "sofa", "cupboard"})
    rng = np.random.default_rng(doors)
    done = 0
    for _, room in zip(range(40), rooms(doors, type_, area, doors), strict=False):
        try:
            (pieces,) = furnished([room], builder.programs, builder.placer, rng, 10**8)
        except Unfurnishable:
            continue
        done += 1
        assert pieces
        assert not list(faults(room, pieces, clear)), room
    assert done >= 1
