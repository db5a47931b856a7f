"""The grid backend: its tables equal the continuous backend's results, and moves go from cell to cell."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tests import sample_houses
from tests.sim.backends.agreement import require_equal_rays
from vitruvius.logic import generate
from vitruvius.sim import DEFAULT, HouseVectorEnv
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.oracle.oracle import Oracle

CELL = 0.45
ROOMS = "aaaaa.bbb\naAaaa.bbb\naa+aa.bBb\n......+bb\n......bbb\n......bbb"
HOUSES = [
    sample_houses.drawn(ROOMS, cell=CELL),
    sample_houses.drawn("aaaa\naaAa\naaaa\na+aa\n....\n....\n....", cell=CELL),
]


@pytest.fixture(scope="module")
def pair():
    """Return the same bank in both backends, with a body in each cell at each heading."""
    count = 1000
    return [
        HouseVectorEnv(HOUSES, num_envs=count, backend=backend, targets="mixed")
        for backend in ("grid", "continuous")
    ]


def test_rays_on_the_grid_equal_those_of_the_continuous_backend(pair):
    """At common poses, rays agree within 1e-5 m and hit the same things."""
    grid, continuous = pair
    for seed in range(4):
        ours, info = grid.reset(seed=seed)
        options = {name: info[name] for name in ("house", "pose", "target")}
        theirs, _ = continuous.reset(seed=0, options=options)
        assert np.abs(ours - theirs)[..., 0].max() * grid.config.range < 1e-5
        np.testing.assert_array_equal(ours[..., 1], theirs[..., 1])
        assert ours[..., 1].any()


def brute(text: str, place: tuple[int, int], way: tuple[int, int]) -> bool:
    """Return True if a body can go from a cell of a drawing to the next: all touched cells are open."""
    letters = np.array([list(row) for row in text.split("\n")])

    def at(x: int, y: int) -> str:
        inside = 0 <= y < letters.shape[0] and 0 <= x < letters.shape[1]
        return str(letters[y, x]) if inside else "#"

    def step(x: int, y: int, dx: int, dy: int) -> bool:
        here, there = at(x, y), at(x + dx, y + dy)
        if there == "#" or there.isupper():
            return False
        if "+" in (here, there) and "." in (here, there):
            return doors[min((x, y), (x + dx, y + dy))] == (abs(dx), abs(dy))
        return len({here, there} - {"+"}) <= 1

    doors = {}
    for y, x in np.argwhere(letters == "+").tolist():
        dx, dy = next((dx, dy) for dx, dy in ((0, 1), (0, -1), (1, 0), (-1, 0)) if at(x + dx, y + dy) == ".")
        doors[min((x, y), (x + dx, y + dy))] = (abs(dx), abs(dy))
    (x, y), (dx, dy) = place, way
    if dx == 0 or dy == 0:
        return step(x, y, dx, dy)
    return step(x, y, dx, 0) and step(x + dx, y, 0, dy) and step(x, y, 0, dy) and step(x, y + dy, dx, 0)


def test_moves_on_the_grid_follow_the_drawn_walls_and_pieces():
    """From every cell, a move is one cell or blocked; a diagonal move needs both cells beside it."""
    poses, expected = [], []
    for y, row in enumerate(ROOMS.split("\n")):
        for x, letter in enumerate(row):
            for heading in range(8) if not letter.isupper() else ():
                poses.append(((x + 0.5) * CELL, (y + 0.5) * CELL, heading * np.pi / 4))
                expected.append(brute(ROOMS, (x, y), HEADINGS[heading]))
    envs = HouseVectorEnv(HOUSES[:1], num_envs=len(poses), backend="grid")
    pose = np.array(poses)
    envs.reset(seed=0, options={"house": np.zeros(len(pose), int), "pose": pose})
    info = envs.step(np.full(len(pose), 2))[4]
    np.testing.assert_array_equal(info["blocked"], ~np.array(expected))
    way = np.round(np.column_stack([np.cos(pose[:, 2]), -np.sin(pose[:, 2])]))
    there = pose[:, :2] + np.where(info["blocked"], 0, CELL)[:, None] * way
    np.testing.assert_allclose(info["pose"][:, :2], there, atol=1e-5)
    assert 0.2 < info["blocked"].mean() < 0.8


def test_a_body_on_the_grid_fills_its_cell_at_all_headings():
    envs = HouseVectorEnv(HOUSES, backend="grid")
    assert envs.config.body == pytest.approx((CELL, CELL))
    assert envs.config.step == pytest.approx(CELL)
    envs.reset(seed=0)
    for action in (0, 1):
        assert not envs.step([action])[4]["blocked"]


def test_targets_and_starts_lie_in_the_middle_of_cells():
    envs = HouseVectorEnv(HOUSES, num_envs=200, backend="grid", targets="mixed")
    _, info = envs.reset(seed=0)
    for place in (info["pose"][:, :2], info["target"]):
        steps = place / CELL - 0.5
        np.testing.assert_allclose(steps, np.round(steps), atol=1e-4)


def test_the_oracle_finds_paths_on_the_grid():
    envs = HouseVectorEnv(HOUSES, num_envs=20, backend="grid", targets="mixed", max_episode_steps=200)
    envs.reset(seed=0)
    assert (Oracle(envs).play() > 3).all()


def test_kinds_of_hits_on_the_grid_equal_those_of_the_continuous_backend():
    config = replace(DEFAULT, sees_kind=True)
    both = []
    for backend in ("grid", "continuous"):
        envs = HouseVectorEnv(HOUSES, num_envs=500, backend=backend, preset=config, targets="mixed")
        options = {} if not both else {name: both[0][1][name] for name in ("house", "pose", "target")}
        both.append(envs.reset(seed=0, options=options))
    np.testing.assert_array_equal(both[0][0][..., 1:], both[1][0][..., 1:])
    assert both[0][0][..., 1:].any(axis=(0, 1)).all()


def test_a_pose_between_cells_is_refused():
    envs = HouseVectorEnv(HOUSES, backend="grid")
    with pytest.raises(
        ValueError, match=re.escape("is not at the centre of a cell: the nearest centre is (")
    ):
        envs.reset(seed=0, options={"house": [0], "pose": [[1.0, 1.6, 0.0]]})


def test_generated_houses_run_unchanged_on_both_backends():
    houses = list(generate(rooms=3, cell=0.3, seed=4, count=2))
    require_equal_rays(houses, 300, "mixed")
