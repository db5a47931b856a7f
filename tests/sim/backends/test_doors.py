"""Closed doors: they block bodies and rays, they open, and the oracle's paths through them are shortest."""

from collections import deque
from dataclasses import replace

import numpy as np
import pytest

from tests import sample_houses
from tests.plans import PLANS, random_plan
from tests.reference import Boxes, sights, stopped
from vitruvius.logic import House
from vitruvius.logic.house.parts import Door, Room
from vitruvius.sim import DEFAULT, PAPER, HouseVectorEnv, Oracle
from vitruvius.sim.backends.doors import doorways
from vitruvius.sim.config import DOORS
from vitruvius.sim.geometry import geometry
from vitruvius.sim.world.arrays import COUNTERS


def squares(side: int) -> House:
    """Return rooms of 2.4 m in a square, with a door wherever two share a wall."""
    rooms = [
        Room(2.4 * i, 2.4 * j, 2.4, 2.4, f"R{i}-{j}", "bedroom") for i in range(side) for j in range(side)
    ]
    doors = [
        Door(
            one.x + 2.4 * east + 0.8 * south, one.y + 2.4 * south + 0.8 * east, 0.8 * south, 0.8 * east, names
        )
        for one in rooms
        for other in rooms
        for east, south in ((1, 0), (0, 1))
        if abs(other.x - one.x - 2.4 * east) + abs(other.y - one.y - 2.4 * south) < 1e-6
        for names in [(one.name, other.name)]
    ]
    return House(tuple(rooms), tuple(doors), hub="R0-0", topology="dissection")


HOUSES = [*map(sample_houses.random_house, range(100, 104)), *PLANS.values(), squares(5)]
"""Test houses; the last one has more than 32 doors."""

CELL = 0.45
TWO_ROOMS = sample_houses.drawn("aaaaa.bbb\naAaaa.bbb\naa+aa.bBb\n......+bb\n......bbb\n......bbb", cell=CELL)
TWO_WAYS = sample_houses.drawn("aaa.bbb\naa+.+bb\naaa.bbb\n.......\n.......", cell=0.9)
LOOP = random_plan(4, 4)
"""Rooms in a cycle, so that a detour may cost less than a door."""
EACH = 20


