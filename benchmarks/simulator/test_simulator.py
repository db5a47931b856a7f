"""Cost of a step by environments, houses, segments, rays and processors, compared with the same step in C.

``vitruvius bench simulator`` runs this script. Every row steps a bank of generated, furnished houses with
targets in all rooms: dynamics, collision, 40 rays, pick-up and autoreset. A round is some steps with random
actions, 70 % forward; ``extra_info`` has the rate of the median round.
"""

import hashlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch

from benchmarks.simulator.c_loop import Loop, compiler, version
from benchmarks.simulator.cores import confined, processors
from benchmarks.simulator.peers.ours import ROBOT, peers_house
from vitruvius.logic import House, generate, save
from vitruvius.sim import DEFAULT, Config, HouseVectorEnv, Oracle
from vitruvius.sim.backends.continuous.layout import lines_listed as listed_at
from vitruvius.sim.runtime import start
from vitruvius.sim.tracing import COMPILERS, VARIABLE

ENVIRONMENTS = [1, 16, 256, 4096, 65536]
MANY = 4096
"""Number of environments if another quantity varies."""
HOUSES = [1, 64, 512, 4096]
ROOMS = [1, 2, 4, 8, 16]
SPACING = [15, 9, 5, 3, 1]
"""Angles in degrees between the rays of a field of view of about 120 degrees."""
CORES = [count for count in (1, 2, 4, 8, 16, 32, 64) if count <= processors()]
DRIVEN = ("kernel", "step torch", "kernel on one core", "C on one core")
ROUNDS, STEPS = 15, 32
CELL = 0.3
"""Side in metres of the cells of houses that fit both backends."""
TERMS = {"step": -0.01, "bump": -0.1}
PROGRESS = {"progress": 0.01}
ASKED: dict[str, tuple[dict[str, Any], int]] = {
    "rays, bump, last action, odometry, goal": (
        {"preset": replace(DEFAULT, observe=("rays", "bump", "last_action", "odometry", "goal"))}, 0,
    ),
    "a step and a bump cost something": ({"targets": {"task": "all", "terms": TERMS}}, 0),
    "rooms that were visited are kept": ({"targets": {"task": "mixed", "terms": "visit"}}, 0),
    "a battery, charged in a room": ({"targets": {"task": "mixed", "terms": "battery"}}, 0),
    "distance in infos, in one house, all known": ({"preset": replace(DEFAULT, geodesic=True)}, 16000),
    "progress rewarded, in one house, all known": ({"targets": {"task": "all", "terms": PROGRESS}}, 16000),
    "distance in infos, in 64 houses, none known": ({"preset": replace(DEFAULT, geodesic=True)}, 0),
}  # fmt: skip
"""Options of environments beyond the default, and the number of steps until all distances are known."""

BY_ENVIRONMENTS = "64 houses of 4 rooms"
BY_OTHERS = "4,096 environments"

study = pytest.mark.benchmark(group="simulator")


@cache
def bank(count: int = 64, rooms: int = 4, cell: float = 0.0) -> list[House]:
    """Return houses 0, 1, ... of a request."""
    return list(generate(rooms=rooms, seed=0, count=count, cell=cell, workers=processors()))


@pytest.fixture(scope="module", autouse=True)
def _started() -> None:
    """Start workers for all processors; rows with fewer are restricted to those."""
    start()


def ready(count: int, houses: list[House], **kinds: Any) -> HouseVectorEnv:
    """Return environments in the midst of their episodes."""
    kinds = {"targets": "mixed"} | kinds
    envs = HouseVectorEnv(houses, num_envs=count, **kinds)
    envs.reset(seed=0)
    for action in driven(count) if envs.config.drives else plan(count):
        envs.step_torch(action)
    return envs


@cache
def plan(count: int) -> torch.Tensor:
    """Return actions (STEPS, count), with fewer steps if each step is long."""
    steps = STEPS if count <= MANY else 4
    rows = np.random.default_rng(0).choice(3, p=[0.15, 0.15, 0.7], size=(steps, count))
    return torch.from_numpy(rows)


@cache
def driven(count: int) -> torch.Tensor:
    """Return commands (STEPS, count, 2): random v and w, with v in the upper half of its range."""
    rng, drive = np.random.default_rng(0), DEFAULT.drive
    v = rng.uniform(0.5, 1, (STEPS, count)) * drive.speed
    w = rng.uniform(-1, 1, (STEPS, count)) * drive.turn_speed
    return torch.from_numpy(np.stack([v, w], axis=-1).astype(np.float32))


