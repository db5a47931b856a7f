"""Environment steps a second by number of environments, beside the same rays in plain NumPy.

``pytest benchmarks/test_simulator.py``: each row's ``extra_info`` has ``environments`` and
``steps_per_second``. Moves, collisions, 40 rays, pick-ups and resets are in ``kernel`` and ``gymnasium``;
``numpy`` has the rays alone.
"""

import numpy as np
import pytest
import torch

from logic import House
from sim import DEFAULT, HouseVectorEnv
from sim.geometry import geometry
from tests.worlds import random_house

SIZES = [1, 16, 256, 4096]
HOUSES = [random_house(seed) for seed in range(64)]
ANGLES = np.deg2rad(DEFAULT.first_ray - DEFAULT.ray_spacing * np.arange(DEFAULT.rays))


def actions(count: int) -> np.ndarray:
    return np.random.default_rng(0).choice(3, p=[0.15, 0.15, 0.7], size=(32, count))


def record(benchmark, environments: int, steps: int) -> None:
    """Note how many environment steps a second the median round made."""
    benchmark.extra_info["environments"] = environments
    benchmark.extra_info["steps_per_second"] = steps / benchmark.stats.stats.median


@pytest.fixture(scope="module", params=SIZES)
def envs(request):
    envs = HouseVectorEnv(HOUSES, num_envs=request.param, targets="mixed")
    envs.reset(seed=0)
    envs.step_torch(torch.zeros(request.param, dtype=torch.int64))
    return envs


@pytest.mark.benchmark(group="simulator")
def test_kernel(benchmark, envs):
    """Through ``step_torch``: no copies."""
    plan = torch.from_numpy(actions(envs.num_envs))

    def run():
        for action in plan:
            envs.step_torch(action)

    benchmark.pedantic(run, rounds=7, warmup_rounds=1)
    record(benchmark, envs.num_envs, plan.numel())


@pytest.mark.benchmark(group="simulator")
def test_gymnasium(benchmark, envs):
    """Through ``VectorEnv.step``: fresh arrays and info at each step."""
    plan = actions(envs.num_envs)

    def run():
        for action in plan:
            envs.step(action)

    benchmark.pedantic(run, rounds=7, warmup_rounds=1)
    record(benchmark, envs.num_envs, plan.size)


@pytest.mark.benchmark(group="simulator")
@pytest.mark.parametrize("count", SIZES)
def test_numpy(benchmark, count):
    """The rays alone, vectorised over environments and rays, a loop over the lines of one house."""
    lines, rng = boxes(HOUSES[0]), np.random.default_rng(0)
    west, north, east, south = HOUSES[0].floor.box
    eye = rng.uniform((west, north), (east, south), (count, 2))
    heading = rng.integers(8, size=count) * np.pi / 4
    benchmark.pedantic(lambda: cast(lines, eye, heading), rounds=5, warmup_rounds=1)
    record(benchmark, count, count)


def boxes(house: House) -> np.ndarray:
    """A house's walls and pieces by their edges, (B, 4)."""
    solids = geometry(house).solids
    return np.hstack([solids[:, :2] - solids[:, 2:], solids[:, :2] + solids[:, 2:]])


def cast(lines: np.ndarray, eye: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Distances (E, R) from eyes (E, 2) to the nearest of axis-aligned boxes, by the slab method."""
    angle = heading[:, None] + ANGLES
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
        nearest = np.full(angle.shape, DEFAULT.range)
        for box in lines:
            low, high = ((edge - eye)[:, None] * inverse for edge in (box[:2], box[2:]))
            enter, leave = np.minimum(low, high).max(axis=-1), np.maximum(low, high).min(axis=-1)
            nearest = np.where((enter <= leave) & (enter >= 0), np.minimum(nearest, enter), nearest)
    return nearest
