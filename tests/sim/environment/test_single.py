"""The environments in Gymnasium's interface, and every wrong use of them."""

import copy
import os
import pickle
import re
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from msgspec.structs import replace

from tests import sample_houses
from tests.programs import finished
from vitruvius.logic import House, save
from vitruvius.sim import HouseVectorEnv

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM), *sample_houses.RANDOM[:2]]
COUNT = 5


@pytest.fixture(scope="module")
def bank(tmp_path_factory):
    path = tmp_path_factory.mktemp("houses") / "houses.jsonl"
    save(HOUSES, path)
    return str(path)


@pytest.fixture(scope="module")
def made(bank):
    return gymnasium.make_vec("Vitruvius/House-v0", num_envs=COUNT, houses=bank, targets="mixed")


@pytest.fixture
def envs(made):
    made.reset(seed=0)
    return made.unwrapped


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.filterwarnings("ignore:.*already been instantiated.*")
def test_gymnasium_finds_nothing_wrong_with_the_single_environment(bank, preset):
    env = gymnasium.make("Vitruvius/House-v0", houses=bank, preset=preset, render_mode="rgb_array")
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


def test_step_returns_fresh_arrays(envs):
    first = envs.step(np.full(COUNT, 2))
    kept = [np.copy(array) for array in first[:4]]
    envs.step(np.zeros(COUNT, int))
    for array, same in zip(first[:4], kept, strict=True):
        np.testing.assert_array_equal(array, same)


def test_step_torch_returns_the_same_as_step_without_copies(envs):
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


def test_launch_runs_the_step_and_info_is_what_step_returned():
    one, other = (HouseVectorEnv(HOUSES, num_envs=COUNT) for _ in range(2))
    info = one.reset(seed=0)[1]
    other.reset(seed=0)
    for actions in PLAN:
        info = one.step(actions)[4]
        other.launch(actions)
    for name, value in one.state.items():
        np.testing.assert_array_equal(other.state[name], value)
    for name, value in info.items():
        np.testing.assert_array_equal(one.info()[name], value)


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


def test_houses_may_be_a_request_for_the_generator():
    generate = pytest.importorskip("vitruvius.logic.workers.generate")
    assert generate
    envs = HouseVectorEnv({"rooms": 2, "seed": 0, "count": 2})
    assert len(envs.houses) == 2


PLAN = np.random.default_rng(0).choice(3, p=[0.2, 0.2, 0.6], size=(20, COUNT))
HALF = 10


def outputs(envs, plan) -> list[np.ndarray]:
    """Return all outputs of each step of a plan (T, E)."""
    parts = []
    for actions in plan:
        *arrays, info = envs.step(actions)
        parts += [*arrays, *info.values()]
    return parts


@pytest.fixture(scope="module")
def usual(made):
    """Return the outputs without errors, and those of a reset after them."""
    made.reset(seed=0)
    parts = outputs(made, PLAN)
    observation, info = made.reset()
    return [*parts, observation, *info.values()]


@contextmanager
def unharmed(envs, usual, error, message):
    """Require an error, and the same outputs before and after it as without the call."""
    parts = outputs(envs, PLAN[:HALF])
    with pytest.raises(error, match=re.escape(message)):
        yield
    parts += outputs(envs, PLAN[HALF:])
    observation, info = envs.reset()
    for one, other in zip([*parts, observation, *info.values()], usual, strict=True):
        np.testing.assert_array_equal(one, other)


WRONG_ACTIONS = {
    "one for each of 5": np.zeros(4, int),
    "actions have shape (5, 1)": np.zeros((5, 1), int),
    "0 to 2, not 0 to 3": np.array([0, 1, 2, 3, 0]),
    "not -1": np.array([0, -1, 2, 1, 0]),
    "must be integers": np.zeros(5),
    "must be integers 0, 1 or 2, not bool": np.zeros(5, bool),
    "must be integers 0, 1 or 2, not object": [None] * 5,
}


@pytest.mark.parametrize("message", WRONG_ACTIONS)
def test_wrong_actions_are_refused_and_change_nothing(envs, usual, message):
    with unharmed(envs, usual, ValueError, message):
        envs.step(WRONG_ACTIONS[message])


WRONG_TENSORS = {
    "floats": (torch.zeros(5), "an int64 tensor on the device 'cpu'"),
    "short integers": (torch.zeros(5, dtype=torch.int32), "an int64 tensor on the device 'cpu'"),
    "too many": (torch.zeros(6).long(), "one for each of 5"),
    "no actions": (torch.full((5,), 3), "0 to 2, not 3 to 3"),
}


@pytest.mark.parametrize("name", WRONG_TENSORS)
def test_wrong_tensors_are_refused_and_change_nothing(envs, usual, name):
    actions, message = WRONG_TENSORS[name]
    with unharmed(envs, usual, ValueError, message):
        envs.step_torch(actions)


