"""What rays see, against the float64 reference."""

import numpy as np
import pytest

from logic import House
from sim import DEFAULT, HouseVectorEnv
from sim.geometry import geometry
from tests import worlds
from tests.reference import CLOSE, Reference, cast, sides

OFFSETS = np.deg2rad(DEFAULT.first_ray - DEFAULT.ray_spacing * np.arange(DEFAULT.rays))
FAR_AWAY = (-50.0, -50.0)
EACH = 400
"""Poses in each house."""

MIRROR = worlds.drawn("a+a\n...\n...\n...", cell=1.0)
DOOR = worlds.drawn("aaaa....\naaa+....\naaaa....", cell=1.0)
WIDE = worlds.drawn("a+a......\n.........", cell=4.0)
HOUSES = [*worlds.RANDOM, MIRROR, DOOR, WIDE]


@pytest.fixture(scope="module")
def envs():
    return HouseVectorEnv(HOUSES, num_envs=EACH)


@pytest.fixture(scope="module")
def looked(envs):
    """Look at one house: poses (n, 3) and targets (n, 2) give observations, and the exact float32 poses."""

    def look(house: House, pose: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        pose, target = np.asarray(pose, float), np.asarray(target, float)
        filled = [np.resize(rows, (EACH, rows.shape[1])) for rows in (pose, target)]
        options = {"house": np.full(EACH, HOUSES.index(house)), "pose": filled[0], "target": filled[1]}
        observation, info = envs.reset(seed=0, options=options)
        assert np.abs(info["pose"] - filled[0]).max() < 1e-5
        used = info["pose"][: len(pose)].astype(float)
        used[:, 2] = np.round(used[:, 2] / (np.pi / 4)) * np.pi / 4  # the kernel knows headings exactly
        return observation[: len(pose)], used

    return look


def expected(
    lines: np.ndarray, pose: np.ndarray, target: np.ndarray, slack: float
) -> tuple[np.ndarray, np.ndarray]:
    """Distances and what is the target, by the reference, with all edges longer by ``slack``."""
    eye, angle = pose[:2], pose[2] + OFFSETS
    solid = np.minimum(cast(lines, eye, angle, slack), DEFAULT.range)
    half = np.float32(DEFAULT.target / 2)
    edges = np.concatenate([target - half, target + half]).astype(float)
    goal = cast(sides([edges]), eye, angle, slack)
    if np.abs(target - eye).max() < DEFAULT.target / 2:
        goal[:] = np.inf  # a box is seen from outside only
    return np.minimum(solid, goal), goal < solid


@pytest.mark.parametrize("house", worlds.RANDOM)
def test_rays_are_the_references(envs, looked, house):
    """From the kernel's own float32 inputs; that those are the house's is test_sim_geometry's claim."""
    pose = worlds.free_poses(house, EACH, seed=0)
    rng = np.random.default_rng(0)
    away, side = rng.uniform(0.3, 2.5, len(pose)), rng.uniform(0, 2 * np.pi, len(pose))
    target = pose[:, :2] + away[:, None] * np.column_stack([np.cos(side), np.sin(side)])
    target = target.astype(np.float32)
    observation, used = looked(house, pose, target)
    solids = envs.world.bank.geometries[HOUSES.index(house)].solids
    rows = np.hstack([solids[:, :2] - solids[:, 2:], solids[:, :2] + solids[:, 2:]]).astype(np.float32)
    lines, close = sides(rows.astype(float)), 0
    for e in range(len(pose)):
        short, seen_short = expected(lines, used[e], target[e], -CLOSE)
        distance, seen = expected(lines, used[e], target[e], CLOSE)
        decided = (np.abs(short - distance) < 1e-9) & (seen == seen_short)
        close += (~decided).sum()
        error = np.abs(observation[e, :, 0] * DEFAULT.range - distance)
        assert error[decided].max() < 4e-6
        np.testing.assert_array_equal(observation[e, decided, 1], seen[decided])
    assert close < 0.002 * observation[..., 0].size


@pytest.mark.parametrize("house", worlds.RANDOM)
def test_no_ray_leaks_through_a_corner(looked, house):
    """Rays aimed exactly at where two lines meet: each must stop there or before."""
    rng, reference = np.random.default_rng(0), Reference(house)
    west, north, east, south = geometry(house).bounds
    poses, rays, far = [], [], []
    while len(poses) < EACH:
        joint = reference.joints[rng.integers(len(reference.joints))]
        heading, ray = rng.integers(8), rng.integers(40)
        angle, away = heading * np.pi / 4 + OFFSETS[ray], rng.uniform(0.3, 5)
        eye = joint - away * np.array([np.cos(angle), -np.sin(angle)])
        inside = west < eye[0] < east and north < eye[1] < south
        if inside and reference.is_free(eye, DEFAULT.body[0]):
            poses.append((*eye, heading * np.pi / 4))
            rays.append(ray)
            far.append(away)
    observation, _ = looked(house, np.array(poses), np.tile(FAR_AWAY, (len(poses), 1)))
    distance = observation[np.arange(len(poses)), rays, 0] * DEFAULT.range
    assert (distance <= np.array(far) + 1e-4).all()


def test_rays_are_mirror_symmetric(looked):
    observation, _ = looked(MIRROR, np.array([[1.5, 3.0, np.pi / 2]]), np.array([[1.5, 1.5]]))
    np.testing.assert_allclose(observation[0], observation[0, ::-1], atol=1e-6)
    assert observation[0, 19:21, 1].all()


def test_a_wall_hides_a_target_and_an_open_door_does_not(looked):
    pose = np.array([[6.0, 1.5, np.pi], [6.0, 1.5, np.pi], [6.0, 0.5, np.pi]])
    target = np.array([[3.3, 1.5], [3.3, 0.4], [3.3, 0.4]])
    observation, _ = looked(DOOR, pose, target)
    assert observation[:, :, 1].any(axis=1).tolist() == [True, False, False]


def test_what_is_beyond_the_range_is_not_seen(looked):
    observation, _ = looked(WIDE, np.array([[18.0, 6.0, 0.0]]), np.array([[29.0, 6.0]]))
    ahead = observation[0, 19:21]
    np.testing.assert_array_equal(ahead, [[1, 0], [1, 0]])
