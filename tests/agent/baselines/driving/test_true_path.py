"""The body that drives along the shortest path, compared with paths on a fine grid by SciPy. 5 s."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from tests.sim.backends.free_study import Solids, houses
from vitruvius.agent.baselines.driving.true_path import TruePath
from vitruvius.logic import FreeWall, House, Room
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.config import DRIVE, Config
from vitruvius.sim.drive import Drive

HALL = Room(0, 0, 9, 9, "R0", "hall")
RADIUS, SPEED, TIME_STEP = DEFAULT.body[0] / 2, DEFAULT.drive.speed, DEFAULT.drive.time_step
PITCH = 0.06
"""Distance between places of the grid, in metres."""


def by_grid(house: House, start: np.ndarray, target: np.ndarray) -> float:
    """Return the length of a disc's path to a target on a grid with eight directions, in metres."""
    solids = Solids(house)
    west, north, east, south = shapely.total_bounds(solids.lines)
    x, y = np.arange(west, east, PITCH), np.arange(north, south, PITCH)
    places = np.stack(np.meshgrid(x, y), axis=-1)
    free = (solids.away(places.reshape(-1, 2)) > RADIUS).reshape(places.shape[:2])
    rows, columns = len(y), len(x)
    numbers, pairs = np.arange(free.size).reshape(rows, columns), []
    for dx, dy in ((1, 0), (0, 1), (1, 1), (1, -1)):
        here, there = slice(max(0, -dy), rows - max(0, dy)), slice(max(0, dy), rows + min(0, dy))
        one, other = numbers[here, : columns - dx], numbers[there, dx:]
        both = free.ravel()[one] & free.ravel()[other]
        pairs.append((one[both], other[both], np.full(both.sum(), PITCH * np.hypot(dx, dy))))
    one, other, length = map(np.concatenate, zip(*pairs, strict=True))
    graph = coo_array((length, (one, other)), (free.size, free.size)).tocsr()
    spots = places.reshape(-1, 2)
    first = np.where(free.ravel(), np.hypot(*(spots - start).T), np.inf).argmin()
    gap = (np.abs(spots - target) - DEFAULT.target / 2).clip(0)
    near = np.hypot(*gap.T) < RADIUS
    return float(dijkstra(graph, directed=False, indices=first)[near].min(initial=np.inf))


@pytest.mark.parametrize(
    ("config", "share"),
    [
        (DEFAULT, 1.0),
        (replace(DEFAULT, drive=Drive(acceleration=float("inf"), turn_acceleration=float("inf"))), 1.0),
        # A body that stops at obstacles may be stuck there.
        (replace(DEFAULT, drive=Drive(at_contact="stop", reverse=0.5)), 0.75),
        (DRIVE, 1.0),
    ],
    ids=["slide", "agile", "stop", "commands"],
)
def test_it_finds_each_target_that_can_be_reached_in_little_more_than_the_shortest_time(
    config: Config, share: float
):
    bank = houses(12, seed=80)
    envs = HouseVectorEnv(bank, len(bank), backend="free", preset=replace(config, steps=700), targets="all")
    envs.reset(seed=5, options={"house": np.arange(len(bank))})
    path, told = TruePath(envs), envs.info()
    ways = np.array(
        [
            by_grid(house, pose[:2], target)
            for house, pose, target in zip(bank, told["pose"], told["target"], strict=True)
        ]
    )
    first = np.full(len(bank), np.inf)
    for step in range(1, 700):
        reward = envs.step(path.act())[1]
        first[(reward > 0) & (first == np.inf)] = step
    seconds, reached = TIME_STEP * first, np.isfinite(ways)
    assert np.isinf(first[~reached]).all()
    assert (seconds <= 1.5 * ways / SPEED + 4.0)[reached].mean() >= share


def test_a_body_that_is_shut_in_finds_nothing():
    shut = House((HALL,), hub="R0", topology="own", free_walls=(FreeWall(4.5, 0.0, 4.5, 9.0, 0.0),))
    envs = HouseVectorEnv([shut], 1, backend="free", targets="all")
    envs.reset(seed=0, options={"house": [0], "pose": [[2, 2, 0.0]], "target": [[7, 7]]})
    path = TruePath(envs)
    assert sum(envs.step(path.act())[1][0] for _ in range(100)) == 0


def test_bodies_on_a_lattice_have_an_oracle():
    with pytest.raises(ValueError, match="robot: use the backend free, or the oracle"):
        TruePath(HouseVectorEnv([House((HALL,), hub="R0", topology="own")], 1))