WRONG_OPTIONS = {
    "there is no reset option houses: did you mean house": {"houses": [0] * 5},
    "option house: give 5 integers": {"house": [0, 1]},
    "option house: give 5 integers, not float64 (5,)": {"house": [0.0] * 5},
    "option house: there are houses 0 to 2": {"house": [0, 1, 2, 3, 0]},
    "option pose: name the houses of": {"pose": np.zeros((5, 3))},
    "option pose: give finite numbers": {"house": [0] * 5, "pose": np.full((5, 3), np.nan)},
    "a multiple of pi/4": {"house": [0] * 5, "pose": np.full((5, 3), 0.1)},
    "pose 0: the robot cannot stand at (0.000, 0.000)": {"house": [0] * 5, "pose": np.zeros((5, 3))},
    "option target": {"target": np.zeros(2)},
    "option target: give finite numbers of shape (5, 2), not values that are not finite": {
        "target": np.full((5, 2), np.inf)
    },
    "option reset_mask: give 5 bools, not bool (4,)": {"reset_mask": np.ones(4, bool)},
    "option reset_mask: give 5 bools, not bool (5, 1)": {"reset_mask": np.ones((5, 1), bool)},
    "option reset_mask: give 5 bools, not int64 (5,)": {"reset_mask": np.ones(5, int)},
    "option reset_mask: every value is False, so": {"reset_mask": np.zeros(5, bool)},
}


@pytest.mark.parametrize("message", WRONG_OPTIONS)
def test_wrong_options_are_refused_and_change_nothing(envs, usual, message):
    with unharmed(envs, usual, ValueError, message):
        envs.reset(seed=9, options=WRONG_OPTIONS[message])


def test_wrong_seeds_are_refused_and_change_nothing(envs, usual):
    with unharmed(envs, usual, ValueError, "2 seeds for 5 environments"):
        envs.reset(seed=[1, 2])
    for wrong in (-1, 2**64, 1.5, True, [0, 1, 2, 3, 4.5], [0, 1, 2, 3, -4], [0, 1, 2, 3, "4"]):
        envs.reset(seed=0)
        last = wrong[-1] if isinstance(wrong, list) else wrong
        with unharmed(envs, usual, gymnasium.error.Error, f"to 2**64 - 1, not {last!r}"):
            envs.reset(seed=wrong)


CRAMPED = sample_houses.drawn("a+\n..", cell=0.5)
ROOM = HOUSES[0].star.rooms[0]


def with_floor(**changes) -> House:
    return sample_houses.changed_star(HOUSES[0], floor=replace(HOUSES[0].star.floor, **changes))


def with_room(**changes) -> House:
    return sample_houses.changed_star(HOUSES[0], rooms=(replace(ROOM, **changes),))


WRONG_HOUSES = {
    "list of houses is empty": [],
    "a list of House, not of str": ["house"],
    "a list of House, not of NoneType": [HOUSES[0], None],
    "house 1 of 2: the robot cannot reach room R0 (bedroom)": [HOUSES[0], CRAMPED],
    "house 0 of 1: the main room is at (nan, ": [
        sample_houses.changed_star(HOUSES[0], floor=replace(HOUSES[0].star.floor, x=np.nan))
    ],
    "house 1 of 2: room R0 is at (0.0, 0.0), inf x ": [HOUSES[0], with_room(width=np.inf)],
    "house 0 of 1: the door of room R0 is at": [with_room(door=replace(ROOM.door, height=np.nan))],
    "house 0 of 1: a table in room R0 is at": [with_room(children=(replace(ROOM.children[0], width=-0.1),))],
    "house 0 of 1: the main room extends more than 512": [sample_houses.drawn("a+a\n...\n...", cell=200.0)],
    "house 0 of 1: the robot finds no place to stand in the main room": [with_floor(width=0.2, height=0.2)],
}


@pytest.mark.parametrize("message", WRONG_HOUSES)
def test_wrong_houses_are_refused_and_change_nothing(envs, usual, message):
    with unharmed(envs, usual, ValueError, message):
        envs.set_houses(WRONG_HOUSES[message])
    with pytest.raises(ValueError, match=re.escape(message)):
        HouseVectorEnv(WRONG_HOUSES[message], targets="mixed")


