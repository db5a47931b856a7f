"""The oracle's paths are shortest, compared with searches over the environments' own moves."""

from collections import deque
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from tests import sample_houses
from vitruvius.sim import DEFAULT, PAPER, HouseVectorEnv, Oracle, shortest_path
from vitruvius.sim.oracle.oracle import _Searches
from vitruvius.sim.runtime import Array, Launch, ti
from vitruvius.sim.world.arrays import COUNTERS

HOUSE = sample_houses.drawn("aaa\naAa\na+a\n...\n...", cell=0.9)
COARSE = replace(DEFAULT, step=0.15)


def transitions(house, origin, config):
    """Return the effect of each action from every pose of a lattice, by stepping the environment."""
    west, north, east, south = 0.0, 0.0, 2.7, 4.5
    step = config.step
    i = np.arange(np.ceil((west - origin[0]) / step), (east - origin[0]) / step).astype(int)
    j = np.arange(np.ceil((north - origin[1]) / step), (south - origin[1]) / step).astype(int)
    cells = np.array([(a, b, h) for a in i for b in j for h in range(8)])
    place = origin + step * cells[:, :2]
    pose = np.column_stack([place, cells[:, 2] * np.pi / 4])
    envs = HouseVectorEnv([house], num_envs=len(pose), preset=config)
    # A lattice through one origin, as for the body: float32 sums of origin and steps.
    at = np.full((len(pose), 4), np.nan, np.float32)
    at[:, :2] = origin
    options = np.column_stack([np.zeros(len(pose)), cells]).astype(np.int32)
    free = standing(envs, at[:, :2], options)
    moved = {}
    for action in range(3):
        envs.reset(seed=0)
        envs.world.reset(options, at)
        envs.step(np.full(len(pose), action))
        after = envs.world.state["wholes"][:, COUNTERS:]
        for k in np.flatnonzero(free):
            moved[tuple(cells[k].tolist()), action] = tuple(after[k].tolist())
    return moved


def standing(envs, origin, cells):
    """Return a mask of the cells (n, 4) (house, i, j, heading) at origins (n, 2) in which the body can be."""
    arrays = envs.world.arrays | {
        "origins": Array.of(np.ascontiguousarray(origin.ravel())),
        "cells": Array.of(cells.ravel()),
        "free": Array(ti.i32, len(cells)),
    }
    Launch(envs.world.kernels.stand, arrays)()
    return arrays["free"].numpy() != 0


def picks(cell, origin, target, config):
    """Return True if a body at a cell overlaps the target."""
    centre = np.asarray(origin) + config.step * np.array(cell[:2])
    return np.abs(centre - target).max() < (config.body[0] + config.target) / 2 - 1e-5


def fewest(moved, start, goal):
    """Return the fewest actions, at least one, to a pose where ``goal`` holds (breadth-first search)."""
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


@pytest.fixture(scope="module")
def coarse():
    """Return the effects of all actions in ``HOUSE``, on the lattice of its episodes."""
    envs = HouseVectorEnv([HOUSE], targets="secondary", preset=COARSE)
    envs.reset(seed=1)
    origin = envs.world.state["reals"][0, :2]
    return envs, origin, transitions(HOUSE, origin, COARSE)


def test_paths_of_the_oracle_are_shortest(coarse):
    """Each leg of an episode takes exactly as many steps as an exhaustive search finds."""
    envs, origin, moved = coarse
    oracle, world = Oracle(envs), envs.world
    for seed in range(6):
        _, info = envs.reset(seed=seed)
        for _ in range(4):
            start, target = tuple(world.state["wholes"][0, COUNTERS:].tolist()), info["target"][0]
            expected = fewest(moved, start, lambda cell, target=target: picks(cell, origin, target, COARSE))
            steps, reward = 0, 0.0
            while not reward:
                _, (reward,), _, _, info = envs.step(oracle.act())
                steps += 1
                assert steps <= expected
            assert steps == expected


def test_paths_from_any_pose_are_shortest_and_lead_to_the_target(coarse):
    """From any poses, in a batch: paths take no step of the environment, and end with the pick-up."""
    _, origin, moved = coarse
    rng, count = np.random.default_rng(0), 40
    envs = HouseVectorEnv([HOUSE], num_envs=count, targets="mixed", preset=COARSE)
    starts = [list(moved)[k][0] for k in rng.choice(len(moved), count)]
    pose = np.array([(*(origin + COARSE.step * np.array(cell[:2])), cell[2] * np.pi / 4) for cell in starts])
    _, info = envs.reset(seed=0, options={"house": np.zeros(count, int), "pose": pose})
    before = envs.state
    paths = [found(path) for path in Oracle(envs).paths()]
    for name, array in envs.state.items():
        np.testing.assert_array_equal(array, before[name])
    for start, target, path in zip(starts, info["target"], paths, strict=True):
        assert len(path) == fewest(
            moved, start, lambda cell, target=target: picks(cell, origin, target, COARSE)
        )
    earned = np.zeros(count)
    for k in range(max(map(len, paths))):
        _, reward, _, _, _ = envs.step([path[k] if k < len(path) else 0 for path in paths])
        for e, path in enumerate(paths):
            earned[e] += reward[e] * (k == len(path) - 1)
    assert earned.all()


