"""Houses that are dealt: a learner says where next episodes take place, and nothing else changes."""

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
DEALT = np.array([3, 1, -1, 2, -1, 0])
BY_THEMSELVES = AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP
LOOPS = pytest.mark.parametrize("by_ray", [False, True])
MODES = pytest.mark.parametrize("mode", BY_THEMSELVES)


def make(mode: Any = AutoresetMode.NEXT_STEP, count: int = COUNT, **more: Any) -> HouseVectorEnv:
    arguments = {"targets": "mixed", "max_episode_steps": LENGTH, "autoreset_mode": mode}
    return HouseVectorEnv(HOUSES, num_envs=count, **(arguments | more))


def told(envs: HouseVectorEnv, plan: np.ndarray) -> list[list[np.ndarray]]:
    """What is told of each step of a plan, by environment in the first axis of each array."""
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
def test_episodes_that_begin_by_themselves_take_place_where_they_are_dealt(mode, by_ray):
    envs = make(mode, by_ray=by_ray)
    _, info = envs.reset(seed=2)
    first = LENGTH if mode is AutoresetMode.NEXT_STEP else LENGTH - 1
    envs.deal(DEALT)
    after = houses(told(envs, PLAN))
    np.testing.assert_array_equal(after[:first], np.tile(info["house"], (first, 1)))
    given = DEALT >= 0
    np.testing.assert_array_equal(after[first:, given], np.tile(DEALT[given], (STEPS - first, 1)))
    assert all(len(np.unique(column)) > 1 for column in after[:, ~given].T)


@LOOPS
@MODES
def test_other_environments_go_on_as_if_nothing_had_been_dealt(mode, by_ray):
    runs = []
    for dealt in (None, DEALT):
        envs = make(mode, by_ray=by_ray)
        envs.reset(seed=2)
        if dealt is not None:
            envs.deal(dealt)
        runs.append(told(envs, PLAN))
    assert same(*runs, where=DEALT < 0)
    assert not same(*runs, where=DEALT >= 0)


@MODES
def test_a_house_that_is_dealt_is_as_if_it_had_been_drawn(mode):
    usual = make(mode)
    usual.reset(seed=5)
    wanted, drawn = told(usual, PLAN), []
    envs = make(mode)
    envs.reset(seed=5)
    for actions, step in zip(PLAN, wanted, strict=True):
        envs.deal(step[6])
        drawn += told(envs, actions[None])
    assert same(drawn, wanted)


def test_a_deal_is_kept_until_the_next_one_and_minus_one_draws_again():
    envs = make()
    envs.reset(seed=0)
    envs.deal(np.full(COUNT, 2))
    assert (houses(told(envs, PLAN))[LENGTH:] == 2).all()
    envs.deal(torch.full((COUNT,), 1))
    assert (houses(told(envs, PLAN))[LENGTH + 1 :] == 1).all()
    envs.deal(np.full(COUNT, -1))
    assert len(np.unique(houses(told(envs, PLAN))[-1])) > 1


def test_episodes_that_a_reset_begins_are_dealt_too_but_for_its_options():
    envs = make(AutoresetMode.DISABLED)
    envs.deal(DEALT)
    _, info = envs.reset(seed=0)
    np.testing.assert_array_equal(info["house"][DEALT >= 0], DEALT[DEALT >= 0])
    told(envs, PLAN[:LENGTH])
    some = np.arange(COUNT) < 2
    envs.deal(np.full(COUNT, 1))
    _, later = envs.reset(options={"reset_mask": some})
    np.testing.assert_array_equal(later["house"], np.where(some, 1, info["house"]))
    option = np.array([0, 1, 2, 3, 0, 1])
    _, info = envs.reset(options={"house": option})
    np.testing.assert_array_equal(info["house"], option)
    assert (envs.reset()[1]["house"] == 1).all()


@MODES
def test_a_deal_is_part_of_the_state(mode):
    envs, other = make(mode), make(mode)
    envs.reset(seed=3)
    told(envs, PLAN[:3])
    envs.deal(DEALT)
    state = envs.state
    on = told(envs, PLAN)
    other.reset(seed=99)
    other.deal(np.full(COUNT, 3))
    for again in (envs, other):
        again.state = state
        assert same(told(again, PLAN), on)
        np.testing.assert_array_equal(again.state["deal"], DEALT)


def test_a_state_that_deals_another_banks_house_is_refused():
    envs = make()
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="a state of another bank: house 4 is dealt of 4"):
        envs.state = envs.state | {"deal": np.full(COUNT, 4, np.int32)}


def test_another_bank_ends_a_deal():
    envs = make()
    envs.reset(seed=0)
    envs.deal(np.full(COUNT, 3))
    envs.set_houses(HOUSES[:2])
    assert set(envs.reset(seed=0)[1]["house"].tolist()) == {0, 1}


WRONG = {
    "deal: 6 integers, found int64 (5,)": np.zeros(5, int),
    "deal: 6 integers, found int64 (6, 1)": np.zeros((6, 1), int),
    "deal: 6 integers, found float64 (6,)": np.zeros(6),
    "deal: 6 integers, found bool (6,)": np.zeros(6, bool),
    "deal: the bank has houses 0 to 3, or -1 to draw one": [0, 1, 2, 3, 4, 0],
    "deal: the bank has houses 0 to 3, or -1": [0, 1, 2, 3, -2, 0],
}


@pytest.mark.parametrize("message", WRONG)
def test_a_wrong_deal_is_refused_and_changes_nothing(message):
    envs = make()
    envs.deal(DEALT)
    with pytest.raises(ValueError, match=re.escape(message)):
        envs.deal(WRONG[message])
    np.testing.assert_array_equal(envs.state["deal"], DEALT)


@MODES
def test_the_batched_path_tells_the_house_without_a_copy(mode):
    envs, other = make(mode), make(mode)
    for each in (envs, other):
        each.reset(seed=4)
        each.deal(DEALT)
    before = None
    for actions in PLAN:
        house = envs.step_torch(torch.from_numpy(actions))[4]["house"]
        np.testing.assert_array_equal(house.numpy(), other.step(actions)[4]["house"])
        assert before is None or house.data_ptr() == before
        before = house.data_ptr()
