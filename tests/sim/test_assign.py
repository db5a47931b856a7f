"""`assign` sets the houses of the next episodes, and changes nothing else."""

import re
from typing import Any

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode

from sim import HouseVectorEnv
from tests import worlds

HOUSES = worlds.RANDOM[:4]
COUNT, LENGTH, STEPS = 6, 7, 40
PLAN = np.random.default_rng(1).choice(3, p=[0.2, 0.2, 0.6], size=(STEPS, COUNT))
ASSIGNED = np.array([3, 1, -1, 2, -1, 0])
AUTOMATIC = AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP
LOOPS = pytest.mark.parametrize("by_ray", [False, True])
MODES = pytest.mark.parametrize("mode", AUTOMATIC)


def make(mode: Any = AutoresetMode.NEXT_STEP, count: int = COUNT, **more: Any) -> HouseVectorEnv:
    arguments = {"targets": "mixed", "max_episode_steps": LENGTH, "autoreset_mode": mode}
    return HouseVectorEnv(HOUSES, num_envs=count, **(arguments | more))


def outputs(envs: HouseVectorEnv, plan: np.ndarray) -> list[list[np.ndarray]]:
    """What each step of a plan returns, by environment in the first axis of each array."""
    steps = []
    for actions in plan:
        observation, reward, terminated, truncated, info = envs.step(actions)
        arrays = [info[name] for name in ("pose", "blocked", "house", "target")]
        steps.append([observation, reward, terminated, truncated, *arrays])
    return steps


def same(one: list[list[np.ndarray]], two: list[list[np.ndarray]], where: Any = ...) -> bool:
    pairs = [pair for steps in zip(one, two, strict=True) for pair in zip(*steps, strict=True)]
    return all(np.array_equal(a[where], b[where]) for a, b in pairs)


def houses(steps: list[list[np.ndarray]]) -> np.ndarray:
    """The house of each environment after each step (T, E)."""
    return np.array([step[6] for step in steps])


@LOOPS
@MODES
def test_autoreset_begins_episodes_in_the_assigned_houses(mode, by_ray):
    envs = make(mode, by_ray=by_ray)
    _, info = envs.reset(seed=2)
    first = LENGTH if mode is AutoresetMode.NEXT_STEP else LENGTH - 1
    envs.assign(ASSIGNED)
    after = houses(outputs(envs, PLAN))
    np.testing.assert_array_equal(after[:first], np.tile(info["house"], (first, 1)))
    given = ASSIGNED >= 0
    np.testing.assert_array_equal(after[first:, given], np.tile(ASSIGNED[given], (STEPS - first, 1)))
    assert all(len(np.unique(column)) > 1 for column in after[:, ~given].T)


@LOOPS
@MODES
def test_environments_without_an_assigned_house_go_on_as_if_assign_had_not_been_called(mode, by_ray):
    runs = []
    for assigned in (None, ASSIGNED):
        envs = make(mode, by_ray=by_ray)
        envs.reset(seed=2)
        if assigned is not None:
            envs.assign(assigned)
        runs.append(outputs(envs, PLAN))
    assert same(*runs, where=ASSIGNED < 0)
    assert not same(*runs, where=ASSIGNED >= 0)


@MODES
def test_an_episode_in_an_assigned_house_equals_one_whose_house_was_sampled(mode):
    usual = make(mode)
    usual.reset(seed=5)
    expected, found = outputs(usual, PLAN), []
    envs = make(mode)
    envs.reset(seed=5)
    for actions, step in zip(PLAN, expected, strict=True):
        envs.assign(step[6])
        found += outputs(envs, actions[None])
    assert same(found, expected)


def test_assigned_houses_hold_until_the_next_assign_and_minus_one_samples_again():
    envs = make()
    envs.reset(seed=0)
    envs.assign(np.full(COUNT, 2))
    assert (houses(outputs(envs, PLAN))[LENGTH:] == 2).all()
    envs.assign(torch.full((COUNT,), 1))
    assert (houses(outputs(envs, PLAN))[LENGTH + 1 :] == 1).all()
    envs.assign(np.full(COUNT, -1))
    assert len(np.unique(houses(outputs(envs, PLAN))[-1])) > 1


def test_reset_uses_assigned_houses_unless_its_option_house_says_otherwise():
    envs = make(AutoresetMode.DISABLED)
    envs.assign(ASSIGNED)
    _, info = envs.reset(seed=0)
    np.testing.assert_array_equal(info["house"][ASSIGNED >= 0], ASSIGNED[ASSIGNED >= 0])
    outputs(envs, PLAN[:LENGTH])
    some = np.arange(COUNT) < 2
    envs.assign(np.full(COUNT, 1))
    _, later = envs.reset(options={"reset_mask": some})
    np.testing.assert_array_equal(later["house"], np.where(some, 1, info["house"]))
    option = np.array([0, 1, 2, 3, 0, 1])
    _, info = envs.reset(options={"house": option})
    np.testing.assert_array_equal(info["house"], option)
    assert (envs.reset()[1]["house"] == 1).all()


@MODES
def test_assigned_houses_are_part_of_the_state(mode):
    envs, other = make(mode), make(mode)
    envs.reset(seed=3)
    outputs(envs, PLAN[:3])
    envs.assign(ASSIGNED)
    state = envs.state
    on = outputs(envs, PLAN)
    other.reset(seed=99)
    other.assign(np.full(COUNT, 3))
    for again in (envs, other):
        again.state = state
        assert same(outputs(again, PLAN), on)
        np.testing.assert_array_equal(again.state["assigned"], ASSIGNED)


def test_a_state_that_assigns_a_house_outside_the_bank_is_refused():
    envs = make()
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="a state of another bank: house 4 is assigned of 4"):
        envs.state = envs.state | {"assigned": np.full(COUNT, 4, np.int32)}


def test_set_houses_clears_assigned_houses():
    envs = make()
    envs.reset(seed=0)
    envs.assign(np.full(COUNT, 3))
    envs.set_houses(HOUSES[:2])
    assert set(envs.reset(seed=0)[1]["house"].tolist()) == {0, 1}


WRONG = {
    "assign: 6 integers, found int64 (5,)": np.zeros(5, int),
    "assign: 6 integers, found int64 (6, 1)": np.zeros((6, 1), int),
    "assign: 6 integers, found float64 (6,)": np.zeros(6),
    "assign: 6 integers, found bool (6,)": np.zeros(6, bool),
    "assign: the bank has houses 0 to 3, or -1 to sample one": [0, 1, 2, 3, 4, 0],
    "assign: the bank has houses 0 to 3, or -1": [0, 1, 2, 3, -2, 0],
}


@pytest.mark.parametrize("message", WRONG)
def test_assign_refuses_wrong_houses_and_changes_nothing(message):
    envs = make()
    envs.assign(ASSIGNED)
    with pytest.raises(ValueError, match=re.escape(message)):
        envs.assign(WRONG[message])
    np.testing.assert_array_equal(envs.state["assigned"], ASSIGNED)


@MODES
def test_step_torch_returns_the_house_without_a_copy(mode):
    envs, other = make(mode), make(mode)
    for each in (envs, other):
        each.reset(seed=4)
        each.assign(ASSIGNED)
    before = None
    for actions in PLAN:
        house = envs.step_torch(torch.from_numpy(actions))[4]["house"]
        np.testing.assert_array_equal(house.numpy(), other.step(actions)[4]["house"])
        assert before is None or house.data_ptr() == before
        before = house.data_ptr()
