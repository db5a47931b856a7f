"""Moves of bodies compared with the float64 reference."""

from dataclasses import replace

import numpy as np
import pytest

from tests import sample_houses
from tests.plans import PLANS, random_plan
from tests.reference import Reference
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT

ROOM = sample_houses.drawn("a+a\n...\n...", cell=1.0)
WALKED = [*sample_houses.RANDOM, PLANS["living"], random_plan(1), random_plan(2)]
HOUSES = [*WALKED, ROOM]
EACH = 100
"""Number of poses in each house."""


@pytest.fixture(scope="module")
def stepped():
    """Return a function that steps from poses (n, 3) in one house: poses before and after, and blocked."""
    made = {}

    def step(house, pose, actions, config=DEFAULT):
        if config not in made:
            made[config] = HouseVectorEnv(HOUSES, num_envs=EACH, preset=config)
        envs, count = made[config], len(pose)
        options = {"house": np.full(EACH, HOUSES.index(house)), "pose": np.resize(pose, (EACH, 3))}
        _, before = envs.reset(seed=0, options=options)
        _, _, _, _, after = envs.step(np.resize(actions, EACH))
        poses = (info["pose"][:count].astype(float) for info in (before, after))
        return *poses, after["blocked"][:count]

    return step


@pytest.mark.parametrize("step", [DEFAULT.step, 0.3, 3.0])
def test_moves_equal_those_of_the_reference(stepped, step):
    """Steps have any length: a swept body tunnels through nothing."""
    config, decided = replace(DEFAULT, step=step), 0
    for house in WALKED:
        reference, pose = Reference(house), sample_houses.free_poses(house, EACH, seed=1)
        before, after, blocked = stepped(house, pose, np.full(len(pose), FORWARD), config)
        way = np.round(np.column_stack([np.cos(before[:, 2]), -np.sin(before[:, 2])]))
        for e in range(len(pose)):
            there = before[e, :2] + way[e] * step
            expected = reference.in_the_way(before[e, :2], there, config.body[0])
            decided += expected is not None
            assert expected is None or blocked[e] == expected
            np.testing.assert_allclose(after[e, :2], before[e, :2] if blocked[e] else there, atol=1e-5)
    assert decided > 0.98 * EACH * len(WALKED)


def test_turns_are_by_45_degrees_and_never_blocked(stepped):
    pose = np.array([[1.0, 2.0, k * np.pi / 4] for k in range(8)])
    for action, turn in ((LEFT, 1), (RIGHT, -1)):
        before, after, blocked = stepped(ROOM, pose, np.full(8, action))
        quarter = np.round((after[:, 2] - before[:, 2]) / (np.pi / 4)) % 8
        assert (quarter == turn % 8).all()
        assert not blocked.any()
        np.testing.assert_array_equal(after[:, :2], before[:, :2])


def test_the_body_walks_through_a_door(stepped):
    pose = np.array([[1.5, 1.4, np.pi / 2]])
    for _ in range(10):
        _, pose, blocked = stepped(ROOM, pose, [FORWARD])
        assert not blocked
    assert pose[0, 1] < 0.7
    _, _, blocked = stepped(ROOM, [[0.7, 1.2, np.pi / 2]], [FORWARD])
    assert blocked


def test_a_body_that_touches_a_wall_slides_along_it(stepped):
    flush = DEFAULT.body[0] / 2
    pose = np.array([[flush, 2.0, np.pi / 2], [flush, 2.0, np.pi]])
    _, _, blocked = stepped(ROOM, pose, [FORWARD, FORWARD])
    assert blocked.tolist() == [False, True]
