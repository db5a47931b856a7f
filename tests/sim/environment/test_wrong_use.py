"""Unusual or wrong seeds, options, arguments and uses: they work as in Gymnasium, or are refused."""

import copy
import pickle
import re
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from gymnasium.error import ClosedEnvironmentError, Error

from tests import sample_houses
from vitruvius.logic import load
from vitruvius.sim import DEFAULT, HouseEnv, HouseVectorEnv

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM)]


@pytest.fixture(scope="module")
def envs() -> HouseVectorEnv:
    return HouseVectorEnv(HOUSES, 2)


@pytest.fixture(scope="module")
def env() -> HouseEnv:
    return HouseEnv(HOUSES)


@pytest.mark.parametrize("seed", [np.int64(3), np.uint8(3), np.array(3)], ids=repr)
def test_seeds_are_numbers_of_numpy_too(env: HouseEnv, envs: HouseVectorEnv, seed: Any) -> None:
    for one in (env, envs):
        np.testing.assert_array_equal(one.reset(seed=seed)[0], one.reset(seed=3)[0])
        assert one.np_random_seed == 3


def test_an_environment_without_a_seed_of_its_own_goes_on(envs: HouseVectorEnv) -> None:
    """As in Gymnasium's vector environments, ``None`` among seeds means no new seed."""
    envs.reset(seed=[5, 6])
    expected = envs.reset()[0]
    envs.reset(seed=[5, 6])
    found = envs.reset(seed=[9, None])[0]
    np.testing.assert_array_equal(found[1], expected[1])
    np.testing.assert_array_equal(found[0], envs.reset(seed=9)[0][0])
    new = HouseVectorEnv(HOUSES, 2)
    np.testing.assert_array_equal(new.reset(seed=[9, None])[0][0], found[0])


SEEDS = [-1, 2**64, 3.0, True, "33", {}, np.array(3.5), [1, -1], [1.0, 2], np.array([1.0, 2.0])]


@pytest.mark.parametrize("seed", SEEDS, ids=repr)
def test_wrong_seeds_are_refused_when_they_are_given(envs: HouseVectorEnv, seed: Any) -> None:
    for use in (envs.reset, lambda seed: HouseVectorEnv(HOUSES, 2, seed=seed)):
        with pytest.raises(Error, match="a seed is a whole number from 0 to 2"):
            use(seed=seed)
    if not isinstance(seed, list):
        with pytest.raises(Error, match="a seed is a whole number from 0 to 2"):
            HouseEnv(HOUSES, seed=seed)


OF_ONE = {
    "options must be a dict": "house",
    "option house: give shape (), not (1,)": {"house": [0]},
    "option pose: give shape (3,), not (2,)": {"house": 0, "pose": [1, 2]},
    "option pose: give shape (3,), not ()": {"house": 0, "pose": "abc"},
    "option target: give finite numbers of shape (1, 2), not": {"target": ["a", "b"]},
    "option target: give shape (2,), not (3,)": {"target": [1, 2, 3]},
    "there is no reset option houses: did you mean house": {"houses": 0},
}
OF_MANY = {
    "options must be a dict": ["house"],
    "option house: the rows differ in length": {"house": [[0], [0, 0]]},
    "option house: give 2 integers, not int64 ()": {"house": 0},
    "option pose: give finite numbers of shape (2, 3), not [[": {
        "house": [0, 0],
        "pose": [[1, 2, 3], [1, 2]],
    },
    "option target: give finite numbers of shape (2, 2), not": {"target": "abc"},
    "shape (2, 2), not [['1', '2'], ['3', '4']]": {"target": [["1", "2"], ["3", "4"]]},
    "not values that are not finite or too far away": {"target": [[1, 2], [3, 1e300]]},
}


