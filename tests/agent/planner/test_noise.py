"""Sensor and wheels with errors: the planner's estimates compared with the truth."""

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import torch

from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.agent.planner import TAKEN, TUNED, Planner
from vitruvius.agent.policies.policies import Explorer
from vitruvius.logic import House, generate
from vitruvius.sim.config import DEFAULT, NOISY

pytestmark = pytest.mark.second_part("the planner in noisy worlds")

E = 64


SLIPPERY = replace(DEFAULT, slip=0.01)


@cache
def houses() -> list[House]:
    """Return the houses of all walks; they are not made as tests are collected."""
    return [house for rooms in (3, 5) for house in generate(rooms, grammar="family", seed=7, count=8)]


class Play(NamedTuple):
    """Record of an explorer's steps."""

    pose: np.ndarray
    """Poses of the eye, (T, E, 3)."""
    taken: np.ndarray
    """Poses of the eye as the planner estimated them, (T, E, 3)."""
    action: np.ndarray
    """Actions, (T, E)."""
    blocked: np.ndarray
    """True if the action was blocked, (T, E)."""
    found: float
    """Number of targets picked up, all environments together."""
    planner: Planner


@cache
def play(config, steps, tuned=TUNED):
    envs = make_envs(houses(), E, "secondary", preset=config)
    policy = Explorer(shield(envs), envs.config, tuned)
    observation, info = envs.reset(seed=1, options={"house": np.arange(E) % len(houses())})
    policy.begin(E)
    blocked, rows, found = torch.zeros(E, dtype=torch.bool), [], 0.0
    for _ in range(steps):
        pose = info["pose"].copy()
        action = policy(torch.from_numpy(observation), blocked).clone()
        taken = [policy.tracker.planner.read(name).numpy() for name in ("x", "y", "heading")]
        observation, reward, _, _, info = envs.step(action.numpy())
        blocked = torch.from_numpy(info["blocked"].copy())
        rows.append((pose, np.stack(taken, axis=-1), action.numpy(), info["blocked"].copy()))
        found += reward.sum()
    pose, taken, actions, blocks = map(np.stack, zip(*rows, strict=True))
    return Play(pose, taken, actions, blocks, found, policy.tracker.planner)


def changed(places):
    """Return a mask (T - 1, E) of places that changed from one step to the next."""
    return (np.abs(np.diff(places, axis=0)) > 1e-4).any(axis=-1)


def test_wheels_slip_as_often_as_stated_and_nothing_says_so():
    played = play(SLIPPERY, 400)
    slipped = ~changed(played.pose) & ~played.blocked[:-1]
    assert slipped.mean() == pytest.approx(0.01, abs=4 * np.sqrt(0.01 * 0.99 / slipped.size))


@pytest.mark.parametrize(
    ("config", "steps", "missed", "false"), [(SLIPPERY, 400, 0.15, 0), (NOISY, 1500, 0.2, 0.005)]
)
def test_the_planner_tells_from_its_rays_whether_wheels_slipped(config, steps, missed, false):
    """It misses few slips, those in corridors without furniture, and takes hardly a step for a slip."""
    played = play(config, steps)
    went, thought, free = changed(played.pose)[20:], changed(played.taken)[20:], ~played.blocked[20:-1]
    slipped = ~went & free
    assert slipped.sum() > 100
    assert thought[slipped].mean() <= missed
    assert (~thought[went]).mean() <= false


def test_noise_costs_little():
    assert play(NOISY, 1500).found > 0.85 * play(DEFAULT, 1500).found


def test_by_noisy_rays_no_more_is_occupied_than_by_exact_ones():
    """Later rays that pass clear the cells in the middle of the way that single rays marked."""
    noisy, exact = (
        np.mean([(play(config, 1500).planner.occupancy(e) == TAKEN).sum() for e in range(E)])
        for config in (NOISY, DEFAULT)
    )
    assert 0.75 < noisy / exact < 1.4


def test_a_larger_map_is_the_same_map_where_the_smaller_is_large_enough():
    small, large = play(DEFAULT, 1500), play(DEFAULT, 300, replace(TUNED, map_bits=9))
    np.testing.assert_array_equal(small.action[:300], large.action)


def test_a_map_has_8_to_10_bits():
    with pytest.raises(ValueError, match="map_bits must be 8, 9 or 10, not 11"):
        replace(TUNED, map_bits=11)
    assert Planner(DEFAULT, 1, replace(TUNED, map_bits=10)).occupancy(0).shape == (1024, 1024)
