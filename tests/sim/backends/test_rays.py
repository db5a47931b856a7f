"""Two million rays compared with the float64 reference."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests import sample_houses
from tests.plans import PLANS, random_plan
from tests.reference import Boxes, sights
from vitruvius.logic import House, generate, load
from vitruvius.sim import DEFAULT, HouseVectorEnv

SEEING = replace(DEFAULT, sees_kind=True)
WALL, PIECE, TARGET = 1, 2, 3
"""Columns of a ray's observation, after the distance."""

EACH = 8000
"""Number of looks at a time, of 40 rays each."""

WORST = 4e-6
"""Largest allowed error of a ray, in metres."""

GOLDEN = Path(__file__).parents[2] / "golden" / "family-4-rooms.json"
MIRROR = sample_houses.drawn("a+a\n...\n...\n...", cell=1.0)
DOOR = sample_houses.drawn("aaaa....\naaa+....\naaaa....", cell=1.0)
WIDE = sample_houses.drawn("a+a......\n.........", cell=4.0)
TWO_ROOMS = "aa+Aa.bbb\n......+bb\n......bbB"
FAR_AWAY = (-50.0, -50.0)


def furnished() -> list[House]:
    if shutil.which("swipl") is None:
        pytest.skip("SWI-Prolog is not here")
    return list(generate(rooms=4, seed=0, count=4))


BANKS = {
    "random": lambda: [
        sample_houses.random_house(seed, original) for seed in range(8) for original in (False, True)
    ],
    "drawn": lambda: [
        MIRROR,
        DOOR,
        WIDE,
        sample_houses.drawn(sample_houses.ONE_ROOM),
        sample_houses.drawn(TWO_ROOMS, cell=1.2),
    ],
    "generated": furnished,
    "golden": lambda: load(GOLDEN),
    "plans": lambda: [PLANS["flat"], PLANS["living"], *map(random_plan, range(4))],
}


@pytest.fixture(scope="module")
def envs():
    return HouseVectorEnv(sample_houses.RANDOM, num_envs=EACH, preset=SEEING)


