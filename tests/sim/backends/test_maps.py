"""Maps in both backends: rays and moves follow the cells, and targets lie on reachable floor."""

from typing import Any

import numpy as np
import pytest

from tests.maps import random_map
from tests.sim.backends.agreement import require_equal_rays
from vitruvius.logic import House
from vitruvius.logic.house.occupancy import FREE
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.actions import HEADINGS

CELL = 0.3
HOUSES = [random_map(seed, CELL) for seed in range(3)]


def free(house: House) -> np.ndarray:
    assert house.occupancy
    return house.occupancy.values == FREE


def cells_of(house: House, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rows and columns of places (n, 2)."""
    west, north, _, _ = house.rooms[0].box
    column, row = np.floor((places - (west, north)) / CELL).astype(int).T
    return row, column


@pytest.fixture(scope="module", params=["grid", "continuous"])
def envs(request) -> HouseVectorEnv:
    return HouseVectorEnv(HOUSES, num_envs=300, backend=request.param, targets="all")


def test_rays_end_in_the_first_cell_that_is_not_free(envs) -> None:
    """March a millimetre at a time: the end of a ray is free just before it, and not just beyond it."""
    seen, info = envs.reset(seed=1, options={"target": np.full((300, 2), 90.0)})
    angle = info["pose"][:, 2:] + envs.config.ray_angles
    way = np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
    far = seen[..., 0].astype(float) * envs.config.range
    for k, house in enumerate(HOUSES):
        here = info["house"] == k
        eye, distance = info["pose"][here, None, :2].astype(float), far[here]
        steps = np.arange(0.0, envs.config.range, 0.01)
        path = eye[:, :, None] + way[here][:, :, None] * np.minimum(
            steps[:, None], distance[..., None, None] - 2e-3
        )
        assert free(house)[cells_of(house, path.reshape(-1, 2))].all()
        ends = distance < envs.config.range - 1e-3
        beyond = (eye + way[here] * (distance[..., None] + 2e-3))[ends]
        shut = ~free(house)[cells_of(house, beyond)]
        assert shut.mean() > 0.995  # a ray may end at a corner, with free space beyond it
        assert ends.sum() > 1000


def test_rays_of_both_backends_are_equal_on_maps() -> None:
    require_equal_rays(HOUSES, 1000, "all")


def test_bodies_stay_on_free_cells_wherever_they_walk(envs) -> None:
    rng = np.random.default_rng(0)
    _, info = envs.reset(seed=2)
    half = envs.config.body[0] / 2 - 1e-4
    for _ in range(300):
        actions = np.where(rng.random(300) < 0.8, 2, rng.integers(0, 2, 300))
        _, _, _, _, info = envs.step(actions)
        for k, house in enumerate(HOUSES):
            eye = info["pose"][info["house"] == k, :2]
            for corner in ((-half, -half), (half, -half), (-half, half), (half, half)):
                assert free(house)[cells_of(house, eye + corner)].all()


def flooded(open_: np.ndarray, start: tuple[int, int]) -> np.ndarray:
    """Return the cells (H, W) that a body one cell wide reaches, by a search in plain Python."""
    reached, todo = np.zeros(open_.shape, bool), [start]
    reached[start] = True
    while todo:
        row, column = todo.pop()
        for east, south in HEADINGS:
            beside = (row + south, column), (row, column + east), (row + south, column + east)
            if all(open_[each] for each in beside) and not reached[beside[2]]:
                reached[beside[2]] = True
                todo.append(beside[2])
    return reached


def test_starts_and_targets_on_a_grid_are_all_of_the_largest_floor_and_nothing_else() -> None:
    envs = HouseVectorEnv(HOUSES, num_envs=1, backend="grid", targets="main")
    for house, places in zip(HOUSES, envs.world.places, strict=True):
        open_, parts = free(house), []
        left = open_.copy()
        while left.any():
            row, column = np.argwhere(left)[0]
            parts.append(flooded(open_, (int(row), int(column))))
            left &= ~parts[-1]
        largest = max(parts, key=np.sum)
        starts = np.zeros(open_.shape, bool)
        starts[places.starts[:, 1], places.starts[:, 0]] = True
        np.testing.assert_array_equal(starts, largest)
        i, j = places.targets.astype(int).T
        assert largest[j, i].all()
        assert len(i) > 20


WRONG: dict[str, tuple[list[House], dict[str, Any], str]] = {
    "narrow cells": ([random_map(0, 0.1)], {"backend": "grid"}, r"0.1 m are narrower .*coarser\(3\)"),
    "other cells": ([HOUSES[0], random_map(0, 0.6)], {"backend": "grid"}, "different cells"),
    "too far": ([House.from_grid([[0] * 9] * 9, 120.0)], {}, "more than 512 m .*: House.from_grid"),
    "not in the middle": ([House.from_grid([[0] * 9] * 9, 10.0, (450.0, 0.0))], {}, "more than 512 m"),
    "no room for a body": ([House.from_grid([[0]], 0.2)], {}, "finds no place to stand"),
    "no room for a target": ([House.from_grid([[0]], 0.4)], {}, "no target fits"),
    "secondary": (HOUSES, {"targets": "secondary"}, "it has no room that can hold"),
    "the original's rule": (HOUSES, {"preset": "paper"}, "not support the topology 'map'"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_a_map_cannot_be_simulated_with_is_said_in_a_line(case: str) -> None:
    houses, options, said = WRONG[case]
    with pytest.raises(ValueError, match=said) as error:
        HouseVectorEnv(houses, num_envs=1, **options)
    assert "\n" not in str(error.value)


def test_a_map_is_simulated_by_its_file_and_pictured(tmp_path) -> None:
    from vitruvius.logic.exports import export

    (path,) = export([HOUSES[0]], tmp_path, "ros")
    envs = HouseVectorEnv(path, num_envs=2, targets="all", render_mode="rgb_array")
    envs.reset(seed=0)
    pictures = envs.render()
    assert pictures is not None
    assert np.ptp(np.asarray(pictures[0])) > 0


@pytest.mark.parametrize("backend", ["grid", "continuous"])
def test_no_body_starts_in_unknown_cells_however_many_there_are(backend: str) -> None:
    cells = np.full((40, 40), -1)
    cells[2:8, 2:8] = FREE
    envs = HouseVectorEnv([House.from_grid(cells, CELL, (0.0, 0.0))], num_envs=200, backend=backend)
    _, info = envs.reset(seed=0)
    assert (info["pose"][:, :2] > 2 * CELL).all()
    assert (info["pose"][:, :2] < 8 * CELL).all()
