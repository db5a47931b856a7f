"""The limit of a searcher that knows the house: exact in houses so small that all routes can be tried."""

from functools import cache

import numpy as np
import pytest

from agent.learning.environments import make_envs
from benchmarks.planner.known_house import NEVER, Search, known_house_limit
from benchmarks.planner.known_house_tables import search_of
from sim.baselines.lookout import in_steps
from sim.baselines.oracle import Oracle
from sim.baselines.searcher import SAMPLES
from tests.sample_houses import random_house


def random_search(seed: int) -> Search:
    """A tree of poses; each shows some places, and every place is seen from somewhere."""
    rng, poses, places = np.random.default_rng(seed), 9, 5
    after = np.full((poses, 3), -1, np.int32)
    for pose in range(1, poses):
        joined = int(rng.integers(pose))
        for one, other in ((pose, joined), (joined, pose)):
            free = np.flatnonzero(after[one] < 0)
            if not len(free):  # That one has three neighbours: this begins a new branch from the last.
                return random_search(seed + 1000)
            after[one, free[0]] = other
    distance = distances(after)
    picked = rng.integers(poses, size=places)
    shown = (rng.random((poses, places)) < 0.15) | (distance[:, picked] == 0)
    return Search(after, shown, distance[:, picked], np.ones(poses, bool))


def distances(after: np.ndarray) -> np.ndarray:
    """Steps between all poses, by Floyd and Warshall."""
    count = len(after)
    distance = np.where(np.eye(count, dtype=bool), 0, NEVER)
    for pose, action in np.argwhere(after >= 0):
        distance[pose, after[pose, action]] = 1
    for k in range(count):
        distance = np.minimum(distance, distance[:, k : k + 1] + distance[k : k + 1])
    return distance


def optimum(search: Search, pose: int) -> float:
    """Expected steps of the best of all routes: between poses that show something new."""
    distance = distances(search.after)

    def seen(pose: int, time: int, left: frozenset[int]) -> tuple[float, frozenset[int]]:
        new = {n for n in left if search.shown[pose, n]}
        return sum(time + search.away[pose, n] for n in new), left - new

    @cache
    def rest(pose: int, left: frozenset[int]) -> float:
        """Least cost from here, counted from now, of places that are left; a step costs all that are left."""
        if not left:
            return 0.0
        best = np.inf
        for action in range(3):
            there = int(search.after[pose, action])
            if there >= 0 and any(search.shown[there, n] for n in left):
                cost, fewer = seen(there, 0, left)
                best = min(best, len(left) + cost + rest(there, fewer))
        for there in range(len(distance)):
            new = any(search.shown[there, n] for n in left)
            on_way = any(
                search.shown[k, n]
                for k in range(len(distance))
                if k not in (pose, there) and distance[pose, k] + distance[k, there] == distance[pose, there]
                for n in left
            )
            if new and not on_way and distance[pose, there] > 1:
                cost, fewer = seen(there, 0, left)
                best = min(best, len(left) * distance[pose, there] + cost + rest(there, fewer))
        return best

    cost, left = seen(pose, 0, frozenset(range(search.shown.shape[1])))
    return (cost + rest(pose, left)) / search.shown.shape[1]


@pytest.mark.parametrize("seed", range(12))
def test_in_a_tiny_house_the_best_route_is_found(seed: int) -> None:
    search = random_search(seed)
    limit = known_house_limit(search, 0, np.ones(5, bool))
    best = optimum(search, 0)
    assert limit.oracle <= best <= limit.best + 1e-9
    assert limit.best <= limit.greedy
    assert limit.best == pytest.approx(best)


def test_what_is_seen_at_once_costs_what_the_oracle_needs() -> None:
    search = random_search(1)
    limit = known_house_limit(
        Search(search.after, np.ones_like(search.shown), search.away, search.views), 0, np.ones(5, bool)
    )
    assert limit.oracle == limit.greedy == limit.best


def test_a_house_without_a_place_or_a_path_has_no_limit() -> None:
    search = random_search(0)
    with pytest.raises(ValueError, match="needs a place"):
        known_house_limit(search, 0, np.zeros(5, bool))
    search.away[0, 0] = NEVER
    with pytest.raises(ValueError, match="a path to each"):
        known_house_limit(search, 0, np.ones(5, bool))


def test_the_oracle_takes_the_steps_that_the_tables_of_its_house_say() -> None:
    envs = make_envs([random_house(0)], 1, "secondary")
    search = search_of(envs, 0)
    envs.reset(seed=3)
    world, oracle = envs.unwrapped.world, Oracle(envs)
    here, state = world.places[0], world.state
    cell, lattice = state["wholes"][0, :3], world.lattices[0]
    pose = (cell[0] * lattice.shape[1] + cell[1]) * 8 + cell[2]
    target = (world.describe()[1][0] - np.asarray(lattice.origin)) / world.config.step
    places = here.targets[here.spread(in_steps(SAMPLES, world))]
    near = np.abs(places - target).max(axis=1)
    taken = 0
    while not envs.step(oracle.act())[1][0]:
        taken += 1
    # The target lies between the places: as far from each as they lie apart, and some turns.
    assert abs(search.away[pose, near.argmin()] - taken - 1) <= near.min() + 8
    assert (search.shown | (search.away > 0)).all()  # What the body touches is seen.