def timed(
    benchmark: Any,
    step: Callable[[torch.Tensor], Any],
    count: int,
    actions: torch.Tensor | None = None,
    *,
    panel: str = "",
    **extra: Any,
) -> None:
    """Time rounds of steps, and record the rate of the median round."""
    actions = plan(count) if actions is None else actions
    made = actions.shape[0] * actions.shape[1]

    def play() -> None:
        for action in actions:
            step(action)

    benchmark.pedantic(play, rounds=ROUNDS, warmup_rounds=2)
    rate = made / benchmark.stats.stats.median
    benchmark.extra_info.update(steps_per_second=rate, panel=panel, **extra)


def kernel(envs: HouseVectorEnv) -> Callable[[torch.Tensor], None]:
    """Return a function that launches only the kernel of a step."""
    return lambda actions: envs.launch(actions.numpy())


@study
@pytest.mark.parametrize("count", ENVIRONMENTS)
def test_kernel(benchmark, count):
    envs = ready(count, bank())
    extra: dict[str, Any] = {"lines": lines_listed(envs)} if count == MANY else {}
    timed(benchmark, kernel(envs), count, environments=count, panel=BY_ENVIRONMENTS, **extra)


@study
@pytest.mark.parametrize("count", ENVIRONMENTS)
def test_step_torch(benchmark, count):
    timed(benchmark, ready(count, bank()).step_torch, count, environments=count, panel=BY_ENVIRONMENTS)


@study
@pytest.mark.parametrize("count", ENVIRONMENTS)
def test_gymnasium_step(benchmark, count):
    """Step with the copies and the info of Gymnasium's interface."""
    envs = ready(count, bank())
    timed(benchmark, lambda a: envs.step(a.numpy()), count, environments=count, panel=BY_ENVIRONMENTS)


@study
@pytest.mark.parametrize("count", ENVIRONMENTS)
def test_kernel_on_one_core(benchmark, count):
    envs = ready(count, bank())
    with confined(1):
        timed(benchmark, kernel(envs), count, environments=count, panel=BY_ENVIRONMENTS)


@study
@pytest.mark.parametrize("count", ENVIRONMENTS)
def test_C_on_one_core(benchmark, count, c_compiler, tmp_path):
    """Run the same algorithm in C on the same arrays, with the same results."""
    envs = ready(count, bank())
    loop = Loop(envs, tmp_path, c_compiler)
    for action in plan(count):
        loop.step(action.numpy())
        observation, reward, _, truncated, info = envs.step(action.numpy())
        assert np.array_equal(observation, loop.observation)
        assert np.array_equal(reward, loop.reward)
        assert np.array_equal([truncated, info["blocked"]], loop.flags[1:])
    with confined(1):
        timed(
            benchmark, lambda a: loop.step(a.numpy()), count, environments=count, panel=BY_ENVIRONMENTS,
            compiler=version(c_compiler),
        )  # fmt: skip


@study
@pytest.mark.parametrize("how", DRIVEN)
def test_a_body_that_drives(benchmark, how, c_compiler, tmp_path):
    """Step the free backend, and the same algorithm in C with the same results."""
    envs, rows = ready(MANY, bank(), backend="free"), driven(MANY)
    if how.startswith("C"):
        loop = Loop(envs, tmp_path, c_compiler)
        for action in rows:
            loop.step(action.numpy())
            observation, reward, _, truncated, info = envs.step(action.numpy())
            assert np.array_equal(observation, loop.observation)
            assert np.array_equal(reward, loop.reward)
            assert np.array_equal([truncated, info["blocked"]], loop.flags[1:])
        step = lambda a: loop.step(a.numpy())  # noqa: E731
    else:
        step = envs.step_torch if how == "step torch" else kernel(envs)
    with confined(1 if "one core" in how else processors()):
        timed(benchmark, step, MANY, rows, driven=how)


@study
@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_houses_of_cells(benchmark, backend):
    """Step both backends in the same houses, whose edges are multiples of a cell."""
    envs = ready(MANY, bank(cell=CELL), backend=backend)
    timed(benchmark, kernel(envs), MANY, backend=backend)


@study
@pytest.mark.parametrize("backend", ["continuous", "free"])
def test_the_house_of_the_peers(benchmark, backend):
    envs = ready(MANY, [peers_house()], preset=ROBOT, backend=backend)
    actions = driven(MANY) if envs.config.drives else plan(MANY)
    timed(benchmark, envs.step_torch, MANY, actions, beside_peers=backend)


@study
@pytest.mark.parametrize("loop", ["by environment", "by ray"])
def test_loops(benchmark, loop):
    """Step with a task for each environment, or for each ray as on a GPU; both on the CPU here."""
    envs = ready(MANY, bank(), by_ray=loop == "by ray")
    timed(benchmark, kernel(envs), MANY, loop=loop)


