"""Bodies that drive in all directions: limits, contacts, batches, states and refusals. 40 s.

``test_free`` compares contacts and rays with shapely.
"""

import re
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch

from tests.sim.backends.free_study import houses
from tests.sim.backends.test_free import EMPTY
from tests.sim.conformance.claims import check_vector_env
from vitruvius.agent.baselines.driving.explorer import DrivingExplorer
from vitruvius.agent.baselines.driving.true_path import TruePath
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.drive import Drive

DRIVE = Drive(reverse=0.3, sideways=0.5, turn_speed=2.0, acceleration=1.5, turn_acceleration=8.0)
CONFIG = replace(DEFAULT, drive=DRIVE, observe=("rays", "speed", "odometry"))
HOUSES = houses(6, seed=50)
HIGH = np.array([0.7, 0.5, 2.0])
LOW = np.array([-0.3, -0.5, -2.0])


def make(**arguments: Any) -> HouseVectorEnv:
    arguments = {
        "houses": HOUSES,
        "num_envs": 32,
        "backend": "free",
        "targets": "all",
        "preset": CONFIG,
    } | arguments
    return HouseVectorEnv(**arguments)


def plan(steps: int, count: int = 32, seed: int = 0) -> np.ndarray:
    """Return actions (T, E, 3)."""
    return np.random.default_rng(seed).uniform(LOW, HIGH, (steps, count, 3)).astype(np.float32)


def walked(envs: HouseVectorEnv, actions: np.ndarray, seed: int = 0) -> list[np.ndarray]:
    """Return all outputs of a walk: rays, speeds, odometry, poses, and blocked."""
    seen, info = envs.reset(seed=seed)
    rows = [(*seen.values(), info["pose"], info["blocked"])]
    for action in actions:
        seen, _, _, _, info = envs.step(action)
        rows.append((*seen.values(), info["pose"], info["blocked"]))
    return [np.stack(column) for column in zip(*rows, strict=True)]


def test_each_speed_comes_as_near_to_what_is_told_as_its_limit_lets_it():
    """Compare with the same motion in float64, in an empty room; speeds are constant during a step."""
    envs = make(houses=[EMPTY])
    rng, dt = np.random.default_rng(0), DRIVE.time_step
    pose = np.column_stack([rng.uniform(3, 6, (32, 2)), rng.uniform(0, 2 * np.pi, 32)])
    _, info = envs.reset(seed=0, options={"house": np.zeros(32, int), "pose": pose})
    pose, speeds, own = info["pose"].astype(float), np.zeros((32, 3)), np.zeros((32, 3))
    limits = np.array([1.5, 1.5, 8.0]) * dt

    def moved(place: np.ndarray, up: int) -> np.ndarray:
        """Return places (E, 3) after a step; left turns lead to y, or with ``up`` = -1 away from it."""
        middle = place[:, 2] + speeds[:, 2] * dt / 2
        way = dt * np.sinc(speeds[:, 2] * dt / 2 / np.pi)
        x = speeds[:, 0] * np.cos(middle) - speeds[:, 1] * np.sin(middle)
        y = speeds[:, 0] * np.sin(middle) + speeds[:, 1] * np.cos(middle)
        return place + np.column_stack([way * x, up * way * y, speeds[:, 2] * dt])

    for told in plan(60):
        seen, _, _, _, info = envs.step(told)
        speeds += np.clip(told - speeds, -limits, limits)
        pose, own = moved(pose, -1), moved(own, 1)
        np.testing.assert_allclose(seen["speed"], speeds, atol=2e-5)
        np.testing.assert_allclose(info["pose"][:, :2], pose[:, :2], atol=1e-4)
        np.testing.assert_allclose(np.angle(np.exp(1j * (info["pose"][:, 2] - pose[:, 2]))), 0, atol=1e-4)
        np.testing.assert_allclose(seen["odometry"][:, :2], own[:, :2], atol=5e-3)
        np.testing.assert_allclose(
            seen["odometry"][:, 2:], np.column_stack([np.cos(own[:, 2]), np.sin(own[:, 2])]), atol=1e-3
        )


def test_it_slides_along_a_wall_to_its_side_and_keeps_the_speed_that_it_makes():
    drive = replace(DRIVE, acceleration=float("inf"))
    envs = make(houses=[EMPTY], num_envs=2, preset=replace(CONFIG, drive=drive))
    at = DEFAULT.body[0] / 2 + 0.01  # it looks east, with the wall on its left
    envs.reset(seed=0, options={"house": [0, 0], "pose": [[4.5, at, 0.0], [4.5, 4.5, 0.0]]})
    seen, _, _, _, info = envs.step(np.array([[0.6, 0.5, 0.0]] * 2, np.float32))
    assert info["blocked"].tolist() == [True, False]
    np.testing.assert_allclose(seen["speed"], [[0.6, 0.1, 0], [0.6, 0.5, 0]], atol=1e-3)
    np.testing.assert_allclose(info["pose"][:, :2], [[4.56, at - 0.01], [4.56, 4.45]], atol=2e-5)


