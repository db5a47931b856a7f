"""Thick walls stop bodies and rays at their faces, in both backends, and doorways have jambs. 15 s."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import shapely

from tests.plans import PLANS
from tests.reference import Reference, cast
from tests.sim.backends.agreement import require_equal_rays
from tests.thick import faces, thickened
from vitruvius.agent.baselines.searcher import Searcher
from vitruvius.logic import House, check
from vitruvius.logic.house.promises import Promises
from vitruvius.sim import DEFAULT, HouseVectorEnv, Oracle, shortest_path
from vitruvius.sim.actions import FORWARD

HOUSES = [thickened(house) for house in PLANS.values()]
EACH = 200


def lines_of(house: House) -> np.ndarray:
    """Return all lines that stop a ray, (S, 2, 2)."""
    pieces = [shapely.box(*piece.box).boundary for room in house.rooms for piece in room.pieces]
    parts = [faces(house), *pieces]
    return np.array([pair for each in shapely.get_parts(parts) for pair in pairwise(each.coords)])


def poses(house: House) -> np.ndarray:
    """Return free places, some of them in doorways, and headings."""
    rng, reference, found = np.random.default_rng(0), Reference(house), list[list[float]]()
    doors = [door for door in house.doors if not door.is_entrance]
    while len(found) < EACH:
        if len(found) % 2:
            door = doors[rng.integers(len(doors))]
            place = np.array([door.x + door.width / 2, door.y + door.height / 2]) + rng.uniform(-0.2, 0.2, 2)
        else:
            room = house.rooms[rng.integers(len(house.rooms))]
            place = rng.uniform(room.box[:2], room.box[2:])
        if reference.is_free(place, 0.3):
            found.append([*place, np.pi / 4 * rng.integers(8)])
    return np.array(found)


def test_hand_made_plans_with_walls_keep_what_the_check_asks() -> None:
    for house in HOUSES:
        assert check(house, Promises(passage=0.3, door_clearance=0.0)) == []


@pytest.mark.parametrize("number", range(len(HOUSES)))
def test_moves_and_rays_are_those_of_the_edge_of_rooms_and_doorways(number: int) -> None:
    house = HOUSES[number]
    envs, at = HouseVectorEnv([house], num_envs=EACH, targets="all"), poses(house)
    seen, before = envs.reset(seed=0, options={"house": np.zeros(EACH, int), "pose": at})
    angles, lines = np.radians(58.5 - 3.0 * np.arange(40)), lines_of(house)
    far = envs.config.range
    start = before["pose"].astype(float)
    for e in range(EACH):
        expected = np.minimum(cast(lines, start[e, :2], start[e, 2] + angles), far)
        ours = seen[e, :, 0] * far
        # A ray that just passes the end of a line may go either way; a target may be nearer.
        assert (np.abs(ours - expected) < 1e-3).mean() > 0.9 or seen[e, :, 1].any()
    reference, decided = Reference(house), 0
    *_, after = envs.step(np.full(EACH, FORWARD))
    for e in range(EACH):
        step = np.round([np.cos(start[e, 2]), -np.sin(start[e, 2])]) * DEFAULT.step
        expected = reference.in_the_way(start[e, :2], start[e, :2] + step, DEFAULT.body[0])
        decided += expected is not None
        assert expected is None or after["blocked"][e] == expected
    assert decided > 0.9 * EACH


def test_rays_on_the_grid_equal_those_of_the_continuous_backend() -> None:
    require_equal_rays(HOUSES, 1000, "all")


def test_paths_lead_through_doorways_and_through_no_wall() -> None:
    house = thickened(PLANS["chain"])
    first, last = house.room("R0"), house.room("R4")
    pose, goal = [first.x + 1.0, first.y + 1.0, 0.0], [last.x + 1.0, last.y + 1.0]
    path = shortest_path(house, pose, goal)
    assert path is not None
    shut = House(house.rooms, house.doors[:3], house.windows, wall_thickness=house.wall_thickness)
    assert shortest_path(shut, pose, goal) is None


@pytest.mark.parametrize("backend", ["continuous", "grid"])
@pytest.mark.parametrize("closed", [0, 3])
def test_bodies_get_to_targets_in_all_rooms_doors_closed_or_not(backend: str, closed: int) -> None:
    count = 12
    config = replace(DEFAULT, closed_doors=closed)
    envs = HouseVectorEnv(
        HOUSES, num_envs=count, targets="all", backend=backend, max_episode_steps=400, preset=config
    )
    envs.reset(seed=0, options={"house": np.arange(count) % len(HOUSES)})
    found = Oracle(envs).play()
    assert (found > 0).all()
    if not closed:
        envs.reset(seed=0, options={"house": np.arange(count) % len(HOUSES)})
        searcher, mine = Searcher(envs), np.zeros(count)
        for _ in range(400):
            mine += envs.step(searcher.act())[1]
        assert (mine <= found).all()
        assert mine.sum() > 0.4 * found.sum()