@pytest.mark.parametrize("message", OF_ONE)
def test_wrong_options_of_one_are_refused_in_words(env: HouseEnv, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        env.reset(seed=0, options=OF_ONE[message])


@pytest.mark.parametrize("message", OF_MANY)
def test_wrong_options_of_many_are_refused_in_words(envs: HouseVectorEnv, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        envs.reset(seed=0, options=OF_MANY[message])


def test_options_that_are_none_are_left_out(env: HouseEnv) -> None:
    options = {"house": None, "pose": None, "target": None, "reset_mask": None}
    np.testing.assert_array_equal(env.reset(seed=1, options=options)[0], env.reset(seed=1)[0])


ARGUMENTS = {
    "num_envs is 0: it must be 1 to": {"num_envs": 0},
    "num_envs must be a whole number, not 2.0": {"num_envs": 2.0},
    "num_envs must be a whole number, not True": {"num_envs": True},
    "num_envs is 1000000000000: it must be 1 to 16,777,216": {"num_envs": 10**12},
    "backend must be a name, one of continuous, free, grid or module:Class, not None": {"backend": None},
    "there is no autoreset_mode same: did you mean SameStep": {"autoreset_mode": "same"},
    "there is no preset ['steps']": {"preset": ["steps"]},
    "there is no device cuda:1": {"device": torch.device("cuda:1")},
}


@pytest.mark.parametrize("message", ARGUMENTS)
def test_wrong_arguments_are_refused_in_words(message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        HouseVectorEnv(**({"houses": HOUSES} | ARGUMENTS[message]))


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("rays", "40", "a whole number, not '40'"),
        ("steps", 1e6, "a whole number, not 1000000.0"),
        ("range", None, "a number, not None"),
        ("sees_kind", "no", "True or False, not 'no'"),
    ],
)
def test_values_of_a_configuration_are_of_their_fields_type(field: str, value: Any, words: str) -> None:
    with pytest.raises(ValueError, match=f"{field} must be {words}"):
        replace(DEFAULT, **{field: value})
    assert replace(DEFAULT, rays=np.int64(8), noise=np.float32(0.5), sees_kind=np.True_).rays == 8


@pytest.mark.parametrize("state", [{}, {"a": 1}])
def test_a_wrong_state_or_count_is_refused_in_words(envs: HouseVectorEnv, state: Any) -> None:
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="the state has other dtypes or shapes: this environment has"):
        envs.state = state
    for count in (-1, 0, "x"):
        with pytest.raises(ValueError, match="count "):
            envs.targets(count)  # pyright: ignore[reportArgumentType]


def test_a_mask_may_be_a_list(envs: HouseVectorEnv) -> None:
    envs.reset(seed=0)
    envs.reset(options={"reset_mask": [True, False]})


def test_torchs_devices_are_devices() -> None:
    assert HouseVectorEnv(HOUSES, device=torch.device("cpu")).device == "cpu"  # pyright: ignore


def test_one_environment_says_who_shows_it_in_a_window() -> None:
    with pytest.raises(
        ValueError, match=r"render_mode 'human': use gymnasium.make, which opens a window for"
    ):
        HouseEnv(HOUSES, render_mode="human")


@pytest.mark.parametrize("action", [[1], np.array([1]), torch.tensor([1])], ids=repr)
def test_an_action_of_one_environment_has_no_axis(env: HouseEnv, action: Any) -> None:
    env.reset(seed=0)
    with pytest.raises(
        ValueError, match=r"an action must be one integer, 0, 1 or 2, not an array of shape \(1,\)"
    ):
        env.step(action)


@pytest.mark.parametrize("how", [pickle.dumps, copy.deepcopy])
def test_a_copy_goes_on_with_all_random_numbers(how: Any) -> None:
    envs = HouseVectorEnv(HOUSES, 2)
    envs.reset(seed=5)
    envs.action_space.seed(3)
    envs.step([1, 2])
    again = how(envs)
    again = pickle.loads(again) if isinstance(again, bytes) else again
    assert again.np_random_seed == envs.np_random_seed == 5
    assert again.np_random.random() == envs.np_random.random()
    for _ in range(5):
        actions = envs.action_space.sample()
        np.testing.assert_array_equal(again.action_space.sample(), actions)
        np.testing.assert_array_equal(again.step(actions)[0], envs.step(actions)[0])


def test_closed_environments_do_nothing() -> None:
    envs = HouseVectorEnv(HOUSES, render_mode="rgb_array")
    env = HouseEnv(HOUSES, render_mode="rgb_array")
    for each in (envs, env):
        each.reset(seed=0)
        each.close()
        each.close()
    uses = [envs.render, env.render, lambda: envs.targets(2), lambda: envs.set_houses(HOUSES)]
    for use in uses:
        with pytest.raises(ClosedEnvironmentError):
            use()


def test_a_packed_file_is_closed_when_it_is_read() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load(Path(__file__).parents[3] / "sim/environment/houses.jsonl.gz")