def test_a_trajectory_depends_neither_on_the_batch_nor_on_the_loop_and_tensors_are_the_same_actions():
    actions = plan(60)
    whole, by_ray = walked(make(), actions), walked(make(by_ray=True), actions)
    single = walked(make(num_envs=1), actions[:, 5:6], seed=5)
    for ours, theirs, one in zip(whole, by_ray, single, strict=True):
        np.testing.assert_array_equal(ours, theirs)
        np.testing.assert_array_equal(ours[:, 5:6], one)
    assert whole[4].mean() > 0.02
    ours, theirs = make(), make()
    ours.reset(seed=0), theirs.reset(seed=0)
    for action in actions[:10]:
        seen, tensors = ours.step(action)[0], theirs.step_torch(torch.from_numpy(action))[0]
        for name in seen:
            np.testing.assert_array_equal(seen[name], tensors[name].numpy())


def test_actions_are_rounded_alike_from_arrays_and_from_tensors_on_any_device():
    orders, action = make()._orders, plan(1)[0]
    action[:3] = [HIGH, LOW, 0 * LOW]
    rounded = orders.given(action)
    np.testing.assert_array_equal(rounded, orders.given(torch.from_numpy(action)).numpy())
    np.testing.assert_allclose(rounded[:3], action[:3], atol=1e-6)


def test_a_saved_state_goes_on_bit_for_bit_also_in_another_environment():
    envs, other, actions = make(), make(), plan(40)
    envs.reset(seed=0)
    for action in actions[:20]:
        envs.step(action)
    other.state = envs.state
    for action in actions[20:]:
        ours, theirs = envs.step(action)[0], other.step(action)[0]
        for name in ours:
            np.testing.assert_array_equal(ours[name], theirs[name])
    state = envs.state
    for name in ("speeds", "reals"):
        wrong = state | {name: state[name].copy()}
        wrong[name][:, -1] = np.nan
        with pytest.raises(
            ValueError, match="the state is invalid: a speed or a heading is not a finite number"
        ):
            envs.state = wrong


def test_it_conforms_and_commands_are_a_choice_of_the_same_motions():
    envs = make(num_envs=3, max_episode_steps=20)
    assert envs.single_action_space == gymnasium.spaces.Box(LOW.astype("f4"), HIGH.astype("f4"), (3,))
    assert envs.single_observation_space["speed"].shape == (3,)  # pyright: ignore[reportIndexIssue]
    check_vector_env(envs, steps=60)
    table = ((0.7, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, -0.5, 0.0), (0.2, 0.1, 1.0))
    ours, theirs = make(preset=replace(CONFIG, drive=replace(DRIVE, commands=table))), make()
    assert ours.single_action_space == gymnasium.spaces.Discrete(4)
    ours.reset(seed=0), theirs.reset(seed=0)
    for chosen in np.random.default_rng(0).integers(4, size=(20, 32)):
        one, other = ours.step(chosen)[4], theirs.step(np.array(table, np.float32)[chosen])[4]
        np.testing.assert_allclose(one["pose"], other["pose"], atol=1e-5)


def test_actions_beyond_the_box_are_refused_or_clipped():
    envs = make()
    envs.reset(seed=0)
    for row, message in (
        (
            [0.0, 0.6, 0.0],
            "action 3 is (0, 0.6, 0): vx from -0.3 to 0.7 m/s, vy up to 0.5 m/s, w up to 2 rad/s",
        ),
        ([0.0, np.nan, 0.0], "action 3 is (0, nan, 0)"),
    ):
        rows = np.zeros((32, 3), np.float32)
        rows[3] = row
        with pytest.raises(ValueError, match=re.escape(message)):
            envs.step(rows)
    with pytest.raises(ValueError, match=re.escape("actions have shape (32, 2): give (vx, vy, w) for each")):
        envs.step(np.zeros((32, 2), np.float32))
    clips = make(preset=replace(CONFIG, drive=replace(DRIVE, clips=True)))
    clips.reset(seed=0), envs.reset(seed=0)
    for action in plan(10):
        np.testing.assert_array_equal(
            clips.step(9 * action)[4]["pose"],
            envs.step(np.clip(9 * action, LOW, HIGH).astype("f4"))[4]["pose"],
        )


@pytest.mark.parametrize("who", [TruePath, lambda envs: DrivingExplorer(envs.config, lambda: np.zeros(0))])
def test_who_drives_as_the_body_heads_is_refused_in_a_line(who):
    with pytest.raises(ValueError, match="drives only along its heading: use a drive with sideways=0"):
        who(make(houses=[EMPTY]))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"sideways": -1.0}, "sideways -1.0 m/s, turn_speed 3.0 rad/s: none may be negative"),
        ({"sideways": 0.5, "commands": ((0.7, 0.0),)}, "command (0.7, 0.0): (vx, vy, w) must not"),
        ({"sideways": 0.5, "commands": ((0.7, 0.6, 0.0),)}, "command (0.7, 0.6, 0.0): (vx, vy, w) must"),
        ({"commands": ((0.7, 0.0, 0.0),)}, "must not exceed the maximum speeds"),
    ],
)
def test_impossible_motions_are_refused(values, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        Drive(**values)