@study
@pytest.mark.parametrize("count", HOUSES)
def test_different_houses(benchmark, count):
    envs = ready(MANY, bank(count))
    size = sum(table.nbytes for table in envs.tables().values())
    timed(benchmark, kernel(envs), MANY, houses=count, bytes=size, panel=BY_OTHERS)


@study
@pytest.mark.parametrize("rooms", ROOMS)
def test_larger_houses(benchmark, rooms):
    envs = ready(MANY, bank(16, rooms))
    shapes = envs.geometries
    segments = np.mean(
        [len(shape.verticals) + len(shape.horizontals) + 4 * len(shape.pieces) for shape in shapes]
    )
    timed(benchmark, kernel(envs), MANY, segments=float(segments), of_rooms=rooms, panel=BY_OTHERS)


@study
@pytest.mark.parametrize("spacing", SPACING)
def test_more_rays(benchmark, spacing):
    rays = round(120 / spacing)
    config = Config(rays=rays, ray_spacing=spacing, first_ray=spacing * (rays - 1) / 2)
    timed(benchmark, kernel(ready(MANY, bank(), preset=config)), MANY, rays=rays, panel=BY_OTHERS)


@study
@pytest.mark.parametrize("cores", CORES)
def test_more_processors(benchmark, cores):
    envs = ready(MANY, bank())
    with confined(cores):
        timed(benchmark, kernel(envs), MANY, processors=cores, panel=BY_OTHERS)


@study
@pytest.mark.parametrize(
    "what",
    [
        "one environment's kernel",
        "observations copied",
        "info",
        "reset of all",
        "rays in NumPy",
        "one oracle's episode",
    ],
)
def test_parts(benchmark, what):
    """Time parts of a step of 4096 environments, and rarer calls."""
    envs = ready(1 if what.startswith("one") else MANY, bank())
    eye, heading, still = np.full((MANY, 2), 2.0), np.zeros(MANY), np.zeros(1, int)
    work = {
        "one environment's kernel": lambda: envs.launch(still),
        "observations copied": envs.state["observation"].copy,
        "info": envs.info,
        "reset of all": envs.reset,
        "rays in NumPy": lambda: cast(envs, eye, heading),
        "one oracle's episode": lambda: Oracle(envs).play(),
    }[what]
    slow = what in {"rays in NumPy", "one oracle's episode"}
    benchmark.pedantic(work, rounds=ROUNDS, iterations=1 if slow else 50, warmup_rounds=1)
    benchmark.extra_info.update(part=what)


def processor_seconds(step: Callable[[Any], Any], actions: Any) -> float:
    """Return the processor seconds of this process, in all threads, for these steps."""
    begin = time.process_time()
    for action in actions:
        step(action)
    return time.process_time() - begin


def beside(benchmark: Any, ours: Callable[[Any], Any], other: Callable[[Any], Any], actions: Any) -> None:
    """Time rounds of both in turn, and record the quartiles of the ratio of their processor times."""
    ratios = list[float]()

    def both() -> None:
        before = processor_seconds(other, actions)
        ratios.append(processor_seconds(ours, actions) / before)

    benchmark.pedantic(both, rounds=ROUNDS, warmup_rounds=1)
    benchmark.extra_info.update(ratios=np.percentile(ratios[1:], [25, 50, 75]).tolist())


@study
@pytest.mark.parametrize("what", ASKED)
def test_what_is_asked_for(benchmark, what):
    kinds, known = ASKED[what]
    houses = bank(1 if known else 64)
    envs, plain = ready(MANY, houses, **kinds), ready(MANY, houses)
    actions = plan(MANY).numpy()
    for each in range(known):
        envs.launch(actions[each % len(actions)])
    beside(benchmark, envs.launch, plain.launch, actions)
    benchmark.extra_info.update(asked=what)


@study
def test_one_environment_beside_CartPole(benchmark):
    ours, theirs = (
        gymnasium.make("Vitruvius/House-v0", preset="long"),
        gymnasium.make("CartPole-v1"),
    )

    def again(env: Any) -> Callable[[Any], None]:
        def step(action: Any) -> None:
            *_, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                env.reset()

        env.reset(seed=0)
        return step

    actions = np.random.default_rng(0).integers(2, size=2000)
    beside(benchmark, again(ours), again(theirs), actions)
    benchmark.extra_info.update(asked="gym.make of one environment, to CartPole-v1's")


