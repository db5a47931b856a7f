"""Other libraries run on our vector environment, in the modes that they expect."""

import re
import sys
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorWrapper
from gymnasium.wrappers import vector as wrappers

from tests import sample_houses
from tests.sim.conformance.autoreset import check_autoreset_modes
from tests.sim.conformance.claims import check_vector_env
from vitruvius.logic import generate, save
from vitruvius.sim import HouseEnv, HouseVectorEnv
from vitruvius.sim.film import film

pytestmark = pytest.mark.second_part("wrappers and other libraries")

HOUSES = [sample_houses.drawn(sample_houses.ONE_ROOM), sample_houses.RANDOM[0]]
COUNT, STEPS = 3, 20
NEXT, SAME, DISABLED = AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP, AutoresetMode.DISABLED


@cache
def houses(
    mode: AutoresetMode = SAME, preset: str = "default", render_mode: str | None = None
) -> HouseVectorEnv:
    """Return environments that are truncated after 20 steps.

    With the preset ``paper``, collisions end episodes, too. Environments are created once, because compiling
    takes seconds, so no test closes them.
    """
    return HouseVectorEnv(
        HOUSES,
        COUNT,
        targets="mixed",
        preset=preset,
        max_episode_steps=STEPS,
        render_mode=render_mode,
        autoreset_mode=mode,
    )


class Unclosed(VectorWrapper):
    """Wrapper that ignores ``close``."""

    def close(self, **kwargs):
        pass


def plan(steps: int) -> np.ndarray:
    """Return random actions (steps, COUNT), mostly forward, so that there are collisions."""
    return np.random.default_rng(0).choice(3, (steps, COUNT), p=[0.1, 0.1, 0.8])


@pytest.mark.parametrize("mode", AutoresetMode)
def test_our_environment_conforms_in_every_autoreset_mode(mode):
    check_vector_env(houses(mode, "paper"), steps=100, options={"house": [0, 1, 0]}, skip=["close"])


def test_rendering_houses_of_different_sizes_and_closing_conform():
    envs = HouseVectorEnv(HOUSES, COUNT, max_episode_steps=STEPS, render_mode="rgb_array")
    envs.reset(options={"house": [0, 1, 0]})
    assert len({picture.shape for picture in envs.render() or ()}) == 1
    check_vector_env(envs, steps=30)


def test_our_autoreset_modes_give_the_same_episodes():
    check_autoreset_modes(lambda mode: Unclosed(houses(mode, "paper")), steps=150)


@pytest.fixture(scope="module")
def singles():
    arguments: dict[str, Any] = {"targets": "mixed", "preset": "paper", "max_episode_steps": STEPS}
    return [HouseEnv(HOUSES, **arguments) for _ in range(COUNT)]


@pytest.mark.parametrize("mode", AutoresetMode)
def test_every_autoreset_mode_equals_gymnasiums_sync_vector_env_of_single_environments(mode, singles):
    ours = houses(mode, "paper")
    theirs = SyncVectorEnv([lambda one=one: one for one in singles], autoreset_mode=mode)
    np.testing.assert_array_equal(ours.reset(seed=3)[0], theirs.reset(seed=3)[0])
    collisions = 0
    for action in plan(200):
        (*mine, info), (*yours, their_info) = ours.step(action), theirs.step(action)
        for one, other in zip(mine, yours, strict=True):
            np.testing.assert_array_equal(one, other)
        for key in ("pose", "house", "target"):
            np.testing.assert_array_equal(info[key], their_info[key])
        collided, over = mine[2], mine[2] | mine[3]
        collisions += collided.sum()
        if mode is SAME and over.any():
            np.testing.assert_array_equal(info["_final_obs"], their_info["_final_obs"])
            np.testing.assert_array_equal(info["final_obs"][over], np.stack(their_info["final_obs"][over]))
            np.testing.assert_array_equal(info["final_info"]["blocked"][over], collided[over])
        if mode is DISABLED and over.any():
            one, other = (envs.reset(options={"reset_mask": over.copy()})[0] for envs in (ours, theirs))
            np.testing.assert_array_equal(one, other)
    assert collisions


def test_after_an_end_info_is_the_next_episodes_and_final_info_all_of_the_last():
    envs = houses(SAME, "paper")
    _, first = envs.reset(seed=3)
    steps = (envs.step(action) for action in plan(200))
    terminated, info = next((now[2], now[4]) for now in steps if now[2].any())
    assert not info["blocked"][terminated].any()
    assert first.keys() <= info["final_info"].keys()