def test_a_wrong_state_is_refused_and_changes_nothing(envs, usual):
    good = envs.state
    lost = np.full_like(good["wholes"], len(HOUSES))
    wrong = {
        "the state has other dtypes or shapes: this": HouseVectorEnv(HOUSES, num_envs=COUNT + 1).state,
        "the state has other dtypes": {name: array for name, array in good.items() if name != "flags"},
        "<f4": good | {"reals": good["reals"].astype(float)},
        "the state belongs to other houses: a robot is in house 3, and there are 3": good | {"wholes": lost},
        "the state is invalid: a robot or a": good | {"reals": good["reals"] + 200},
        "target is outside its house": good
        | {"reals": good["reals"] * np.array([1, 1, np.nan, 1], np.float32)},
        "invalid: a robot has no heading": good | {"wholes": good["wholes"] + np.eye(1, 10, 9, np.int32) * 8},
    }
    for message, state in wrong.items():
        envs.reset(seed=0)
        with unharmed(envs, usual, ValueError, message):
            envs.state = state


def test_after_a_given_pose_and_a_step_an_environment_goes_on_from_its_state_and_as_a_copy(envs):
    _, info = envs.reset(seed=0)
    pose = info["pose"]
    pose[:, 2] = np.pi  # west: cells count from the pose
    envs.reset(options={"house": info["house"], "pose": pose})
    envs.step(np.full(COUNT, 2))
    copies, state = [pickle.loads(pickle.dumps(envs)), copy.deepcopy(envs)], envs.state
    after = envs.step(np.full(COUNT, 2))[0]
    envs.state = state
    for each in (envs, *copies):
        np.testing.assert_array_equal(each.step(np.full(COUNT, 2))[0], after)


def test_the_grid_backend_refuses_other_banks_and_goes_on_as_before():
    text = "aaaaa.bbb\naa+aa.bbb\n......+bb\n......bbb\n......bbb"
    envs = HouseVectorEnv([sample_houses.drawn(text, cell=0.45)], num_envs=COUNT, backend="grid")
    envs.reset(seed=0)
    usual = outputs(envs, PLAN)
    observation, info = envs.reset()
    usual += [observation, *info.values()]
    for house, message in (
        (sample_houses.RANDOM[0], "no grid with cells as wide as the robot,"),
        (sample_houses.drawn(text, cell=0.5), "these houses need another body size and step"),
    ):
        envs.reset(seed=0)
        with unharmed(envs, usual, ValueError, message):
            envs.set_houses([house])


def test_with_autoreset_disabled_an_ended_environment_needs_a_reset():
    envs = HouseVectorEnv(HOUSES, COUNT, targets="mixed", max_episode_steps=HALF, autoreset_mode="Disabled")
    stories = []
    for misuse in (False, True):
        envs.reset(seed=0)
        parts = outputs(envs, PLAN[:HALF])
        if misuse:
            message = "the episode of environment 0"
            with pytest.raises(ResetNeeded, match=message):
                envs.step(PLAN[HALF])
            with pytest.raises(ResetNeeded, match=message):
                envs.step_torch(torch.zeros(COUNT).long())
            with pytest.raises(ValueError, match="option reset_mask: give 5 bools"):
                envs.reset(options={"reset_mask": np.ones(COUNT + 1, bool)})
            some = np.arange(COUNT) > 0
            state = envs.state
            envs.reset(options={"reset_mask": some})
            with pytest.raises(ResetNeeded, match=message):
                envs.step(PLAN[HALF])
            envs.state = state
        envs.reset(options={"reset_mask": np.ones(COUNT, bool)})
        stories.append([*parts, *outputs(envs, PLAN[HALF:])])
    for one, other in zip(*stories, strict=True):
        np.testing.assert_array_equal(one, other)


NO_CUDA = """
from vitruvius.sim import HouseVectorEnv
from tests import sample_houses

try:
    HouseVectorEnv(sample_houses.RANDOM[:1], device="cuda")
except ValueError as error:
    print(error)
HouseVectorEnv(sample_houses.RANDOM[:1]).reset(seed=0)
print("went on")
"""


def test_cuda_is_refused_where_there_is_none_and_the_cpu_still_works():
    done = subprocess.run(
        [sys.executable, "-c", NO_CUDA],
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parents[3],
        env=os.environ | {"CUDA_VISIBLE_DEVICES": ""},
    )
    assert done.stdout.splitlines()[0].startswith("device 'cuda' cannot be used: ")
    assert done.stdout.splitlines()[1:] == ["went on"]
    assert done.stderr == ""


WRONG_ARGUMENTS = {
    "there is no backend grids: did you mean grid? There are continuous, free, grid, or module:Class": {
        "backend": "grids"
    },
    "backend 'sim.grids:Grid' cannot be used": {"backend": "sim.grids:Grid"},
    "there is no task any: there are main, secondary, mixed, all": {"targets": "any"},
    "there is no preset papers: did you mean paper": {"preset": "papers"},
    "num_envs is 0": {"num_envs": 0},
    "a path, a request or a list of House, not House": {"houses": HOUSES[0]},
    "max_episode_steps is 0": {"max_episode_steps": 0},
    "max_episode_steps is 2147483648: it must be 1 to 2,147,483,647": {"max_episode_steps": 2**31},
    "max_episode_steps must be a whole number, not 1.5": {"max_episode_steps": 1.5},
    "unknown render_mode 'ansi'": {"render_mode": "ansi"},
    "there is no device tpu: did you mean cpu": {"device": "tpu"},
    "device 'cuda' cannot be used": {"device": "cuda"},
    "there is no autoreset_mode Sometimes: there are NextStep, SameStep, Disabled": {
        "autoreset_mode": "Sometimes"
    },
}


