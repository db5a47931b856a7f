"""Each constant of the original's program, measured by coordinates in 300 houses of the grammar `paper`."""

from collections import Counter
from collections.abc import Iterator
from itertools import combinations

import pytest

from tests.logic.workers.in_process import generate
from vitruvius.logic import House, Piece, Room
from vitruvius.logic.house.boxes import BACK, distance, is_on_wall, overlap, walls_touched

FOOT = 0.3048
NEAR = 1e-6
ROOMS = {"bedroom": (12, 17), "bathroom": (8, 12), "kitchen": (10, 15), "hall": (15, 20)}
"""Least and greatest side of a room, feet."""
SIDES = {
    "bed": (2, 3, 5, 6),
    "bedside": (1.5, 2, 1.5, 2),
    "wardrobe": (3, 7.5, 1.5, 2),
    "toilet": (1, 1.3, 1.7, 2),
    "shower": (3, 4, 3, 4),
    "sink": (2.5, 3.5, 5 / 3, 7 / 3),
    "desk": (7, 15, 1.5, 1.8),
    "cupboard": (3, 12, 1.5, 2),
    "sofa": (6, 8, 2.5, 3),
    "hallTable": (2.5, 6, 2.5, 6),
    "chair": (0.7, 1, 0.7, 1),
}
"""Least and greatest length, which runs along a piece's back, and depth, feet."""
DEPTHS = {
    "bed": lambda length: length + 3 * FOOT,
    "bedside": lambda length: length,
    "toilet": lambda length: length + 0.7 * FOOT,
    "shower": lambda length: length,
    "sink": lambda length: 2 / 3 * length,
    "chair": lambda length: length,
}
"""Depths of pieces whose length determines their depth."""
COUNTS = {
    "bedroom": {"bed": 2, "wardrobe": 2},
    "bathroom": {"toilet": 1, "shower": 1, "sink": 1},
    "kitchen": {"desk": 3, "table": 1},
    "hall": {"sofa": 2, "cupboard": 2, "hallTable": 1},
}
"""Greatest number of each kind; the original samples each number from 0 on uniformly."""


@pytest.fixture(scope="module")
def houses() -> list[House]:
    return list(generate(rooms=5, grammar="paper", seed=22, count=300))


def of_type(houses: list[House], type_: str) -> Iterator[tuple[Room, Piece]]:
    for house in houses:
        for room in house.secondary:
            yield from ((room, piece) for piece in room.pieces if piece.type == type_)


def sizes(piece: Piece) -> tuple[float, float]:
    """Return the length and depth of a piece, metres; for a piece without a front, as it lies."""
    along_x = piece.orientation in {"N", "S", ""}
    return (piece.width, piece.height) if along_x else (piece.height, piece.width)


def assert_spread(values: list[float], least: float, most: float) -> None:
    """Check that all values lie in this range, and come within a tenth of it to both ends."""
    assert least - NEAR <= min(values) <= least + 0.1 * (most - least), min(values)
    assert most - 0.1 * (most - least) <= max(values) <= most + NEAR, max(values)


@pytest.mark.parametrize("type_", ROOMS)
def test_rooms_have_the_sides_of_the_original_s(houses: list[House], type_: str) -> None:
    rooms = [room for house in houses for room in house.secondary if room.type == type_]
    least, most = (FOOT * feet for feet in ROOMS[type_])
    assert_spread([side for room in rooms for side in (room.width, room.height)], least, most)


@pytest.mark.parametrize("type_", SIDES)
def test_pieces_have_the_sides_of_the_original_s(houses: list[House], type_: str) -> None:
    found = [sizes(piece) for _, piece in of_type(houses, type_)]
    a, aa, b, bb = (FOOT * feet for feet in SIDES[type_])
    lengths, depths = zip(*found, strict=True)
    if type_ == "hallTable":
        assert_spread([*lengths, *depths], a, aa)
    elif type_ in {"cupboard", "desk"}:  # The longest take a whole wall, so there are few.
        assert a - NEAR <= min(lengths) <= max(lengths) <= aa + NEAR
    else:
        assert_spread(list(lengths), a, aa)
    if type_ in DEPTHS:
        assert all(depth == pytest.approx(DEPTHS[type_](length)) for length, depth in found)
    elif type_ != "hallTable":
        assert_spread(list(depths), b, bb)


def test_a_table_of_a_hall_has_an_area_of_8_to_15_square_feet(houses: list[House]) -> None:
    assert_spread([table.area for _, table in of_type(houses, "hallTable")], 8 * FOOT**2, 15 * FOOT**2)