@pytest.mark.parametrize("mode", AutoresetMode)
def test_gymnasiums_statistics_are_those_of_the_episodes(mode):
    envs = wrappers.RecordEpisodeStatistics(houses(mode, "paper"))
    envs.reset(seed=0)
    sums, lengths, seen, over = np.zeros(COUNT), np.zeros(COUNT, int), 0, np.zeros(COUNT, bool)
    for action in plan(80):
        if mode is DISABLED and over.any():
            envs.reset(options={"reset_mask": over.copy()})
        if mode is not SAME:
            sums[over], lengths[over] = 0, 0
        _, reward, terminated, truncated, info = envs.step(action)
        counts = ~over if mode is NEXT else np.ones(COUNT, bool)
        sums, lengths = sums + reward, lengths + counts
        over = terminated | truncated
        if over.any():
            np.testing.assert_array_equal(info["_episode"], over)
            np.testing.assert_array_equal(info["episode"]["l"][over], lengths[over])
            np.testing.assert_allclose(info["episode"]["r"][over], sums[over])
            seen += over.sum()
        if mode is SAME:
            sums[over], lengths[over] = 0, 0
    assert seen == envs.episode_count > COUNT


@pytest.mark.parametrize("mode", AutoresetMode)
def test_gymnasiums_wrappers_give_tensors_and_lists_of_infos(mode):
    pytest.importorskip("array_api_compat")
    tensors = wrappers.NumpyToTorch(houses(mode))
    tensors.reset(seed=0)
    observation, *_, info = [tensors.step(torch.from_numpy(action)) for action in plan(STEPS)][-1]
    lists = wrappers.DictInfoToList(houses(mode))
    lists.reset(seed=0)
    infos: Any = [lists.step(action) for action in plan(STEPS)][-1][-1]
    assert isinstance(observation, torch.Tensor)
    assert [one["house"] for one in infos] == info["house"].tolist()
    if mode is SAME:
        assert info["final_obs"].shape == observation.shape
        np.testing.assert_array_equal(infos[2]["final_obs"], info["final_obs"][2].numpy())