@study
def test_the_adapter_of_Stable_Baselines3(benchmark):
    pytest.importorskip("stable_baselines3")
    from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

    mode = gymnasium.vector.AutoresetMode.SAME_STEP
    raw, other = (HouseVectorEnv(bank(), num_envs=256, autoreset_mode=mode, seed=0) for _ in range(2))
    adapted = StableBaselinesVecEnv(other)
    raw.reset()
    adapted.reset()
    actions = np.random.default_rng(0).integers(3, size=(300, 256))
    beside(benchmark, adapted.step, raw.step, actions)
    benchmark.extra_info.update(asked="256 environments by the adapter of Stable-Baselines3, to `step`")


@study
@pytest.mark.parametrize("backend", ["continuous", "grid"])
def test_packing(benchmark, backend):
    houses = bank(cell=CELL)
    envs = HouseVectorEnv(houses, targets="mixed", backend=backend)
    benchmark.pedantic(lambda: envs.set_houses(houses), rounds=5, warmup_rounds=1)
    benchmark.extra_info.update(packing=backend, packed=len(houses))


@study
@pytest.mark.parametrize("kernels", ["compiled", "from the cache"])
def test_first_step(benchmark, kernels, tmp_path):
    """Time the parts in new processes, and record the medians."""
    file, parts = tmp_path / "house.jsonl", []
    save(bank()[:1], file)
    command = [sys.executable, "-m", "benchmarks.simulator.first_step", str(file)]
    environment = os.environ | {"TI_OFFLINE_CACHE": "0" if kernels == "compiled" else "1"}
    root = Path(__file__).parents[2]

    def run() -> None:
        done = subprocess.run(command, env=environment, cwd=root, capture_output=True, text=True, check=True)
        parts.append(json.loads(done.stdout))

    benchmark.pedantic(run, rounds=5, warmup_rounds=1)
    medians = {part: float(np.median([each[part] for each in parts[1:]])) for part in parts[0]}
    benchmark.extra_info.update(first=kernels, parts=medians)


@study
@pytest.mark.parametrize("name", COMPILERS)
def test_compilers(benchmark, name, tmp_path):
    """Time steps of some environments in new processes, and the first step of one house without a cache."""
    save(bank()[:1], tmp_path / "house.jsonl")
    environment = os.environ | {VARIABLE: name, "PYTHONPATH": str(Path(__file__).parents[2])}
    uncached = environment | {"TI_OFFLINE_CACHE": "0", "QD_OFFLINE_CACHE": "0"}
    rates, firsts = list[float](), list[float]()

    def printed(environment: dict[str, str], module: str, *given: object) -> Any:
        command = [sys.executable, "-m", f"benchmarks.{module}", *map(str, given)]
        return json.loads(subprocess.check_output(command, env=environment, cwd=tmp_path) or "null")

    case = json.dumps({"part": "kernel", "of": "continuous", "device": "cpu", "environments": MANY})

    def run() -> None:
        found = printed(environment, "speed.worker", case, 2.0)
        rates.append(found["steps"] / found["seconds"])
        printed(environment, "speed.trails", "cpu", "trails.npz")
        firsts.append(printed(uncached, "simulator.first_step", "house.jsonl")["first step"])

    benchmark.pedantic(run, rounds=3)
    with np.load(tmp_path / "trails.npz") as trails:
        outcome = hashlib.sha256(b"".join(trails[part].tobytes() for part in sorted(trails))).hexdigest()
    compiling = float(np.median(firsts))
    benchmark.extra_info.update(runtime=name, rates=rates, compiling=compiling, outcome=outcome)


@pytest.fixture(scope="module")
def c_compiler() -> list[str]:
    found = compiler()
    if found is None:
        pytest.skip("no clang here, and no uv to fetch one")
    return found


def lines_listed(envs: HouseVectorEnv) -> float:
    """Return the mean number of lines that a look tests: those listed for the eye's cell and its heading."""
    info = envs.info()
    return float(listed_at(envs.tables(), info["house"], info["pose"]).mean())


def cast(envs: HouseVectorEnv, eye: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Return distances (E, R) from eyes (E, 2) in house 0, by a straightforward implementation.

    It is the slab method with vectors over all rays and a loop over boxes.
    """
    solids = envs.geometries[0].solids
    boxes = np.hstack([solids[:, :2] - solids[:, 2:], solids[:, :2] + solids[:, 2:]])
    angle = heading[:, None] + DEFAULT.ray_angles
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / np.stack([np.cos(angle), -np.sin(angle)], axis=-1)
        nearest = np.full(angle.shape, DEFAULT.range)
        for box in boxes:
            low, high = ((edge - eye)[:, None] * inverse for edge in (box[:2], box[2:]))
            enter, leave = np.minimum(low, high).max(axis=-1), np.maximum(low, high).min(axis=-1)
            nearest = np.where((enter <= leave) & (enter >= 0), np.minimum(nearest, enter), nearest)
    return nearest