def test_a_kitchen_s_table_takes_a_fifth_to_three_tenths_of_each_side(
    houses: list[House],
) -> None:
    along, across = [], []
    for house in houses:
        for kitchen in house.secondary:
            (door,) = house.doors_of(kitchen.name)
            for table in (piece for piece in kitchen.pieces if piece.type == "table"):
                shares = table.width / kitchen.width, table.height / kitchen.height
                one, other = shares if door.width else shares[::-1]
                along.append(one)
                across.append(other)
    assert_spread(along, 0.2, 0.3)
    assert_spread(across, 0.2, 0.3)


def test_a_desk_takes_7_to_10_tenths_of_its_wall(houses: list[House]) -> None:
    shares = [
        sizes(desk)[0] / (kitchen.width if desk.orientation in {"N", "S"} else kitchen.height)
        for kitchen, desk in of_type(houses, "desk")
    ]
    assert_spread(shares, 0.7, 1.0)


def test_every_table_has_a_chair_on_each_side(houses: list[House]) -> None:
    for type_ in ("table", "hallTable"):
        for _, table in of_type(houses, type_):
            assert sorted(_side(table, chair) for chair in table.children) == [0, 1, 2, 3]


def _side(piece: Piece, other: Piece) -> int:
    """Return the side of a piece that another piece touches."""
    return next(
        k
        for k in range(4)
        if abs(other.box[(k + 2) % 4] - piece.box[k]) < NEAR
        and min(piece.box[(k + 1) % 2 + 2], other.box[(k + 1) % 2 + 2])
        - max(piece.box[(k + 1) % 2], other.box[(k + 1) % 2])
        > NEAR
    )


def test_a_bed_has_exactly_one_bedside_at_the_same_wall_and_touching_it(houses: list[House]) -> None:
    lying = Counter()
    for room, bed in of_type(houses, "bed"):
        (bedside,) = bed.children
        assert distance(bed.box, bedside.box) < NEAR
        walls = set(walls_touched(bed, room)) & set(walls_touched(bedside, room))
        assert walls
        turned = BACK[bed.orientation] not in walls
        lying[turned] += 1
        if turned:  # The bed lies along the wall, with its head at the bedside.
            assert _side(bed, bedside) == BACK[bed.orientation]
    assert min(lying.values()) > 0.2 * lying.total()


def test_beds_stand_at_every_wall_that_of_the_door_too(houses: list[House]) -> None:
    walls = Counter()
    for house in houses:
        for room in house.secondary:
            (door,) = house.doors_of(room.name)
            (front,) = (wall for wall in range(4) if is_on_wall(door, room, wall))
            for bed in room.children:
                if bed.type == "bed":
                    walls.update((wall - front) % 4 for wall in walls_touched(bed, room))
    assert set(walls) == {0, 1, 2, 3}
    assert walls[0] > 0.08 * walls.total()


def test_a_foot_and_a_half_is_free_in_front_of_a_door_and_behind_it(houses: list[House]) -> None:
    ahead = []
    for house in houses:
        for door in house.doors:
            west, north, east, south = door.box
            x, y = (9.0, 0.0) if east - west < south - north else (0.0, 9.0)
            zone = west - x, north - y, east + x, south + y
            pieces = [piece for room in house.secondary for piece in room.pieces]
            ahead += [distance(door.box, p.box) for p in pieces if overlap(zone, p.box) > NEAR]
    assert 1.5 * FOOT - NEAR <= min(ahead) < 1.5 * FOOT + 0.1


def test_nothing_stands_within_a_foot_of_a_sofa(houses: list[House]) -> None:
    for house in houses:
        for room in house.secondary:
            for one, other in combinations(room.pieces, 2):
                if "sofa" in {one.type, other.type}:
                    assert distance(one.box, other.box) >= FOOT - NEAR


@pytest.mark.parametrize("type_", COUNTS)
def test_every_number_of_pieces_is_as_likely_as_in_the_original_and_so_is_an_empty_room(
    houses: list[House], type_: str
) -> None:
    """The original samples all combinations of counts uniformly.

    Here combinations that fit in no room are left out.
    """
    rooms = [room for house in houses for room in house.secondary if room.type == type_]
    share = 1.0
    for piece, most in COUNTS[type_].items():
        share /= most + 1
        found = Counter(sum(child.type == piece for child in room.children) for room in rooms)
        assert set(found) == set(range(most + 1))
        for count in found.values():
            assert abs(count / len(rooms) - 1 / (most + 1)) < 0.1, (piece, found)
    empty = sum(not room.children for room in rooms)
    deviation = (share * (1 - share) / len(rooms)) ** 0.5
    assert abs(empty / len(rooms) - share) < 4 * deviation


def test_the_main_room_is_the_largest_and_types_are_as_the_paper_demands(houses: list[House]) -> None:
    """The original's program satisfies neither."""
    for house in houses:
        assert house.main.area >= max(room.area for room in house.secondary) - NEAR
        assert {"bedroom", "bathroom", "kitchen"} <= {room.type for room in house.secondary}
