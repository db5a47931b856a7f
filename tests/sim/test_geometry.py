"""Walls and furniture of a house, in both conventions of files."""

from itertools import combinations

import numpy as np
import pytest
import shapely
from msgspec import structs

from tests import sample_houses
from tests.plans import PLANS, random_plan
from tests.reference import walls
from tests.thick import thickened
from vitruvius.logic import Door, House, Room
from vitruvius.logic.house.promises import Thickness
from vitruvius.sim.geometry import geometry, shut


def as_lines(rows: np.ndarray) -> shapely.MultiLineString:
    low, high = rows[:, :2] - rows[:, 2:], rows[:, :2] + rows[:, 2:]
    return shapely.MultiLineString(np.stack([low, high], axis=1).tolist())


@pytest.mark.parametrize("original", [False, True])
@pytest.mark.parametrize("seed", range(20))
def test_walls_equal_those_of_the_reference(seed, original):
    require_walls_of_the_reference(sample_houses.random_house(seed, original))


@pytest.mark.parametrize("house", [*PLANS.values(), *map(random_plan, range(20))])
def test_walls_that_rooms_share_stand_once_with_all_doors_cut(house):
    require_walls_of_the_reference(house)
    shape = geometry(house)
    ours = [*as_lines(shape.verticals).geoms, *as_lines(shape.horizontals).geoms]
    twice = [one.intersection(other).length for one, other in combinations(ours, 2)]
    assert max(twice) == 0


def require_walls_of_the_reference(house):
    shape = geometry(house)
    ours = shapely.union_all([as_lines(shape.verticals), as_lines(shape.horizontals)])
    theirs = walls(house)
    assert shapely.symmetric_difference(shapely.buffer(ours, 1e-5), shapely.buffer(theirs, 1e-5)).area < 1e-8


def test_a_door_opens_the_wall_that_a_room_shares_with_the_main_room():
    shape = geometry(sample_houses.drawn(sample_houses.ONE_ROOM, cell=1.0))
    shared = shape.verticals[shape.verticals[:, 0] == 4.0]
    assert sorted((y - half, y + half) for _, y, _, half in shared) == [(0.0, 1.0), (2.0, 3.0)]


def test_pieces_and_their_children_are_solid():
    shape = geometry(sample_houses.drawn(sample_houses.ONE_ROOM, cell=1.0))
    np.testing.assert_array_equal(shape.pieces, [[1.5, 1.5, 0.5, 0.5]])
    house = sample_houses.example()
    assert len(geometry(house).pieces) == sum(len(room.pieces) for room in house.star.rooms) > 10


@pytest.mark.parametrize("house", [thickened(house) for house in PLANS.values()])
@pytest.mark.parametrize("turned", [False, True])
def test_a_closed_door_of_a_thick_wall_is_at_the_face_in_the_room_that_it_names_first(house, turned):
    for door in house.doors:
        names = door.between[::-1] if turned else door.between
        at = shapely.LineString(np.reshape(shut(house, structs.replace(door, between=names)), (2, 2)))
        first = next(room for name in names for room in house.rooms if room.name == name)
        assert (
            shapely.hausdorff_distance(at, shapely.box(*first.box).boundary.intersection(at.buffer(1e-6)))
            < 1e-5
        )


def test_a_closed_door_of_a_room_in_parts_is_at_the_face_of_the_part_beside_it():
    """Another face of the room's own rectangle is as near to the door's line."""
    parts = (
        Room(0, 0, 2, 2, "A", "hall"),
        Room(0, 2.3, 2, 2, "A2", "hall", part_of="A"),
        Room(2.3, 0, 2, 4.3, "B", "hall"),
        Room(-2.3, 2.3, 2, 2, "C", "hall"),
    )
    house = House(
        parts, (Door(-0.15, 3, 0, 1, ("A", "C")),), topology="own", wall_thickness=Thickness(0.3, 0.3)
    )
    assert shut(house, house.doors[0])[0] == 0
    assert shut(house, structs.replace(house.doors[0], between=("C", "A")))[0] == pytest.approx(-0.3)
