"""Lists of visible and reachable things omit nothing: results equal those with all boxes of a house."""

from dataclasses import replace

import numpy as np
import pytest

from tests import sample_houses
from tests.maps import random_map
from tests.plans import PLANS, random_plan
from tests.reference import Boxes, sights, stopped
from vitruvius.sim import DEFAULT, PAPER, Config, HouseVectorEnv
from vitruvius.sim.backends.blocks import CELL, HEADER, LONGEST, empty_blocks

HOUSES = [
    *(sample_houses.random_house(seed, original) for seed in range(100, 110) for original in (False, True)),
    PLANS["living"],
    *map(random_plan, range(3)),
    random_map(3, 0.3),
]
EACH = 100
"""Number of poses in each house."""

SMALL = Config(body=(0.02, 0.02))
CONFIGS = {
    "default": DEFAULT,
    "all round": replace(SMALL, rays=120, step=2.5),
    "just more than half": replace(SMALL, rays=22, ray_spacing=9, first_ray=94.0, step=0.4),
    "one short ray": replace(SMALL, rays=1, first_ray=-7.0, range=1.2, target=0.1),
    "a body that grows as it turns": replace(PAPER, collision="swept", sees_angle=False, step=0.3),
}


@pytest.fixture(scope="module", params=CONFIGS)
def envs(request):
    config = replace(CONFIGS[request.param], sees_kind=True, ends_on_collision=False)
    return HouseVectorEnv(HOUSES, num_envs=EACH * len(HOUSES), preset=config)


@pytest.fixture(scope="module")
def posed(envs):
    """Return possible poses of a body, half of them exactly on the edges of the lists' cells.

    The result is houses, origins, cells, targets.
    """
    config, rng, found = envs.config, np.random.default_rng(7), []
    for shape in envs.world.bank.geometries:
        west, north, east, south = shape.bounds
        place = rng.uniform((west, north), (east, south), (80 * EACH, 2))
        edges = (west, north) + CELL * np.round((place - (west, north)) / CELL)
        on_edge = rng.random(place.shape) < 0.3
        place = np.where(on_edge, edges + rng.choice([-1e-6, 0, 1e-6], place.shape), place)
        heading = rng.integers(8, size=len(place))
        eye, half = place + shift(config, heading), half_side(config, heading)
        inside = shape.holds(eye)
        place = place.astype(np.float32)
        inside &= Boxes.of(shape).clear(place + half[:, None] - config.eye[0], half)
        assert inside.sum() >= EACH
        found.append((place[inside][:EACH], heading[inside][:EACH]))
    place, heading = (np.concatenate(rows) for rows in zip(*found, strict=True))
    target = place + rng.uniform(-1.5, 1.5, place.shape)
    return np.repeat(np.arange(len(HOUSES)), EACH), place, heading, target.astype(np.float32)


def shift(config: Config, heading: np.ndarray) -> np.ndarray:
    """Return the offset from a body's place to its eye, metres: (n, 1)."""
    return np.where(heading % 2, config.eye[1] - config.eye[0], 0.0)[:, None]


def half_side(config: Config, heading: np.ndarray) -> np.ndarray:
    """Return half of a body's side, metres: (n,)."""
    return np.where(heading % 2, config.body[1], config.body[0]) / 2


def put(envs: HouseVectorEnv, posed) -> tuple[np.ndarray, np.ndarray]:
    """Place the bodies, and return their observations and their poses."""
    house, origin, heading, target = posed
    pose = np.column_stack([origin + shift(envs.config, heading), heading * np.pi / 4])
    seen, info = envs.reset(seed=0, options={"house": house, "pose": pose, "target": target})
    return seen, info["pose"].astype(float)


def test_rays_hit_the_nearest_of_all_lines_of_the_house(envs, posed):
    config = envs.config
    seen, pose = put(envs, posed)
    angle = 45.0 * posed[2][:, None] + config.first_ray - config.ray_spacing * np.arange(config.rays)
    unsure = 0
    for k, shape in enumerate(envs.world.bank.geometries):
        here = posed[0] == k
        eye, target = (np.repeat(rows[here], config.rays, axis=0) for rows in (pose[:, :2], posed[3]))
        distance, kind, near, sure = sights(
            Boxes.of(shape), eye, np.deg2rad(angle[here]).ravel(), target, config.target, config.range
        )
        ours = seen[here].reshape(-1, 4)
        np.testing.assert_allclose(ours[near, 0].astype(float) * config.range, distance[near], atol=4e-6)
        np.testing.assert_array_equal((ours[:, 1:] @ np.array([1, 2, 3]))[sure], kind[sure])
        unsure += (~sure).sum()
    assert unsure < 2e-3 * angle.size


@pytest.mark.parametrize("action", [0, 1, 2])
def test_moves_are_blocked_just_where_some_box_of_the_house_is_in_the_path(envs, posed, action):
    config = envs.config
    _, before = put(envs, posed)
    _, _, _, _, info = envs.step(np.full(envs.num_envs, action))
    house, origin, heading, _ = posed
    turned = (heading + (1, 7, 0)[action]) % 8
    half = half_side(config, turned)
    way = np.column_stack([np.cos(heading * np.pi / 4), -np.sin(heading * np.pi / 4)])
    old = origin.astype(float) + half[:, None] - config.eye[0]
    new = old + (np.round(way) * config.step if action == 2 else 0.0)
    grows = config.body[0] != config.body[1]
    assert info["blocked"].any() == (action == 2 or grows)
    sure = 0
    for k, shape in enumerate(envs.world.bank.geometries):
        here = house == k
        blocked, certain = stopped(Boxes.of(shape), old[here], new[here], half[here])
        np.testing.assert_array_equal(info["blocked"][here][certain], blocked[certain])
        sure += certain.sum()
    assert sure > 0.98 * envs.num_envs
    moved = np.abs(info["pose"] - before).max(axis=1) > 1e-6
    np.testing.assert_array_equal(moved, ~info["blocked"])


@pytest.mark.parametrize(("most", "length"), [([10, LONGEST + 1], 1), ([10, 10], LONGEST)])
def test_a_house_with_more_than_a_cell_can_list_is_named(most, length):
    header, counts = np.zeros((2, HEADER), np.int32), np.array([[1, 0], [length, 1]])
    with pytest.raises(ValueError, match="house 1 of 2 has more walls and furniture than this backend can"):
        empty_blocks(header, np.array(most), np.array([0, 0, 1]), np.array([True, False, True]), counts)
