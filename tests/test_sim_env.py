"""The environments as Gymnasium has them, and every wrong use of them."""

import re
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from msgspec.structs import replace

from logic import save
from sim import Config, HouseVectorEnv
from tests import worlds

HOUSES = [worlds.drawn(worlds.ONE_ROOM), *worlds.RANDOM[:2]]
COUNT = 5


@pytest.fixture(scope="module")
def bank(tmp_path_factory):
    path = tmp_path_factory.mktemp("houses") / "houses.jsonl"
    save(HOUSES, path)
    return str(path)


@pytest.fixture(scope="module")
def made(bank):
    return gymnasium.make_vec("sim:Vitruvius/House-v0", num_envs=COUNT, houses=bank, targets="mixed")


@pytest.fixture
def envs(made):
    made.reset(seed=0)
    return made.unwrapped


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.filterwarnings("ignore:.*already been instantiated.*")
def test_gymnasium_finds_nothing_wrong_with_the_single_environment(bank, preset):
    env = gymnasium.make("sim:Vitruvius/House-v0", houses=bank, preset=preset, render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


def test_the_spec_makes_the_environment_again(made):
    again = gymnasium.make_vec(EnvSpec.from_json(made.spec.to_json()))
    ours, theirs = made.reset(seed=3)[0], again.reset(seed=3)[0]
    np.testing.assert_array_equal(ours, theirs)


def test_spaces_and_metadata_are_complete(envs):
    assert envs.single_observation_space.shape == (40, 2)
    assert envs.observation_space.shape == (COUNT, 40, 2)
    assert envs.action_space.nvec.tolist() == [3] * COUNT
    assert envs.metadata["autoreset_mode"] is envs.autoreset_mode is AutoresetMode.NEXT_STEP
    observation, info = envs.reset(seed=0)
    assert envs.observation_space.contains(observation)
    shapes = {key: value.shape for key, value in info.items()}
    assert shapes == {"pose": (COUNT, 3), "blocked": (COUNT,), "house": (COUNT,), "target": (COUNT, 2)}


def test_what_step_returns_is_the_callers_own(envs):
    first = envs.step(np.full(COUNT, 2))
    kept = [np.copy(array) for array in first[:4]]
    envs.step(np.zeros(COUNT, int))
    for array, copy in zip(first[:4], kept, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_tensors_say_the_same_and_are_not_copied(envs):
    plan = np.random.default_rng(0).integers(0, 3, (30, COUNT))
    by_arrays = [envs.step(action) for action in plan]
    envs.reset(seed=0)
    before = None
    for action, (observation, reward, terminated, truncated, info) in zip(plan, by_arrays, strict=True):
        out = envs.step_torch(torch.from_numpy(action))
        for tensor, array in zip(out[:4], (observation, reward, terminated, truncated), strict=True):
            np.testing.assert_array_equal(tensor.numpy(), array)
        np.testing.assert_array_equal(out[4]["blocked"].numpy(), info["blocked"])
        assert before is None or out[0].data_ptr() == before
        before = out[0].data_ptr()


def test_options_give_each_environment_its_house_pose_and_target(envs):
    house = np.array([0, 1, 2, 0, 1])
    _, drawn = envs.reset(seed=4, options={"house": house})
    pose, target = drawn["pose"].copy(), drawn["target"] + 0.125
    options = {"house": house, "pose": pose, "target": target}
    _, info = envs.reset(seed=5, options=options)
    np.testing.assert_array_equal(info["house"], house)
    np.testing.assert_allclose(info["pose"], pose, atol=1e-6)
    np.testing.assert_array_equal(info["target"], target)
    assert options.keys() == {"house", "pose", "target"}


def test_a_request_is_generated():
    generate = pytest.importorskip("logic.generate")
    assert generate
    envs = HouseVectorEnv({"rooms": 2, "seed": 0, "count": 2})
    assert len(envs.houses) == 2


WRONG_ACTIONS = {
    "one for each of 5": np.zeros(4, int),
    "go from 0 to 2, found 0 to 3": np.array([0, 1, 2, 3, 0]),
    "found -1": np.array([0, -1, 2, 1, 0]),
    "must be integers": np.zeros(5),
}


@pytest.mark.parametrize("message", WRONG_ACTIONS)
def test_wrong_actions_are_refused_and_change_nothing(envs, message):
    before = envs._info()["pose"]
    with pytest.raises(ValueError, match=message):
        envs.step(WRONG_ACTIONS[message])
    np.testing.assert_array_equal(envs._info()["pose"], before)


@pytest.mark.parametrize(
    "actions", [torch.zeros(5), torch.zeros(5, dtype=torch.int32), torch.zeros(10).long()[::2]]
)
def test_wrong_tensors_are_refused(envs, actions):
    with pytest.raises(ValueError, match="contiguous int64 tensor"):
        envs.step_torch(actions)


WRONG_OPTIONS = {
    "unknown reset option 'houses'": {"houses": [0] * 5},
    "option house: 5 integers": {"house": [0, 1]},
    "the bank has houses 0 to 2": {"house": [0, 1, 2, 3, 0]},
    "say in which houses": {"pose": np.zeros((5, 3))},
    "option pose: finite numbers": {"house": [0] * 5, "pose": np.full((5, 3), np.nan)},
    "a multiple of pi/4": {"house": [0] * 5, "pose": np.full((5, 3), 0.1)},
    "pose 0: the body cannot be at (0.000, 0.000)": {"house": [0] * 5, "pose": np.zeros((5, 3))},
    "option target": {"target": np.zeros(2)},
}


@pytest.mark.parametrize("message", WRONG_OPTIONS)
def test_wrong_options_are_refused_and_change_nothing(envs, message):
    before = envs._info()["pose"]
    with pytest.raises(ValueError, match=re.escape(message)):
        envs.reset(seed=9, options=WRONG_OPTIONS[message])
    np.testing.assert_array_equal(envs._info()["pose"], before)


CRAMPED = worlds.drawn("a+\n..", cell=0.5)
WRONG_ARGUMENTS = {
    "the bank is empty": {"houses": []},
    "a list of House, not of str": {"houses": ["house"]},
    "unknown backend 'grids': there are continuous, grid, or module:Class": {"backend": "grids"},
    "backend 'sim.grids:Grid' cannot be had": {"backend": "sim.grids:Grid"},
    "unknown targets 'all': there are main, secondary, mixed": {"targets": "all"},
    "unknown preset 'papers'": {"preset": "papers"},
    "num_envs is 0": {"num_envs": 0},
    "max_episode_steps is 0": {"max_episode_steps": 0},
    "unknown render_mode 'human'": {"render_mode": "human"},
    "'Sometimes' is not a valid AutoresetMode": {"autoreset_mode": "Sometimes"},
    "house 1 of 2: the body cannot reach room R0 (bedroom)": {
        "houses": [HOUSES[0], CRAMPED],
        "targets": "secondary",
    },
}


@pytest.mark.parametrize("message", WRONG_ARGUMENTS)
def test_wrong_arguments_are_refused(message):
    with pytest.raises(ValueError, match=re.escape(message)):
        HouseVectorEnv(**({"houses": HOUSES} | WRONG_ARGUMENTS[message]))


@pytest.mark.parametrize(
    ("message", "wrong"),
    [
        ("must divide 45", {"ray_spacing": 2}),
        ("positive lengths", {"step": 0.0}),
        ("at least one", {"rays": 0}),
        ("unknown collision", {"collision": "none"}),
    ],
)
def test_a_configuration_that_no_world_can_have_is_refused(message, wrong):
    with pytest.raises(ValueError, match=message):
        Config(**wrong)


def test_a_house_too_far_from_the_origin_is_refused():
    house = worlds.drawn("a+a\n...\n...", cell=40.0)
    with pytest.raises(ValueError, match="house 0 of 1: it reaches further than 100 m"):
        HouseVectorEnv([house])


def test_a_house_whose_main_room_is_too_small_to_stand_in_is_refused():
    house = replace(HOUSES[0], floor=replace(HOUSES[0].floor, width=0.2, height=0.2))
    with pytest.raises(ValueError, match="nowhere to stand in the main room"):
        HouseVectorEnv([house])


def test_steps_and_pictures_wait_for_a_reset(bank):
    env = gymnasium.make("sim:Vitruvius/House-v0", houses=bank, max_episode_steps=None).unwrapped
    with pytest.raises(ResetNeeded):
        env.step(0)
    envs = HouseVectorEnv(HOUSES, max_episode_steps=1, render_mode="rgb_array")
    with pytest.raises(ResetNeeded):
        envs.render()


def test_a_single_environment_that_has_ended_asks_for_a_reset(bank):
    env = gymnasium.make("sim:Vitruvius/House-v0", houses=bank, preset="paper").unwrapped
    env.reset(seed=0)
    terminated = False
    while not terminated:
        _, _, terminated, _, _ = env.step(2)
    with pytest.raises(ResetNeeded):
        env.step(2)
    env.reset()
    env.step(2)


def test_importing_and_starting_print_nothing(bank):
    program = f"import sim; sim.HouseVectorEnv({bank!r}).reset(seed=0)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == done.stderr == ""