def posed(backend: str, houses: list, seed: int) -> tuple[HouseVectorEnv, np.ndarray, np.ndarray]:
    """Return environments at sampled poses, with the poses (E, 3) and a mask (E, D) bool of closed doors.

    Half of the bodies are less than a step from a door. Each door is open or closed at random.
    """
    rng, count = np.random.default_rng(seed), EACH * len(houses)
    envs = HouseVectorEnv(houses, num_envs=count, backend=backend, preset=DOORS, targets="all")
    house, poses = np.repeat(np.arange(len(houses)), EACH), []
    for k, lattice in enumerate(envs.world.lattices):
        shape = envs.geometries[k]
        spots = lattice.origin + lattice.pitch * np.argwhere(np.ones(lattice.shape, bool))
        half = envs.config.body[0] / 2 - (2e-3 if backend == "grid" else 0)  # bodies on the grid touch walls
        free = spots[shape.holds(spots) & Boxes.of(shape).clear(spots, half)]
        gap = (np.abs(free[:, None] - shape.doors[:, :2]) - shape.doors[:, 2:]).max(axis=2) - half
        near = free[((gap > 0) & (gap < envs.config.step)).any(axis=1)]
        some = [free[rng.integers(len(free), size=EACH // 2)], near[rng.integers(len(near), size=EACH // 2)]]
        poses.append(np.concatenate(some))
    pose = np.column_stack([np.concatenate(poses), rng.integers(8, size=count) * np.pi / 4])
    envs.reset(seed=seed, options={"house": house, "pose": pose})
    standing = envs.world.open_doors
    state = envs.state
    pushes = state["pushes"].reshape(count, -1)
    pushes[:] = np.maximum(pushes, DOORS.closed_doors * (rng.random(pushes.shape) < 0.2))
    envs.state = state | {"pushes": pushes.ravel()}
    assert (envs.world.open_doors >= standing).all()
    return envs, pose, pushes < DOORS.closed_doors


@pytest.mark.second_part("kernels of many configurations")
@pytest.mark.parametrize(("backend", "houses"), [("continuous", HOUSES), ("grid", [TWO_ROOMS] * 4)])
def test_rays_and_moves_meet_closed_doors_and_no_open_ones(backend, houses):
    """Compare with all walls, furniture and closed doors of a house in float64."""
    config = replace(DOORS, closed_doors=1)
    for action in (0, 2):
        envs, pose, closed = posed(backend, houses, seed=action)
        before = envs.state["pushes"].reshape(envs.num_envs, -1)
        seen, _, _, _, info = envs.step(np.full(envs.num_envs, action))
        pushed = (envs.state["pushes"].reshape(before.shape) - before).sum(axis=1)
        half = np.full(EACH, envs.config.body[0] / 2)
        for k, shape in enumerate(envs.geometries):
            here = info["house"] == k
            boxes = [Boxes.of(shape, row[: len(shape.doors)]) for row in closed[here]]
            angle = (
                np.round(4 / np.pi * info["pose"][here, 2, None].astype(float)) * (np.pi / 4)
                + config.ray_angles
            )
            now = [
                Boxes.of(shape, row[: len(shape.doors)])
                for row in (envs.state["pushes"].reshape(before.shape) < DOORS.closed_doors)[here]
            ]
            for e in range(EACH):
                eye = np.repeat(info["pose"][here][e, None, :2].astype(float), config.rays, axis=0)
                target = np.repeat(info["target"][here][e, None], config.rays, axis=0)
                far, kind, near, sure = sights(now[e], eye, angle[e], target, config.target, config.range)
                ours = seen[here][e]
                np.testing.assert_allclose(ours[near, 0] * config.range, far[near], atol=4e-6)
                np.testing.assert_array_equal((ours[:, 1:] @ np.array([1, 2, 4, 3]))[sure], kind[sure])
            if action == 2:
                heading = pose[here, 2]
                way = np.round(np.column_stack([np.cos(heading), -np.sin(heading)])) * envs.config.step
                old = pose[here, :2].astype(np.float32).astype(float)
                for e, box in enumerate(boxes):
                    one = old[e, None], (old + way)[e, None], half[:1]
                    (blocked,), (certain,) = stopped(box, *one)
                    assert not certain or info["blocked"][here][e] == blocked
                    only = Boxes(box.doors[:0], box.doors[:0], box.doors)
                    (met,), (certain,) = stopped(only, *one)
                    assert not certain or pushed[here][e] == met
            else:
                assert not pushed[here].any()
        if action == 2:
            assert pushed.sum() > 0.04 * envs.num_envs
        assert (seen[..., 3].any(axis=1)).mean() > 0.2


@pytest.mark.second_part("many kernels")
@pytest.mark.parametrize("backend", ["continuous", "grid"])
@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_a_door_opens_after_its_steps_and_is_closed_again_in_the_next_episode(backend, mode):
    """A body walks straight at a door, in each autoreset mode."""
    steps, config = 12, replace(DOORS, closed_doors=3)
    envs = HouseVectorEnv(
        [TWO_ROOMS],
        backend=backend,
        preset=config,
        max_episode_steps=steps,
        targets="all",
        autoreset_mode=mode,
    )
    at_door = {"house": [0], "pose": [[2.5 * CELL, 3.5 * CELL, np.pi / 2]], "target": [[0.3, 0.3]]}
    for _ in range(2):
        seen, _ = envs.reset(seed=0, options=at_door)
        assert seen[0, 20, 3] == 1
        assert not envs.world.open_doors.any()
        blocked = []
        for step in range(steps - 1):
            seen, _, _, _, info = envs.step([2])
            blocked.append(bool(info["blocked"][0]))
            assert envs.world.open_doors[0].any() == (sum(blocked) >= 3)
            assert step > 4 or (seen[0, 20, 3] == 1) == (sum(blocked) < 3)
        first = blocked.index(True)
        assert blocked[first : first + 4] == [True, True, True, False]
        envs.step([2])
        if mode == "Disabled":
            envs.reset(seed=0)
        elif mode == "NextStep":
            envs.step([2])
        assert not envs.world.open_doors.any()


@pytest.mark.second_part("many kernels")
def test_a_state_that_is_restored_goes_on_bit_for_bit_also_in_another_environment():
    make = lambda: HouseVectorEnv(HOUSES[:4], num_envs=16, preset=DOORS, targets="all")  # noqa: E731
    envs, other, plan = make(), make(), np.random.default_rng(0).choice(3, p=[0.2, 0.1, 0.7], size=(300, 16))
    envs.reset(seed=0)
    for actions in plan:
        envs.step(actions)
    assert envs.world.open_doors.any()
    state = envs.state
    other.state = state
    for actions in plan:
        ours, theirs = envs.step(actions), other.step(actions)
        np.testing.assert_array_equal(ours[0], theirs[0])
    for name, values in envs.state.items():
        np.testing.assert_array_equal(values, other.state[name])


def test_open_doors_are_the_house_without_doors():
    """With all doors open, observations and moves equal those of the default world."""
    plan = np.random.default_rng(1).choice(3, p=[0.2, 0.1, 0.7], size=(200, 32))
    both = []
    for config in (replace(DEFAULT, sees_kind=True), DOORS):
        envs = HouseVectorEnv(HOUSES, num_envs=32, preset=config, targets="all")
        envs.reset(seed=3)
        if config.closed_doors:
            state = envs.state
            envs.state = state | {"pushes": np.full_like(state["pushes"], DOORS.closed_doors)}
        both.append([envs.step(actions) for actions in plan])
    for plain, doors in zip(*both, strict=True):
        np.testing.assert_array_equal(plain[0], np.delete(doors[0], 3, axis=-1))
        np.testing.assert_array_equal(plain[4]["blocked"], doors[4]["blocked"])


def test_a_bank_may_have_more_doors_than_the_one_before_it():
    envs = HouseVectorEnv(HOUSES[:1], num_envs=2, preset=DOORS, targets="all")
    envs.reset(seed=0)
    envs.set_houses(HOUSES[-1:])
    envs.reset(seed=0)
    count = len(geometry(HOUSES[-1]).doors)
    assert count > 32
    assert doorways([geometry(HOUSES[-1])])[0] == count
    assert envs.world.open_doors.shape == (2, count)
    assert (Oracle(envs).play() > 0).all()


@pytest.mark.parametrize(
    ("config", "changes"),
    [(PAPER, {}), (DEFAULT, {"ends_on_collision": True}), (DEFAULT, {"body": (0.2, 0.3)})],
)
def test_a_world_where_doors_cannot_be_walked_at_is_refused(config, changes):
    with pytest.raises(
        ValueError, match="closed_doors needs collision 'swept', a square body, and ends_on_collision=False"
    ):
        replace(config, closed_doors=4, **changes)
    with pytest.raises(ValueError, match="closed_doors is 256 steps: it must be 0 to 255"):
        replace(DEFAULT, closed_doors=256)


def moves_of(house, origin, config):
    """Return the effect of each action from every pose of a lattice with all doors open.

    It includes the doors that a step meets. The effects are computed with boxes in float64.
    """
    west, north, east, south = geometry(house).bounds
    i = np.arange(np.ceil((west - origin[0]) / config.step), (east - origin[0]) / config.step).astype(int)
    j = np.arange(np.ceil((north - origin[1]) / config.step), (south - origin[1]) / config.step).astype(int)
    place = origin + config.step * np.array([(a, b) for a in i for b in j])
    shape, half = geometry(house), config.body[0] / 2
    free = shape.holds(place) & ~stopped(Boxes.of(shape), place, place, np.full(len(place), half))[0]
    cells = np.array([(a, b) for a in i for b in j])[free]
    moved = {}
    for heading, way in enumerate([(1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1)]):
        old = origin + config.step * cells
        new, size = old + config.step * np.array(way), np.full(len(cells), half)
        blocked, _ = stopped(Boxes.of(shape), old, new, size)
        met = []
        for door in range(len(shape.doors)):
            one = Boxes.of(shape, np.arange(len(shape.doors)) == door)
            met.append(stopped(Boxes(one.doors[:0], one.doors[:0], one.doors), old, new, size)[0])
        for k, cell in enumerate(map(tuple, cells.tolist())):
            moved[(*cell, heading), 0] = (*cell, (heading + 1) % 8), ()
            moved[(*cell, heading), 1] = (*cell, (heading + 7) % 8), ()
            there = (cell[0] + way[0], cell[1] + way[1], heading) if not blocked[k] else (*cell, heading)
            moved[(*cell, heading), 2] = there, tuple(d for d, row in enumerate(met) if row[k])
    return moved


def fewest(moved, start, pushes, goal, steps):
    """Return the fewest actions from a start to one of the places ``goal``, or None.

    Forward breadth-first search over poses and the number of pushes of each door.
    """
    seen, queue = {(start, pushes)}, deque([(start, pushes, 0)])
    while queue:
        cell, pushes, actions = queue.popleft()
        for action in range(3):
            new, met = moved[cell, action]
            shut = next((door for door in met if pushes[door] < steps), None)
            after = pushes
            if shut is not None:
                new, after = cell, tuple(n + (d == shut) for d, n in enumerate(pushes))
            if new[:2] in goal:
                return actions + 1
            if (new, after) not in seen:
                seen.add((new, after))
                queue.append((new, after, actions + 1))
    raise AssertionError("unreachable")


@pytest.mark.second_part("against a search of all ways")
@pytest.mark.parametrize(("backend", "steps"), [("continuous", 1), ("continuous", 6), ("grid", 5)])
def test_paths_of_the_oracle_through_closed_doors_are_shortest(backend, steps):
    """Compare with a search over poses and doors, from any pose, with any number of pushes."""
    house = LOOP if backend == "continuous" else TWO_ROOMS
    config, rng, count = replace(DEFAULT, step=0.15, closed_doors=steps), np.random.default_rng(steps), 8
    envs = HouseVectorEnv([house], num_envs=count, backend=backend, targets="all", preset=config)
    config = envs.config
    _, info = envs.reset(seed=0)
    state, origin = envs.state, envs.state["reals"][0, :2].astype(float)
    moved = moves_of(house, origin, config)
    cells = [list(moved)[k][0] for k in rng.choice(len(moved), count)]
    wholes = state["wholes"].copy()
    wholes[:, COUNTERS:] = cells
    pushes = rng.integers(0, steps + 1, (count, len(geometry(house).doors)))
    for e, cell in enumerate(cells):
        for heading in range(8):  # a door that contains a body is open
            back = moved[(*cell[:2], heading), 2][1]
            pushes[e, list(back)] = steps
    envs.state = state | {"wholes": wholes, "pushes": pushes.astype(np.uint8).ravel()}
    before = envs.state
    paths = Oracle(envs).paths()
    for name, values in envs.state.items():
        np.testing.assert_array_equal(values, before[name])
    through, places = 0, np.array([*{cell[:2] for cell, _ in moved}])
    for e, path in enumerate(paths):
        away = np.abs(origin + config.step * places - info["target"][e]).max(1)
        goal = {*map(tuple, places[away < (config.body[0] + config.target) / 2 - 1e-5].tolist())}
        assert path is not None
        expected = fewest(moved, cells[e], tuple(pushes[e].tolist()), goal, steps)
        assert len(path) == expected
        opened = fewest(moved, cells[e], (steps,) * pushes.shape[1], goal, steps)
        through += expected > opened
    assert through > 0


@pytest.mark.second_part("many kernels")
def test_an_episode_that_the_oracle_plays_equals_one_stepped():
    envs = HouseVectorEnv([TWO_WAYS, *HOUSES], num_envs=9, targets="all", preset=DOORS, max_episode_steps=300)
    envs.reset(seed=0)
    oracle = Oracle(envs)
    played, opened = oracle.play(), envs.world.open_doors
    envs.reset(seed=0)
    stepped = np.zeros(9)
    for _ in range(300):
        stepped += envs.step(oracle.act())[1]
    np.testing.assert_array_equal(played, stepped)
    np.testing.assert_array_equal(envs.world.open_doors, opened)
    assert opened.any(axis=1).all()