def look(
    envs: HouseVectorEnv, house: int | np.ndarray, pose: np.ndarray, target: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the observations from poses (n, 3), at most ``EACH``, with targets (n, 2), and the eyes (n, 2).

    The eyes are those of the kernel.
    """
    count, numbers = len(pose), np.resize(np.arange(len(pose)), envs.num_envs)
    house = np.broadcast_to(house, count)[numbers]
    options = {"house": house, "pose": pose[numbers], "target": target[numbers]}
    observation, info = envs.reset(seed=0, options=options)
    assert np.abs(info["pose"] - pose[numbers])[:, :2].max() < 1e-5
    return observation[:count], info["pose"][:count, :2].astype(float)


def angles(heading: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Return directions in radians, from exact degrees: the kernel knows headings exactly."""
    config = SEEING
    return np.deg2rad(45.0 * heading + config.first_ray - config.ray_spacing * rays)


def places(envs: HouseVectorEnv, k: int, rng: np.random.Generator, count: int) -> np.ndarray:
    """Return places (count, 2) in house k where the body certainly can be."""
    shape = envs.world.bank.geometries[k]
    west, north, east, south = shape.bounds
    found, half = np.zeros((0, 2)), max(envs.config.body) / 2
    while len(found) < count:
        place = rng.uniform((west, north), (east, south), (2 * count, 2)).astype(np.float32).astype(float)
        stands = shape.holds(place) & Boxes.of(shape).clear(place, half)
        found = np.concatenate([found, place[stands]])
    return found[:count]


class Tally:
    """Comparison of observations with the reference, house by house."""

    def __init__(self) -> None:
        self.rays = self.sure = 0
        self.worst = 0.0

    def add(self, boxes: Boxes, eye: np.ndarray, angle: np.ndarray, target: np.ndarray, seen: np.ndarray):
        """Compare rays (n,) with their observations, (n, 4): distance, is wall, is piece, is target."""
        for part in np.array_split(np.arange(len(eye)), max(1, len(eye) // 4000)):
            distance, kind, near, sure = sights(
                boxes, eye[part], angle[part], target[part], SEEING.target, SEEING.range
            )
            error = np.abs(seen[part, 0].astype(float) * SEEING.range - distance)[near]
            self.worst = max(self.worst, error.max(initial=0.0))
            found = seen[part, 1:] @ np.array([WALL, PIECE, TARGET])
            np.testing.assert_array_equal(found[sure], kind[sure])
            self.rays += len(part)
            self.sure += sure.sum()


SHARES = {"random": 0.4, "drawn": 0.2, "generated": 0.2, "golden": 0.1, "plans": 0.1}
"""Number of rays in each bank, in millions."""


@pytest.mark.parametrize("bank", BANKS)
def test_a_million_random_rays_equal_those_of_the_reference(envs, bank):
    envs.set_houses(BANKS[bank]())
    rng, tally = np.random.default_rng(0), Tally()
    boxes = [Boxes.of(shape) for shape in envs.world.bank.geometries]
    each = int(SHARES[bank] * 1e6 / 40 / len(boxes))
    for k, here in enumerate(boxes):
        eye, heading = places(envs, k, rng, each), rng.integers(8, size=each)
        away, side = rng.uniform(0.0, 2.5, each), rng.uniform(0, 2 * np.pi, each)
        target = (eye + away[:, None] * np.column_stack([np.cos(side), np.sin(side)])).astype(np.float32)
        seen, eye = look(envs, k, np.column_stack([eye, heading * np.pi / 4]), target)
        ray = np.arange(40)
        tally.add(
            here,
            np.repeat(eye, 40, axis=0),
            angles(heading[:, None], ray).ravel(),
            np.repeat(target, 40, axis=0),
            seen.reshape(-1, 4),
        )
    assert tally.rays >= SHARES[bank] * 0.99e6
    assert tally.worst < WORST
    assert tally.sure > 0.999 * tally.rays


@pytest.mark.second_part("a million")
@pytest.mark.parametrize("bank", BANKS)
def test_a_million_rays_aimed_at_corners_equal_those_of_the_reference_and_none_leaks(envs, bank):
    """Aim rays at the ends of lines: each ends there or before, and no later than in the reference."""
    envs.set_houses(BANKS[bank]())
    rng, tally = np.random.default_rng(1), Tally()
    world, total = envs.world, int(SHARES[bank] * 1e6)
    each = total // len(world.bank.geometries)
    for k, shape in enumerate(world.bank.geometries):
        boxes, done = Boxes.of(shape), 0
        corners = np.concatenate(
            [boxes.all[:, [0, 1]], boxes.all[:, [2, 3]], boxes.pieces[:, [0, 3]], boxes.pieces[:, [2, 1]]]
        )
        while done < each:
            # Corners behind an obstacle count, too: rays must stop all the same.
            corner = corners[rng.integers(len(corners), size=4 * EACH)]
            heading, ray = rng.integers(8, size=len(corner)), rng.integers(40, size=len(corner))
            angle, away = angles(heading, ray), rng.uniform(0.2, 5.0, len(corner))
            eye = corner - away[:, None] * np.column_stack([np.cos(angle), -np.sin(angle)])
            inside = shape.holds(eye)
            inside[inside] = boxes.clear(eye[inside], SEEING.body[0] / 2)
            chosen = np.flatnonzero(inside)[: min(EACH, each - done)]
            heading, ray, angle, away = heading[chosen], ray[chosen], angle[chosen], away[chosen]
            target = np.tile(FAR_AWAY, (len(chosen), 1))
            seen, eye = look(envs, k, np.column_stack([eye[chosen], heading * np.pi / 4]), target)
            seen = seen[np.arange(len(chosen)), ray]
            assert (seen[:, 0] * SEEING.range <= away + 1e-4).all()
            tally.add(boxes, eye, angle, target, seen)
            done += len(chosen)
    assert tally.rays >= 0.99 * total
    assert tally.worst < WORST
    assert tally.sure > 0.5 * tally.rays


def test_rays_are_mirror_symmetric(envs):
    envs.set_houses([MIRROR])
    seen, _ = look(envs, 0, np.array([[1.5, 3.0, np.pi / 2]]), np.array([[1.5, 1.5]]))
    np.testing.assert_allclose(seen[0], seen[0, ::-1], atol=1e-6)
    assert seen[0, 19:21, TARGET].all()


def test_a_wall_hides_a_target_and_an_open_door_does_not(envs):
    envs.set_houses([DOOR])
    pose = np.array([[6.0, 1.5, np.pi], [6.0, 1.5, np.pi], [6.0, 0.5, np.pi]])
    seen, _ = look(envs, 0, pose, np.array([[3.3, 1.5], [3.3, 0.4], [3.3, 0.4]]))
    assert seen[..., TARGET].any(axis=1).tolist() == [True, False, False]


def test_what_is_beyond_the_range_is_not_seen(envs):
    envs.set_houses([WIDE])
    seen, _ = look(envs, 0, np.array([[18.0, 6.0, 0.0]]), np.array([[29.0, 6.0]]))
    np.testing.assert_array_equal(seen[0, 19:21], [[1, 0, 0, 0], [1, 0, 0, 0]])
