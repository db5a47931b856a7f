"""Window of a planner's map as an observation, compared with the planner's own map. 45 s."""

import re
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

from tests.sample_houses import random_house
from tests.sim.conformance.autoreset import check_autoreset_modes
from tests.sim.conformance.claims import check_vector_env
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.map_window import MapWindow
from vitruvius.sim import DEFAULT, HouseVectorEnv

HOUSES = [random_house(seed) for seed in range(3)]
SIDE = 32


def make(count: int = 3, **arguments: Any) -> MapWindow:
    arguments = {"houses": HOUSES, "targets": "all", "max_episode_steps": 40} | arguments
    return MapWindow(HouseVectorEnv(num_envs=count, **arguments), SIDE)


def walk(envs: MapWindow, steps: int, seed: int = 0) -> np.ndarray:
    """Return actions (steps, E), mostly forward."""
    rng, count = np.random.default_rng(seed), envs.num_envs
    if isinstance(envs.single_action_space, gymnasium.spaces.Discrete):
        return rng.choice(3, (steps, count), p=[0.2, 0.2, 0.6])
    return np.stack([rng.uniform(0.2, 0.7, (steps, count)), rng.uniform(-3, 3, (steps, count))], -1).astype(
        "f4"
    )


def cut(planner: Planner, e: int) -> np.ndarray:
    """Return the window of an environment, (4, SIDE, SIDE), cut out of the planner's whole map."""
    cells, last, time = planner.occupancy(e), planner.last_seen(e).astype(int), int(planner.read("time")[e])
    x, y, heading = planner.pose(e)
    seen, taken = last > 0, cells == 2
    near = np.any([np.roll(~seen, way, axis) for way in (-1, 1) for axis in (0, 1)], axis=0)
    age = np.where(seen, np.minimum(254, (time - last) * 254 // planner.world.steps), 255)
    layers = np.stack([255 * taken, 255 * seen, 255 * (seen & ~taken & near), age])
    row, column = int(np.floor(y)) + len(cells) // 2, int(np.floor(x)) + len(cells) // 2
    about = layers[:, row - SIDE // 2 : row + SIDE // 2, column - SIDE // 2 : column + SIDE // 2]
    # North is up: the left of a body that looks east is there, a quarter on.
    return np.rot90(about, 1 - heading // 2, axes=(1, 2))


@pytest.mark.parametrize("backend", ["continuous", "free"])
def test_it_is_the_window_of_a_planner_that_sees_the_same(backend):
    envs = make(backend=backend, max_episode_steps=300)
    inner: Any = envs.unwrapped
    own: Any = Planner(inner.config, 3)
    seen, info = envs.reset(seed=0)
    none, fresh = torch.zeros(3, dtype=torch.int64), torch.ones(3).bool()
    actions, headings = walk(envs, 200), set()
    for t in range(200):
        pose = torch.from_numpy(info["pose"])
        rays, blocked = torch.from_numpy(seen["rays"]), torch.from_numpy(info["blocked"])
        last = torch.from_numpy(actions[t - 1]) if t else none
        own.step(rays, blocked, pose if backend == "free" else last, fresh)
        fresh = torch.zeros(3).bool()
        for e in range(3):
            np.testing.assert_array_equal(seen["map"][e], cut(own, e))
            headings.add(own.pose(e)[2])
        assert envs.observation_space.contains(seen)
        seen, _, _, _, info = envs.step(actions[t])
    assert headings == set(range(8))
    layers = seen["map"].reshape(3, 4, -1)
    assert (layers[:, :3].max(axis=(0, 2)) == 255).all()
    assert ((layers[:, 3] > 0) & (layers[:, 3] < 254)).any()


@pytest.mark.parametrize("backend", ["continuous", "free"])
def test_it_conforms_in_every_autoreset_mode_which_give_the_same_episodes(backend):
    for mode in AutoresetMode:
        check_vector_env(make(autoreset_mode=mode, backend=backend), steps=90, skip=["close"])
    check_autoreset_modes(lambda mode: make(autoreset_mode=mode, backend=backend), steps=90)


def test_it_is_the_same_in_any_batch_and_by_tensors():
    config = replace(DEFAULT, observe=("rays", "bump"))
    whole, tensors = (
        make(6, preset=config, autoreset_mode="SameStep"),
        make(6, preset=config, autoreset_mode="SameStep"),
    )
    single = make(1, preset=config, autoreset_mode="SameStep")
    whole.reset(seed=3), tensors.reset(seed=3), single.reset(seed=5)
    for action in walk(whole, 90):
        seen, _, terminated, truncated, info = whole.step(action)
        theirs, *_, more = tensors.step_torch(torch.from_numpy(action))
        one = single.step(action[2:3])[0]
        assert list(seen) == list(theirs) == ["rays", "bump", "map"]
        for name, part in seen.items():
            np.testing.assert_array_equal(part, theirs[name].numpy())
            np.testing.assert_array_equal(part[2], one[name][0])
        ended = terminated | truncated
        if ended.any():
            np.testing.assert_array_equal(
                info["final_obs"]["map"][ended], more["final_obs"]["map"][torch.from_numpy(ended)].numpy()
            )


def test_other_libraries_wrap_it_and_learn_from_it():
    stable = pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    made = gymnasium.make_vec(
        "Vitruvius/House-v0", num_envs=4, autoreset_mode="SameStep", max_episode_steps=20
    )
    envs = MapWindow(made, 48)
    counted = RecordEpisodeStatistics(envs)
    seen, _ = counted.reset(seed=0)
    for action in walk(envs, 25):
        seen, *_, info = counted.step(action)
        assert ("final_obs" in info) == ("episode" in info)
        assert counted.observation_space.contains(seen)
    assert seen["map"].shape == (4, 4, 48, 48)
    torch.set_num_threads(1)
    model = stable.PPO("MultiInputPolicy", StableBaselinesVecEnv(envs), n_steps=16, batch_size=32, n_epochs=1)
    model.learn(128)
    seen, _ = envs.reset(seed=0)
    assert model.predict(seen)[0].shape == (4,)
    assert "map" in model.policy.features_extractor.extractors


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            {"preset": replace(DEFAULT, flat=True)},
            "a map is built from rays: add rays to observe, and leave out flat",
        ),
        (
            {"preset": replace(DEFAULT, observe=("bump",))},
            "a map is built from rays: add rays to observe, and leave",
        ),
        ({"side": 33}, "a window is an even number of cells wide, 2 to 256, not 33"),
        ({"side": 258}, "a window is an even number of cells wide, 2 to 256, not 258"),
    ],
)
def test_what_has_no_map_is_refused_in_a_line(wrong, words):
    side = wrong.pop("side", SIDE)
    with pytest.raises(ValueError, match=re.escape(words)) as error:
        MapWindow(HouseVectorEnv(HOUSES, 2, **wrong), side)
    assert "\n" not in str(error.value)
    with pytest.raises(ValueError, match="a map needs a HouseVectorEnv, not a SyncVectorEnv"):
        MapWindow(gymnasium.make_vec("CartPole-v1", num_envs=1, vectorization_mode="sync"))
