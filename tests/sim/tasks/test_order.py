"""Targets in an order: in rooms, and at given points."""

from typing import Any

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import HouseVectorEnv, Oracle
from vitruvius.sim.tasks.words import in_words

DRAWN = sample_houses.drawn("Aa+aa.bBb\n......+bb\n......bbb", cell=1.2)
HOUSES = [DRAWN, *sample_houses.RANDOM[:2]]
COUNT = 12


def types_at(house: Any, places: np.ndarray) -> list[set[str]]:
    """Return the types of the rooms that contain places (n, 2)."""
    return [
        {
            room.type
            for room in house.rooms
            if room.box[0] <= x <= room.box[2] and room.box[1] <= y <= room.box[3]
        }
        for x, y in places
    ]


def test_targets_lie_in_rooms_in_their_order_whatever_the_house():
    order = [DRAWN.rooms[1].type, DRAWN.rooms[0].type, DRAWN.rooms[-1].type]
    houses = [house for house in HOUSES if set(order) <= {room.type for room in house.rooms}]
    envs = HouseVectorEnv(houses, COUNT, targets={"task": "order", "rooms": order, "terms": {"targets": 3}})
    envs.reset(seed=0)
    coming = envs.targets(7)
    for house, places in zip(envs.info()["house"], coming, strict=True):
        for turn, types in enumerate(types_at(houses[house], places)):
            assert order[turn % 3] in types
    assert len(np.unique(coming.reshape(-1, 2), axis=0)) > 3 * COUNT
    oracle, met, over = Oracle(envs), np.zeros(COUNT, int), np.zeros(COUNT, bool)
    for _ in range(400):
        _, reward, terminated, _, info = envs.step(oracle.act())
        met += (reward > 0) & ~over
        over |= terminated
        if over.all():
            break
        np.testing.assert_array_equal(
            info["target"][~over], coming[np.arange(COUNT), np.minimum(met, 6)][~over]
        )
    assert over.all()
    np.testing.assert_array_equal(met, 3)


def test_given_points_come_in_their_order_if_that_is_asked_for():
    points = [(x, y) for x, y in ((4.0, 3.0), (1.0, 2.0), (6.0, 1.8))]
    envs = HouseVectorEnv([DRAWN], 4, targets={"points": points, "in_order": True})
    envs.reset(seed=3)
    np.testing.assert_allclose(envs.targets(5), [[points[k % 3] for k in range(5)]] * 4, atol=1e-5)
    envs.set_houses([DRAWN], {"points": points})
    envs.reset(seed=3)
    assert (envs.targets(5) != np.array([[points[k % 3] for k in range(5)]] * 4, np.float32)).any()


def test_an_order_is_said_in_words_and_a_wrong_one_refused():
    asked = {"task": "order", "rooms": ["wc", "hall"], "terms": {"targets": 2}}
    assert in_words(asked) == "targets in rooms of type wc, then hall, targets 2"
    points = {"points": [[1, 2]], "in_order": True}
    assert in_words(points) == "targets at 1 given place, in order"
    for rooms, message in (
        ([DRAWN.rooms[0].type, "hut"], "house 0 of 1: it has no room that can hold the targets"),
        ([], "rooms: give a list of room types, in order, not"),
        ("hall", "a list of room types, not 'hall'"),
    ):
        with pytest.raises(ValueError, match=message):
            HouseVectorEnv([DRAWN], targets={"task": "order", "rooms": rooms})
