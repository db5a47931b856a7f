"""A house's walls and pieces, in both conventions of files."""

from itertools import combinations

import numpy as np
import pytest
import shapely

from sim.geometry import geometry
from tests import sample_houses
from tests.plans import PLANS, random_plan
from tests.reference import walls


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
