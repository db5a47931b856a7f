"""Users' wrappers of environments: Gymnasium's wrappers and processes, and TorchRL by name."""

import copy
import pickle
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium import wrappers
from gymnasium.error import ClosedEnvironmentError
from gymnasium.wrappers import vector

from tests import sample_houses
from tests.programs import finished
from vitruvius.sim import HouseVectorEnv

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM)]
NAME = "Vitruvius/House-v0"

SINGLE = {
    "TimeLimit": lambda env: wrappers.TimeLimit(env, 5),
    "Autoreset": wrappers.Autoreset,
    "RecordEpisodeStatistics": wrappers.RecordEpisodeStatistics,
    "FrameStackObservation": lambda env: wrappers.FrameStackObservation(env, 3),
    "FlattenObservation": wrappers.FlattenObservation,
    "NormalizeObservation": wrappers.NormalizeObservation,
    "DtypeObservation": lambda env: wrappers.DtypeObservation(env, np.float64),
    "RescaleObservation": lambda env: wrappers.RescaleObservation(env, np.float32(-1), np.float32(1)),
    "DelayObservation": lambda env: wrappers.DelayObservation(env, 2),
    "TimeAwareObservation": wrappers.TimeAwareObservation,
    "MaxAndSkipObservation": lambda env: wrappers.MaxAndSkipObservation(env, 2),
    "AddRenderObservation": wrappers.AddRenderObservation,
    "RenderCollection": wrappers.RenderCollection,
    "ClipReward": lambda env: wrappers.ClipReward(env, -1, 1),
    "NormalizeReward": wrappers.NormalizeReward,
    "StickyAction": lambda env: wrappers.StickyAction(env, 0.5),
    "OrderEnforcing": wrappers.OrderEnforcing,
    "PassiveEnvChecker": wrappers.PassiveEnvChecker,
    "NumpyToTorch": wrappers.NumpyToTorch,
}
"""Wrappers of one environment: all that accept our spaces."""

MANY = {
    "RecordEpisodeStatistics": vector.RecordEpisodeStatistics,
    "FlattenObservation": vector.FlattenObservation,
    "NormalizeObservation": vector.NormalizeObservation,
    "DtypeObservation": lambda envs: vector.DtypeObservation(envs, np.float64),
    "RescaleObservation": lambda envs: vector.RescaleObservation(envs, np.float32(-1), np.float32(1)),
    "ClipReward": lambda envs: vector.ClipReward(envs, -1, 1),
    "NormalizeReward": vector.NormalizeReward,
    "NumpyToTorch": vector.NumpyToTorch,
    "DictInfoToList": vector.DictInfoToList,
}


@pytest.mark.parametrize("name", SINGLE)
@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning")
def test_gymnasiums_wrappers_go_around_one_environment(name: str) -> None:
    env = SINGLE[name](gymnasium.make(NAME, houses=HOUSES, render_mode="rgb_array", max_episode_steps=50))
    observation, _ = env.reset(seed=0)
    for action in (2, 0, 2):
        observation, reward, *_ = env.step(action)
    assert float(reward) == 0
    if isinstance(observation, np.ndarray):
        assert env.observation_space.contains(observation)


@pytest.mark.parametrize("name", MANY)
def test_gymnasiums_wrappers_go_around_many_environments(name: str) -> None:
    envs = MANY[name](gymnasium.make_vec(NAME, num_envs=2, houses=HOUSES))
    envs.reset(seed=0)
    observation, reward, *_ = envs.step(np.array([2, 0]))
    assert len(observation) == len(reward) == 2


def test_a_window_shows_many_environments(monkeypatch: pytest.MonkeyPatch) -> None:
    import pygame

    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    envs = gymnasium.make_vec(NAME, num_envs=2, houses=HOUSES, render_mode="human")
    assert envs.render_mode == "human"
    envs.reset(seed=0)
    envs.step(np.array([2, 0]))
    surface = pygame.display.get_surface()
    assert surface
    shown = pygame.surfarray.array3d(surface)
    assert len(np.unique(shown.reshape(-1, 3), axis=0)) > 10
    envs.close()


def test_torchrl_makes_an_environment_by_its_name() -> None:
    """TorchRL tries ``frameskip=1`` first, and infers from Python's error that there is no such argument."""
    from torchrl.envs import GymEnv

    env = GymEnv(NAME, houses=HOUSES)
    assert env.rollout(3)["next", "observation"].shape == (3, 40, 2)


def test_a_closed_environment_is_closed_when_it_is_read_again() -> None:
    envs = HouseVectorEnv(HOUSES)
    envs.reset(seed=0)
    assert not pickle.loads(pickle.dumps(envs)).closed
    envs.close()
    one = gymnasium.make(NAME, houses=HOUSES).unwrapped
    one.reset(seed=0)
    one.close()
    for closed in (envs, one):
        for again in (pickle.loads(pickle.dumps(closed)), copy.deepcopy(closed)):
            with pytest.raises(ClosedEnvironmentError):
                again.reset()


PROCESSES = """
import gymnasium, numpy as np, sys, threading, warnings
from vitruvius.sim import HouseVectorEnv
warnings.simplefilter("ignore")

def made(**context):
    envs = gymnasium.make_vec("Vitruvius/House-v0", num_envs=2, vectorization_mode="async", **context)
    observation, _ = envs.reset(seed=3)
    after = envs.step(np.array([2, 1]))[0]
    envs.close(terminate=True)
    return observation, after

if __name__ == "__main__":
    try:
        HouseVectorEnv(device="cuda")
    except ValueError as error:
        print(error)
    forked = made()
    envs = HouseVectorEnv(num_envs=2)
    for ours, theirs in zip((envs.reset(seed=3)[0], envs.step(np.array([2, 1]))[0]), forked):
        np.testing.assert_array_equal(ours, theirs)
    try:
        made()
    except RuntimeError as error:
        print(error)
    spawned = made(vector_kwargs={"context": "spawn"})
    np.testing.assert_array_equal(forked, spawned)
    thread = threading.Thread(target=lambda: print(len(HouseVectorEnv(num_envs=3).reset(seed=0)[0])))
    thread.start()
    thread.join()
"""


@pytest.mark.second_part("each process imports the package")
@pytest.mark.skipif(sys.platform == "darwin", reason="processes are not forked there")
def test_processes_are_forked_or_spawned_and_a_missing_gpu_changes_nothing(tmp_path) -> None:
    """Errors appear in the parent: a missing GPU, and a fork of a process in which Taichi runs."""
    (tmp_path / "processes.py").write_text(PROCESSES)
    made = finished([sys.executable, tmp_path / "processes.py"])
    assert made.returncode == 0, made.stderr
    gpu, fork, count = made.stdout.splitlines()
    assert gpu.startswith("device 'cuda' cannot be used: no GPU with a CUDA driver was found")
    assert "was forked" in fork
    assert 'vector_kwargs={"context": "spawn"}' in fork
    assert count == "3"
