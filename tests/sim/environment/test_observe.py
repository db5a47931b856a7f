"""Parts of an observation: the same numbers from all interfaces, equal to the state's."""

from copy import deepcopy
from dataclasses import replace
from typing import Any, cast

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.wrappers.vector import FlattenObservation

from tests import sample_houses
from tests.sim.conformance.claims import check_vector_env
from vitruvius.sim import DEFAULT, Config, HouseEnv, HouseVectorEnv
from vitruvius.sim.actions import ACTIONS, FORWARD, LEFT
from vitruvius.sim.backends.continuous import Continuous
from vitruvius.sim.config import EXTRAS, RAYS

HOUSES = sample_houses.RANDOM[:2]
COUNT = 8
ON_A_LATTICE = tuple(name for name in EXTRAS if name != "speed")
ALL = replace(DEFAULT, observe=(RAYS, *ON_A_LATTICE), geodesic=True)
FLAT = replace(ALL, flat=True)


class Blind(Continuous):
    """A backend without distances."""

    lacks = ("geodesic",)


def made(config: Config = ALL, **arguments: Any) -> HouseVectorEnv:
    return HouseVectorEnv(HOUSES, COUNT, targets="all", preset=config, **arguments)


def flattened(observation: dict[str, Any], config: Config = ALL) -> np.ndarray:
    return np.concatenate([np.asarray(observation[name]).reshape(COUNT, -1) for name in config.observe], 1)


def actions(steps: int) -> np.ndarray:
    return np.random.default_rng(0).choice(3, (steps, COUNT), p=[0.15, 0.15, 0.7])


