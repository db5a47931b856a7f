"""Sensor noise and drop-outs: their distribution and their independence; and observation columns."""

from dataclasses import replace

import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import DEFAULT, HouseVectorEnv

EXACT = replace(DEFAULT, sees_kind=True)
ROUGH = replace(EXACT, sees_angle=True, noise=0.05, dropout=0.1)
COUNT, STEPS = 400, 40
HOUSES = sample_houses.RANDOM[:4]


def outputs(envs: HouseVectorEnv, seed: int = 0, first: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return observations, poses with targets, and rewards of all steps: (T, E, ...) each."""
    plan = np.random.default_rng(0).choice(3, p=[0.2, 0.2, 0.6], size=(STEPS, COUNT))
    seen, info = envs.reset(seed=seed + first)
    rows = [(seen, np.hstack([info["pose"], info["target"]]), np.zeros(envs.num_envs, np.float32))]
    for actions in plan[:, first : first + envs.num_envs]:
        seen, reward, _, _, info = envs.step(actions)
        rows.append((seen, np.hstack([info["pose"], info["target"]]), reward))
    seen, poses, rewards = zip(*rows, strict=True)
    return np.stack(seen), np.stack(poses), np.stack(rewards)


@pytest.fixture(scope="module")
def exact():
    return outputs(HouseVectorEnv(HOUSES, num_envs=COUNT, preset=EXACT))


@pytest.fixture(scope="module")
def rough():
    return outputs(HouseVectorEnv(HOUSES, num_envs=COUNT, preset=ROUGH))


def test_a_noisy_sensor_changes_only_observations(exact, rough):
    np.testing.assert_array_equal(exact[1], rough[1])
    np.testing.assert_array_equal(exact[2], rough[2])


def test_noise_is_normal_and_drop_outs_are_as_frequent_as_stated(exact, rough):
    """Compare half a million rays, within four standard errors."""
    true, seen = exact[0], rough[0][..., 1:]
    sure = (true[..., 0] * EXACT.range > 0.5) & (true[..., 0] * EXACT.range < EXACT.range - 0.5)
    lost = sure & ~seen[..., 1:].any(axis=-1)
    count = sure.sum()
    assert count > 5e5
    share = 4 * np.sqrt(ROUGH.dropout * (1 - ROUGH.dropout) / count)
    assert lost.sum() / count == pytest.approx(ROUGH.dropout, abs=share)
    assert (seen[lost][:, 0] == 1).all()
    kept = sure & ~lost
    error = (seen[kept][:, 0].astype(float) - true[kept][:, 0]) * ROUGH.range / ROUGH.noise
    scale = 1 / np.sqrt(len(error))
    assert error.mean() == pytest.approx(0, abs=4 * scale)
    assert error.var() == pytest.approx(1, abs=4 * np.sqrt(2) * scale)
    assert (error**3).mean() == pytest.approx(0, abs=4 * np.sqrt(15) * scale)
    assert (error**4).mean() == pytest.approx(3, abs=4 * np.sqrt(96) * scale)
    np.testing.assert_array_equal(seen[kept][:, 1:], true[kept][:, 1:])
    assert seen[..., 0].min() >= 0
    assert seen[..., 0].max() <= 1


def test_errors_of_rays_and_of_steps_are_independent(exact, rough):
    true, seen = exact[0][..., 0], rough[0][..., 1]
    inside = (true > 0.1) & (true < 0.9) & (seen < 1)
    error = np.where(inside, (seen - true) * ROUGH.range / ROUGH.noise, 0.0)
    for one, other in (
        (error[:, :, 1:], error[:, :, :-1]),
        (error[1:], error[:-1]),
        (error[:, 1:], error[:, :-1]),
    ):
        both = (one * other)[(one != 0) & (other != 0)]
        assert both.mean() == pytest.approx(0, abs=4 / np.sqrt(len(both)))


def test_sensor_errors_depend_neither_on_the_loop_nor_on_the_number_of_environments(rough):
    by_ray = outputs(HouseVectorEnv(HOUSES, num_envs=COUNT, preset=ROUGH, by_ray=True))
    for one, other in zip(rough, by_ray, strict=True):
        np.testing.assert_array_equal(one, other)
    alone = outputs(HouseVectorEnv(HOUSES, num_envs=1, preset=ROUGH), first=123)
    for one, other in zip(rough, alone, strict=True):
        np.testing.assert_array_equal(one[:, 123:124], other)


def test_sensor_errors_are_sampled_again_at_each_step():
    envs = HouseVectorEnv(HOUSES, num_envs=COUNT, preset=ROUGH)
    envs.reset(seed=0)
    before = envs.step(np.zeros(COUNT, int))[0]
    again = [envs.step(np.zeros(COUNT, int))[0] for _ in range(8)][-1]
    both = (before[..., 1] < 1) & (again[..., 1] < 1)
    assert (before[both][:, 1] != again[both][:, 1]).mean() > 0.99


def test_columns_are_the_angle_the_distance_and_what_is_hit(exact, rough):
    seen, poses = rough[0], rough[1]
    degrees = np.rad2deg(poses[..., 2, None]) + ROUGH.first_ray - ROUGH.ray_spacing * np.arange(ROUGH.rays)
    np.testing.assert_allclose(seen[..., 0] * 359, degrees % 360, atol=1e-3)
    kinds = exact[0][..., 1:]
    assert set(np.unique(kinds)) == {0, 1}
    # One of wall, furniture and target if something is in range, else none of them.
    np.testing.assert_array_equal(kinds.sum(axis=-1), exact[0][..., 0] < 1)
    assert (kinds.mean(axis=(0, 1, 2)) > 0.01).all()


def test_without_kinds_the_distances_are_the_same(exact):
    seen, poses, _ = outputs(HouseVectorEnv(HOUSES, num_envs=COUNT))
    np.testing.assert_array_equal(seen[..., 0], exact[0][..., 0])
    np.testing.assert_array_equal(poses, exact[1])
    # Of hits at the same distance, the target comes last, with and without observed kinds.
    np.testing.assert_array_equal(seen[..., 1], exact[0][..., 3])