@pytest.mark.parametrize("config", [DEFAULT, PAPER])
def test_an_episode_played_is_the_same_as_stepped(config):
    house = sample_houses.random_house(2)
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


def test_the_oracle_finds_the_path_from_wherever_the_body_is():
    """The body may be off the house's own lattice, and an agent may move it between two questions."""
    envs = HouseVectorEnv([HOUSE], num_envs=4, targets="secondary", preset=replace(DEFAULT, steps=2000))
    rng = np.random.default_rng(0)
    pose = np.column_stack([rng.uniform(0.4, 2.3, 4), rng.uniform(3.1, 4.2, 4), np.zeros(4)])
    envs.reset(seed=0, options={"house": np.zeros(4, int), "pose": pose})
    oracle, found = Oracle(envs), np.zeros(4)
    for k in range(400):
        best = oracle.act()
        wandering = k % 3 == 0
        _, reward, _, _, _ = envs.step(rng.integers(0, 3, 4) if wandering else best)
        found += reward
    assert (found >= 2).all()


def test_shortest_path_answers_for_one_pose_and_target():
    """Straight ahead the number of actions is obvious; behind a wall there is no path."""
    house = sample_houses.drawn("a+a\n...\n...\n...", cell=1.2)
    reach = (DEFAULT.body[0] + DEFAULT.target) / 2
    path = found(shortest_path(house, (1.8, 3.3, np.pi / 2), (1.8, 1.9)))
    assert path.tolist() == [2] * int(np.ceil((3.3 - 1.9 - reach) / DEFAULT.step))
    turned = found(shortest_path(house, (1.8, 3.3, 3 * np.pi / 2), (1.8, 1.9)))
    assert turned[turned < 2].tolist() in ([0] * 4, [1] * 4)
    assert len(turned) == len(path) + 4
    sealed = replace_door(house)
    assert shortest_path(sealed, (1.8, 3.3, 0.0), (0.6, 0.6)) is None


def found(path: np.ndarray | None) -> np.ndarray:
    """Return a path that must exist."""
    assert path is not None
    return path


def replace_door(house):
    """Return the house with a first room's door that is too narrow for the body."""
    room = house.star.rooms[0]
    narrow = msgspec.structs.replace(room, door=msgspec.structs.replace(room.door, width=0.1))
    return sample_houses.changed_star(house, rooms=(narrow, *house.star.rooms[1:]))


def test_an_oracle_follows_its_environments_to_another_bank():
    envs = HouseVectorEnv([HOUSE], targets="secondary", preset=COARSE)
    oracle = Oracle(envs)
    for houses in ([sample_houses.random_house(2)], [HOUSE]):
        envs.set_houses(houses)
        envs.reset(seed=0)
        _, (reward,), _, _, _ = envs.step(oracle.act())
        while not reward:
            _, (reward,), truncated, _, _ = envs.step(oracle.act())
            assert not truncated


def test_an_oracle_plays_more_episodes_than_it_searches_at_once(monkeypatch):
    envs = HouseVectorEnv([HOUSE], num_envs=5, targets="mixed", preset=replace(COARSE, steps=100))
    envs.reset(seed=0)
    whole = Oracle(envs).play()
    monkeypatch.setattr("vitruvius.sim.oracle.oracle.AT_ONCE", 2)
    envs.reset(seed=0)
    np.testing.assert_array_equal(Oracle(envs).play(), whole)
    assert whole.all()


def test_on_a_grid_an_episode_played_equals_one_stepped():
    """The grid has its own body, step and lattice."""
    cell = 0.3
    house = sample_houses.drawn("aaaa\naAaa\na+aa\n....\n....", cell=3 * cell)
    envs = HouseVectorEnv(
        [house], num_envs=3, backend="grid", targets="mixed", preset=replace(DEFAULT, steps=80)
    )
    envs.reset(seed=0)
    played = Oracle(envs).play()
    envs.reset(seed=0)
    oracle, stepped = Oracle(envs), np.zeros(3)
    for _ in range(80):
        _, reward, _, _, info = envs.step(oracle.act())
        assert not info["blocked"].any()
        stepped += reward
    np.testing.assert_array_equal(played, stepped)
    assert (played > 0).all()


@pytest.mark.parametrize("closed_doors", [0, 4])
def test_a_search_has_room_for_all_poses_in_front_of_closed_doors(closed_doors):
    envs = HouseVectorEnv([HOUSE], num_envs=2, preset=replace(DEFAULT, closed_doors=closed_doors))
    searches = _Searches(envs.world, 2)
    poses, room = searches.arrays["distance"].shape, (1,)
    assert poses == (8 * searches.arrays["moves"].shape[0],) > (2 * 8 * 200,)
    assert [searches.arrays[name].shape for name in ("waiting", "found_at")] == 2 * [
        poses if closed_doors else room
    ]