@pytest.mark.parametrize("message", WRONG_ARGUMENTS)
def test_wrong_arguments_are_refused(message):
    with pytest.raises(ValueError, match=re.escape(message)):
        HouseVectorEnv(**({"houses": HOUSES} | WRONG_ARGUMENTS[message]))


def test_step_and_render_before_the_first_reset_are_errors(bank):
    env = gymnasium.make("Vitruvius/House-v0", houses=bank, max_episode_steps=None).unwrapped
    with pytest.raises(ResetNeeded):
        env.step(0)
    envs = HouseVectorEnv(HOUSES, max_episode_steps=1, render_mode="rgb_array")
    with pytest.raises(ResetNeeded):
        envs.render()


def test_a_single_environment_that_has_ended_asks_for_a_reset(bank):
    env = gymnasium.make("Vitruvius/House-v0", houses=bank, preset="paper").unwrapped
    env.reset(seed=0)
    terminated = False
    while not terminated:
        _, _, terminated, _, _ = env.step(2)
    with pytest.raises(ResetNeeded):
        env.step(2)
    env.reset()
    env.step(2)


def test_importing_and_starting_print_nothing_and_ask_nobody_for_a_newer_version(bank):
    watch = "getattr(ti, '_version_check', os).try_check_version = lambda: os.write(1, b'asked')"
    program = (
        "import os; from vitruvius.sim import HouseVectorEnv; from vitruvius.sim.runtime import ti; "
        f"{watch}; HouseVectorEnv({bank!r}).reset(seed=0)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == done.stderr == ""


def test_a_reward_in_an_episodes_last_step_is_not_given_again_as_the_next_begins():
    envs = HouseVectorEnv([sample_houses.drawn(sample_houses.ONE_ROOM)], max_episode_steps=1)
    here = {"house": [0], "pose": [[4.5, 1.35, 0.0]], "target": [[4.95, 1.35]]}
    envs.reset(seed=0, options=here)
    _, reward, _, truncated, _ = envs.step(np.array([2]))
    assert (reward[0], truncated[0]) == (1, True)
    _, reward, _, truncated, _ = envs.step(np.array([2]))
    assert (reward[0], truncated[0]) == (0, False)


def test_pickled_environments_go_on_bit_for_bit():
    envs = HouseVectorEnv(HOUSES[:1], num_envs=3, max_episode_steps=9, render_mode="rgb_array")
    fresh = pickle.loads(pickle.dumps(envs))
    envs.set_houses(HOUSES, targets="mixed")
    envs.reset(seed=5)
    envs.step(np.array([2, 0, 1]))
    again = pickle.loads(pickle.dumps(envs))
    for action in range(20):
        actions = np.array([2, action % 3, 0])
        for one, other in zip(envs.step(actions), again.step(actions), strict=True):
            np.testing.assert_equal(one, other)
    assert (fresh.num_envs, fresh.render_mode, len(fresh.houses)) == (3, "rgb_array", 1)
    with pytest.raises(ResetNeeded):
        fresh.step(np.zeros(3, int))


def test_after_close_to_step_or_reset_is_an_error():
    env = gymnasium.make("Vitruvius/House-v0", houses=HOUSES[:1])
    env.reset(seed=0)
    env.close()
    for act in (env.reset, lambda: env.step(2)):
        with pytest.raises(ClosedEnvironmentError, match="was closed: make a new one"):
            act()


FORKED = """
import os, numpy
from vitruvius import sim
from tests.sim.environment.test_single import HOUSES
envs = sim.HouseVectorEnv(HOUSES[:1])
envs.reset(seed=0)
if os.fork():
    os._exit(os.waitstatus_to_exitcode(os.wait()[1]))
for act in (lambda: envs.step(numpy.zeros(1, int)), lambda: sim.HouseVectorEnv(HOUSES[:1])):
    try:
        act()
    except RuntimeError as error:
        print(error, flush=True)
os._exit(7)
"""


def test_in_a_fork_of_a_process_that_ran_environments_all_is_one_clear_error():
    command = [sys.executable, "-c", FORKED]
    done = finished(command)
    assert done.returncode == 7, done.stderr
    assert done.stdout.count("start processes by 'spawn'") == 2
