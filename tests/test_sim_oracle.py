"""The oracle's ways are shortest: against searches of what the environments themselves do."""

from collections import deque
from dataclasses import replace

import numpy as np
import pytest

from sim import DEFAULT, PAPER, HouseVectorEnv
from sim.oracle import Oracle
from sim.runtime import Array, Launch, ti
from tests import worlds

HOUSE = worlds.drawn("aaa\naAa\na+a\n...\n...", cell=0.9)
COARSE = replace(DEFAULT, step=0.15)


def transitions(house, origin, config):
    """What each action does from every pose of a lattice, by asking the environment: a table of poses."""
    west, north, east, south = 0.0, 0.0, 2.7, 4.5
    step = config.step
    i = np.arange(np.ceil((west - origin[0]) / step), (east - origin[0]) / step).astype(int)
    j = np.arange(np.ceil((north - origin[1]) / step), (south - origin[1]) / step).astype(int)
    cells = np.array([(a, b, h) for a in i for b in j for h in range(8)])
    place = origin + step * cells[:, :2]
    pose = np.column_stack([place, cells[:, 2] * np.pi / 4])
    envs = HouseVectorEnv([house], num_envs=len(pose), preset=config)
    # A lattice through one origin, as the body has it: float32 sums of origin and steps.
    at = np.full((len(pose), 4), np.nan, np.float32)
    at[:, :2] = origin
    wish = np.column_stack([np.zeros(len(pose)), cells]).astype(np.int32)
    free = standing(envs, at[:, :2], wish)
    moved = {}
    for action in range(3):
        envs.reset(seed=0)
        envs.world.reset(wish, at)
        envs.step(np.full(len(pose), action))
        after = envs.world.state["wholes"][:, :3]
        for k in np.flatnonzero(free):
            moved[tuple(cells[k].tolist()), action] = tuple(after[k].tolist())
    return moved


def standing(envs, origin, cells):
    """Whether the body can be at cells (n, 4) (house, i, j, heading) of origins (n, 2)."""
    arrays = envs.world.arrays | {
        "origins": Array.of(np.ascontiguousarray(origin.ravel())),
        "cells": Array.of(cells.ravel()),
        "free": Array(ti.i32, len(cells)),
    }
    Launch(envs.world.kernels.stand, arrays)()
    return arrays["free"].numpy() != 0


def picks(cell, origin, target, config):
    """Whether a body at a cell overlaps the target."""
    centre = np.asarray(origin) + config.step * np.array(cell[:2])
    return np.abs(centre - target).max() < (config.body[0] + config.target) / 2 - 1e-5


def fewest(moved, start, goal):
    """Forward breadth-first search: the fewest actions (at least one) to a pose where ``goal`` holds."""
    seen, queue = {start}, deque([(start, 0)])
    while queue:
        cell, actions = queue.popleft()
        for action in range(3):
            new = moved[cell, action]
            if goal(new):
                return actions + 1
            if new not in seen:
                seen.add(new)
                queue.append((new, actions + 1))
    raise AssertionError("unreachable")


@pytest.mark.parametrize("targets", ["secondary"])
def test_ways_are_shortest(targets):
    """Each leg of an episode takes exactly as many steps as an exhaustive search says."""
    envs = HouseVectorEnv([HOUSE], targets=targets, preset=COARSE)
    envs.reset(seed=1)
    origin = envs.world.state["reals"][0, :2]
    moved = transitions(HOUSE, origin, COARSE)
    oracle, world = Oracle(envs), envs.world
    for seed in range(6):
        _, info = envs.reset(seed=seed)
        for _ in range(4):
            start, target = tuple(world.state["wholes"][0, :3].tolist()), info["target"][0]
            expected = fewest(moved, start, lambda cell, target=target: picks(cell, origin, target, COARSE))
            steps, reward = 0, 0.0
            while not reward:
                _, (reward,), _, _, info = envs.step(oracle.act())
                steps += 1
                assert steps <= expected
            assert steps == expected
    oracle.close()


@pytest.mark.parametrize("config", [DEFAULT, PAPER])
def test_an_episode_played_is_the_same_as_stepped(config):
    house = worlds.random_house(2)
    envs = HouseVectorEnv([house, HOUSE], num_envs=3, targets="mixed", preset=replace(config, steps=300))
    envs.reset(seed=0)
    oracle = Oracle(envs)
    played = oracle.play()
    envs.reset(seed=0)
    stepped = np.zeros(3)
    for _ in range(300):
        _, reward, terminated, _, info = envs.step(oracle.act())
        assert not info["blocked"].any()
        assert not terminated.any()
        stepped += reward
    np.testing.assert_array_equal(played, stepped)
    assert (played > 0).all()
    oracle.close()


def test_it_finds_the_way_from_wherever_the_body_is():
    """Off the house's own lattice too, and when the agent wanders off between two questions."""
    envs = HouseVectorEnv([HOUSE], num_envs=4, targets="secondary", preset=replace(DEFAULT, steps=2000))
    rng = np.random.default_rng(0)
    pose = np.column_stack([rng.uniform(0.4, 2.3, 4), rng.uniform(3.1, 4.2, 4), np.zeros(4)])
    envs.reset(seed=0, options={"house": np.zeros(4, int), "pose": pose})
    oracle, found = Oracle(envs), np.zeros(4)
    for k in range(400):
        wish = oracle.act()
        wandering = k % 3 == 0
        _, reward, _, _, _ = envs.step(rng.integers(0, 3, 4) if wandering else wish)
        found += reward
    assert (found >= 2).all()
    oracle.close()