@pytest.fixture
def moviepy(monkeypatch):
    """Replace moviepy, which pins another Pillow, by a stub that writes clips with our own ``film``."""

    class Clip:
        def __init__(self, frames, fps):
            self.frames, self.fps = frames, fps

        def write_videofile(self, path, logger=None):
            film(self.frames, f"{path}.gif", self.fps)

    for name in ("moviepy", "moviepy.video", "moviepy.video.io"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    clips: Any = SimpleNamespace(ImageSequenceClip=Clip)
    monkeypatch.setitem(sys.modules, "moviepy.video.io.ImageSequenceClip", clips)


@pytest.mark.usefixtures("moviepy")
@pytest.mark.filterwarnings("ignore:.*autoreset mode is same-step.*")
@pytest.mark.parametrize("mode", AutoresetMode)
def test_gymnasiums_recorder_films_the_environments_side_by_side(mode, tmp_path):
    envs = wrappers.RecordVideo(
        houses(mode, render_mode="rgb_array"), str(tmp_path / "films"), episode_trigger=lambda episode: True
    )
    envs.reset(seed=0)
    for action in plan(STEPS):
        envs.step(action)
    if envs.recording:
        envs.stop_recording()
    assert len(list((tmp_path / "films").glob("*.gif"))) >= 1


def test_stable_baselines_trains_by_dqn_and_stores_last_observations():
    stable_baselines3 = pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    envs = stable_baselines3.common.vec_env.VecMonitor(StableBaselinesVecEnv(houses()))
    model = stable_baselines3.DQN("MlpPolicy", envs, learning_starts=100, seed=0, device="cpu")
    model.learn(COUNT * 70)
    assert envs.episode_count == COUNT * (70 // STEPS)
    buffer = model.replay_buffer
    ended = buffer.dones[:70].any(axis=1).nonzero()[0]
    assert ended.tolist() == [STEPS - 1, 2 * STEPS - 1, 3 * STEPS - 1]
    assert buffer.timeouts[ended].all()
    assert (buffer.next_observations[ended] != buffer.observations[ended + 1]).any(axis=(1, 2, 3)).all()
    going = np.setdiff1d(np.arange(69), ended)
    np.testing.assert_array_equal(buffer.next_observations[going], buffer.observations[going + 1])


def test_stable_baselines_trains_by_ppo_and_evaluates():
    stable_baselines3 = pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    envs = stable_baselines3.common.vec_env.VecMonitor(StableBaselinesVecEnv(houses()))
    model = stable_baselines3.PPO("MlpPolicy", envs, n_steps=32, batch_size=32, seed=0, device="cpu")
    before = [one.detach().clone() for one in model.policy.parameters()]
    model.learn(COUNT * 64)
    assert any((one != old).any() for one, old in zip(model.policy.parameters(), before, strict=True))
    evaluate = stable_baselines3.common.evaluation.evaluate_policy
    _, lengths = evaluate(model, envs, n_eval_episodes=4, return_episode_rewards=True)
    assert lengths == [STEPS] * 4


@pytest.mark.parametrize("every", [True, False])
def test_the_adapter_says_what_the_environment_says(every):
    pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    raw, options = houses(SAME, "paper"), {"house": np.array([0, 1, 1])}
    first = raw.reset(seed=7, options=options)[0]
    said = [raw.step(action) for action in plan(80)]
    adapted = StableBaselinesVecEnv(raw, infos=every)
    adapted.seed(7)
    adapted.set_options(options)
    np.testing.assert_array_equal(adapted.reset(), first)
    ends = 0
    for action, (observation, reward, terminated, truncated, info) in zip(plan(80), said, strict=True):
        seen, paid, done, infos = adapted.step(action)
        np.testing.assert_array_equal(seen, observation)
        np.testing.assert_array_equal(paid, reward)
        np.testing.assert_array_equal(done, terminated | truncated)
        for index, one in enumerate(infos):
            assert one["TimeLimit.truncated"] == (truncated[index] and not terminated[index])
            source = info["final_info"] if done[index] else info
            assert ("blocked" in one) == (every or done[index])
            assert one.get("blocked", source["blocked"][index]) == source["blocked"][index]
            assert ("terminal_observation" in one) == done[index]
            if done[index]:
                ends += 1
                np.testing.assert_array_equal(one["terminal_observation"], info["final_obs"][index])
                np.testing.assert_array_equal(adapted.reset_infos[index]["pose"], info["pose"][index])
    assert ends > COUNT
    assert adapted.get_attr("num_envs", indices=[0, 1]) == [COUNT] * 2
    assert adapted.env_is_wrapped(gymnasium.Wrapper) == [False] * COUNT


def test_the_adapter_shows_all_environments_in_one_picture():
    pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    adapted = StableBaselinesVecEnv(houses(render_mode="rgb_array"))
    adapted.reset()
    picture, single = adapted.render("rgb_array"), adapted.get_images()[0]
    assert picture is not None
    assert single is not None
    assert picture.shape == (2 * single.shape[0], 2 * single.shape[1], 3)


@pytest.mark.parametrize("mode", [NEXT, DISABLED])
def test_the_adapter_refuses_other_modes(mode):
    pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    with pytest.raises(ValueError, match=r"needs AutoresetMode\.SAME_STEP"):
        StableBaselinesVecEnv(houses(mode))


@pytest.mark.parametrize("mode", [SAME, DISABLED])
def test_torchrl_collects_frames_with_last_observations(mode):
    collectors = pytest.importorskip("torchrl.collectors")
    env = pytest.importorskip("torchrl.envs").GymWrapper(houses(mode))
    env.set_seed(0)
    collector = collectors.Collector(env, None, frames_per_batch=COUNT * 45, total_frames=COUNT * 45)
    (frames,) = list(collector)
    collector.shutdown()
    assert frames.shape == (COUNT, 45)
    seen, after = frames["observation"], frames["next", "observation"]
    ended = frames["next", "done"].squeeze(-1)
    assert ended.nonzero()[:, 1].tolist() == [STEPS - 1, 2 * STEPS - 1] * COUNT
    going = ~ended[:, :-1]
    torch.testing.assert_close(after[:, :-1][going], seen[:, 1:][going], rtol=0, atol=0)
    assert (after[:, :-1][~going] != seen[:, 1:][~going]).flatten(1).any(dim=1).all()


def test_torchrl_refuses_the_next_step_mode_by_name():
    envs = pytest.importorskip("torchrl.envs")
    with pytest.raises(RuntimeError, match="SAME_STEP or DISABLED"):
        envs.GymWrapper(houses(NEXT))


def test_the_examples_of_the_page_of_use_run(folder, monkeypatch):
    """Run the examples of the simulator; ``tests/test_examples.py`` runs those with other libraries."""
    page = (Path(__file__).parents[3] / "docs" / "use.md").read_text()
    page = page.split("## The simulator")[1].split("\n## ")[0]
    (program,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert "make_vec" in program
    monkeypatch.chdir(folder)
    exec(program, {})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with two banks of houses with kitchens."""
    path = tmp_path_factory.mktemp("banks")
    for seed, name in enumerate(("houses", "others")):
        save(generate(rooms=4, seed=seed, count=2), path / f"{name}.jsonl")
    return path