def in_frame(away: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Return metres east and south as metres forward and left."""
    turned = (away[:, 0] - 1j * away[:, 1]) * np.exp(-1j * heading)
    return np.stack([turned.real, turned.imag], axis=1)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_each_part_is_what_the_state_says(mode):
    envs = made(autoreset_mode=mode, max_episode_steps=90)
    seen, info = envs.reset(seed=1)
    start, over = info["pose"], np.zeros(COUNT, bool)
    assert not seen["last_action"].any()
    for chosen in actions(200):
        ended = over
        seen, _, terminated, truncated, info = envs.step(chosen)
        over = terminated | truncated
        fresh = over if mode == "SameStep" else ended
        start = np.where(fresh[:, None], info["pose"], start)
        np.testing.assert_array_equal(seen["bump"][:, 0], info["blocked"])
        np.testing.assert_array_equal(seen["last_action"], np.eye(ACTIONS)[chosen] * ~fresh[:, None])
        np.testing.assert_array_equal(seen["geodesic"][:, 0], info["distance"])
        pose, turn = info["pose"], info["pose"][:, 2] - start[:, 2]
        np.testing.assert_allclose(
            seen["goal"], in_frame(info["target"] - pose[:, :2], pose[:, 2]), atol=1e-5
        )
        moved = in_frame(pose[:, :2] - start[:, :2], start[:, 2])
        expected = np.column_stack([moved, np.cos(turn), np.sin(turn)])
        np.testing.assert_allclose(seen["odometry"], expected, atol=1e-4)
        if mode == "SameStep" and over.any():
            last, final = info["final_info"], info["final_obs"]
            np.testing.assert_array_equal(final["bump"][over, 0], last["blocked"][over])
            np.testing.assert_array_equal(final["last_action"][over], np.eye(ACTIONS)[chosen[over]])
            np.testing.assert_array_equal(final["geodesic"][over, 0], last["distance"][over])


def test_rays_and_all_else_are_what_they_are_without_the_other_parts():
    envs, plain, flat = made(), made(DEFAULT), made(FLAT)
    pairs = [each.reset(seed=2) for each in (envs, plain, flat)]
    for chosen in actions(60):
        np.testing.assert_array_equal(pairs[0][0]["rays"], pairs[1][0])
        np.testing.assert_array_equal(flattened(pairs[0][0]), pairs[2][0])
        pairs = [each.step(chosen) for each in (envs, plain, flat)]
    assert flat.single_observation_space.shape == (80 + sum(map(ALL.numbers_of, ON_A_LATTICE)),)


def test_kinds_of_environments_are_made_in_any_order():
    """Kernels are compiled at their first run: one with more arrays must not replace another."""
    rays = replace(DEFAULT, range=5.0)
    many = [made(replace(rays, observe=each)) for each in (("rays",), ("rays", "bump"), ("goal",))]
    assert [type(envs.reset(seed=1)[0]) for envs in many] == [np.ndarray, dict, dict]


def test_drift_adds_up_and_blocked_moves_do_not_count():
    envs = made(replace(ALL, drift=0.1))
    true = made()
    envs.reset(seed=3)
    true.reset(seed=3)
    errors = []
    for chosen in actions(300):
        seen, exact = envs.step(chosen)[0], true.step(chosen)[0]
        np.testing.assert_array_equal(seen["goal"], exact["goal"])
        errors.append(np.linalg.norm(seen["odometry"][:, :2] - exact["odometry"][:, :2], axis=1).mean())
    assert 0 < errors[2] < errors[60] < errors[-1]


def test_environments_of_one_and_of_many_and_tensors_agree():
    torch = pytest.importorskip("torch")
    for config in (ALL, FLAT, replace(ALL, observe=("goal", "bump"), geodesic=False)):
        envs, tensors = made(config), made(config)
        single = HouseEnv(HOUSES, targets="all", preset=config)
        seen = [envs.reset(seed=4)[0], tensors.reset(seed=4)[0], single.reset(seed=4)[0]]
        for chosen in actions(40):
            one = single.step(chosen[0])[0]
            assert one in single.observation_space
            many, other = envs.step(chosen)[0], tensors.step_torch(torch.from_numpy(chosen))[0]
            assert many in envs.observation_space
            if config.flat:
                many, other, one = {"": many}, {"": other}, {"": one}
            for name in many:
                np.testing.assert_array_equal(many[name], other[name].numpy())
                np.testing.assert_array_equal(many[name][0], one[name])
        assert len(seen) == 3


def test_a_state_goes_on_with_what_is_observed():
    envs, other = made(replace(ALL, drift=0.1)), made(replace(ALL, drift=0.1))
    envs.reset(seed=5)
    other.reset(seed=9)
    for chosen in actions(30):
        envs.step(chosen)
    other.state = envs.state
    for chosen in actions(30):
        np.testing.assert_equal(envs.step(chosen), other.step(chosen))


@pytest.mark.second_part("Gymnasium's checks")
@pytest.mark.parametrize("config", [ALL, FLAT], ids=["dict", "flat"])
def test_they_conform(config):
    def make(mode: Any) -> HouseVectorEnv:
        return made(config, autoreset_mode=mode, max_episode_steps=20)

    check_vector_env(make("NextStep"))
    check_vector_env(make("SameStep"))
    from gymnasium.utils.env_checker import check_env

    arguments = {"houses": HOUSES, "preset": config, "disable_env_checker": True}
    check_env(gymnasium.make("Vitruvius/House-v0", **arguments).unwrapped, skip_render_check=True)


def test_stable_baselines_learns_from_both():
    library = pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    for config, policy in ((ALL, "MultiInputPolicy"), (FLAT, "MlpPolicy")):
        envs = StableBaselinesVecEnv(made(config, autoreset_mode="SameStep", max_episode_steps=30))
        seen = envs.reset()
        for chosen in actions(31):
            seen, _, done, infos = envs.step(chosen)
            for index in np.flatnonzero(done):
                assert infos[index]["terminal_observation"] in envs.observation_space
        library.PPO(policy, envs, n_steps=8, batch_size=32, n_epochs=1, device="cpu").learn(128)
        del seen


@pytest.mark.parametrize("config", [ALL, FLAT], ids=["dict", "flat"])
def test_torchrl_has_both(config):
    pytest.importorskip("torchrl")
    from torchrl.envs import GymWrapper

    envs = made(config, autoreset_mode="SameStep", max_episode_steps=20)
    env, step, rows = GymWrapper(envs), envs.step, []

    def stepped(actions: Any) -> Any:
        given = step(actions)
        rows.append(deepcopy(given))  # TorchRL changes its input
        return given

    envs.step = stepped
    found = env.rollout(45, break_when_any_done=False)
    assert len(rows) == 45
    for k, (seen, reward, terminated, truncated, info) in enumerate(rows):
        after = {"observation": seen} if config.flat else seen
        over = terminated | truncated
        np.testing.assert_array_equal(found["next", "reward"][:, k, 0].numpy(), reward)
        np.testing.assert_array_equal(found["next", "done"][:, k, 0].numpy(), over)
        for name, part in after.items():
            np.testing.assert_array_equal(found["next", name][~over, k].numpy(), part[~over])
            if k < 44:
                np.testing.assert_array_equal(found[name][~over, k + 1].numpy(), part[~over])
        if config.flat and over.any():
            last = found["next", "observation"][over, k].numpy()
            np.testing.assert_array_equal(last, info["final_obs"][over])


def test_what_a_backend_lacks_is_said_before_anything_starts():
    name = "tests.sim.environment.test_observe:Blind"
    with pytest.raises(ValueError, match="backend Blind: there is no observation geodesic: there are"):
        HouseEnv(HOUSES, preset=ALL, backend=name)
    HouseEnv(HOUSES, preset=replace(DEFAULT, observe=("rays", "goal")), backend=name)


def test_actions_that_are_no_numbers_are_refused():
    envs = made()
    envs.reset(seed=1)
    with pytest.raises(ValueError, match="actions must be integers 0, 1 or 2, not float64"):
        envs.step(np.full(COUNT, np.nan))
    assert FORWARD > LEFT


def test_parts_are_in_the_order_of_observe_everywhere():
    """The order holds in spaces, observations and flat arrays.

    It holds for one environment, for many, and in Gymnasium's vector environments.
    """
    config = replace(DEFAULT, observe=("rays", "goal", "bump"))
    name, arguments = "Vitruvius/House-v0", {"houses": HOUSES, "preset": config}
    many = gymnasium.make_vec(name, 2, **arguments)
    sync = gymnasium.make_vec(name, 2, vectorization_mode="sync", **arguments)
    observations = [envs.reset(seed=1)[0] for envs in (many, sync, gymnasium.make(name, **arguments))]
    for parts in (many.single_observation_space, many.observation_space, *observations):
        assert tuple(cast(Any, parts)) == config.observe
    rows = HouseVectorEnv(HOUSES, 2, preset=replace(config, flat=True)).reset(seed=1)[0]
    np.testing.assert_array_equal(FlattenObservation(many).reset(seed=1)[0], rows)


@pytest.mark.parametrize("by_ray", [False, True])
def test_step_torch_says_what_step_says_where_episodes_end_and_begin_in_one_step(by_ray):
    """Bodies walk until they collide, so that many are blocked as their episodes end."""
    arguments = {"autoreset_mode": "SameStep", "max_episode_steps": 7, "by_ray": by_ray}
    one, other = (made(DEFAULT, **arguments) for _ in range(2))
    one.reset(seed=3)
    other.reset(seed=3)
    last = 0
    for _ in range(30):
        ahead = np.full(COUNT, FORWARD)
        seen, _, terminated, truncated, info = one.step(ahead)
        tensors, _, _, _, told = other.step_torch(torch.from_numpy(ahead))
        np.testing.assert_array_equal(tensors, seen)
        np.testing.assert_array_equal(told["blocked"], info["blocked"])
        np.testing.assert_array_equal(other.info()["blocked"], info["blocked"])
        if (ended := terminated | truncated).any():
            final = info["final_info"]["blocked"]
            np.testing.assert_array_equal(told["final_info"]["blocked"][ended], final[ended])
            assert not info["blocked"][ended].any()
            last += final[ended].sum()
    assert last > 0
