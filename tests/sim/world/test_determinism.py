"""An environment is a function of its seed: not of the batch, the threads, the loop or other environments.

``./run python -m tests.sim.world.test_determinism`` writes the goldens again.
"""

import hashlib
import json
import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

from tests import sample_houses
from tests.programs import finished
from vitruvius.logic import House
from vitruvius.sim import DEFAULT, PAPER, Config, HouseVectorEnv
from vitruvius.sim.tracing import impl

DRAWN = sample_houses.drawn("aa+aa.bbb\n......+bb\n......bbb", cell=1.2)
HOUSES = [DRAWN, *sample_houses.RANDOM[:3]]
OTHERS = sample_houses.RANDOM[3:]
SHORT = replace(DEFAULT, ends_on_collision=True, steps=20)
"""Configuration with frequent ends of episodes, at different times."""

PRESETS = {"default": DEFAULT, "paper": PAPER}
GOLDEN_HOUSES = {
    "default": HOUSES,
    "paper": [DRAWN, HOUSES[1], sample_houses.example(), sample_houses.example(name="2019-2-15")],
}
"""The original's rule opens no door of a room that overlaps the main room by less than the body."""
LAUNCHES = 0.02
"""Time limit in seconds: more than Taichi counts for launches of compiled kernels, less than for any
compilation."""

BATCH, STEPS = 4096, 50
GOLDEN = Path(__file__).parents[2] / "golden"
ROOT = Path(__file__).parents[3]


def make(houses: list[House] = HOUSES, count: int = BATCH, preset: str | Config = SHORT, **more: Any):
    return HouseVectorEnv(houses, num_envs=count, preset=preset, targets="mixed", **more)


def actions(count: int, steps: int = STEPS) -> np.ndarray:
    return np.random.default_rng(3).choice(3, p=[0.15, 0.15, 0.7], size=(steps, count))


def outputs(
    envs: HouseVectorEnv, plan: np.ndarray, seed: int | None, others: Any = None
) -> Iterator[list[np.ndarray]]:
    """Yield all outputs of each step of a plan (T, E), from a reset on.

    Without a seed, begin with the current state. In the mode ``DISABLED``, ended environments are reset
    before the next step, and so are ``others`` (T, E) bool, ended or not.
    """
    disabled = envs.autoreset_mode is AutoresetMode.DISABLED
    over = np.zeros(envs.num_envs, bool)
    if seed is not None:
        seen, info = envs.reset(seed=seed)
        yield [seen, info["pose"], info["target"], info["house"]]
    for t, chosen in enumerate(plan):
        if others is not None:
            over = over | others[t]
        if disabled and over.any():
            envs.reset(options={"reset_mask": over})
        seen, reward, terminated, truncated, info = envs.step(chosen)
        over = terminated | truncated
        final = info.get("final_obs", np.zeros_like(seen))
        yield [
            seen,
            info["pose"],
            info["target"],
            info["house"],
            reward,
            terminated,
            truncated,
            info["blocked"],
            final,
        ]


def same(one: Any, other: Any) -> bool:
    """Return True if two lists of arrays have the same bits."""
    return [array.tobytes() for array in one] == [array.tobytes() for array in other]


def digest(steps: Iterator[list[np.ndarray]]) -> str:
    """Return a hash of all outputs."""
    total = hashlib.sha256()
    for parts in steps:
        for array in parts:
            total.update(np.ascontiguousarray(array).tobytes())
    return total.hexdigest()


@pytest.mark.second_part("thousands of environments")
@pytest.mark.parametrize(("mode", "by_ray"), zip(AutoresetMode, (False, True, False), strict=True))
def test_an_environment_gives_the_same_outputs_alone_and_among_4096(mode, by_ray):
    """The outputs are equal bit for bit, through several episodes; both loops are compared below."""
    envs, plan, ends = make(autoreset_mode=mode, by_ray=by_ray), actions(BATCH), 0
    chosen = [0, 1, 77, BATCH - 1]
    singles = [
        outputs(make(count=1, autoreset_mode=mode, by_ray=by_ray), plan[:, i : i + 1], seed=11 + i)
        for i in chosen
    ]
    for together, *alone in zip(outputs(envs, plan, seed=11), *singles, strict=True):
        for i, one in zip(chosen, alone, strict=True):
            assert same([array[i : i + 1] for array in together], one)
        ends += sum(array[chosen].sum() for array in together[5:7])
    assert ends >= 8


@pytest.mark.second_part("many kernels")
@pytest.mark.parametrize("mode", AutoresetMode)
def test_the_loop_by_environment_and_the_loop_by_ray_give_the_same_outputs(mode):
    """Compare one task for each environment with one for each environment and ray."""
    plan = actions(BATCH)
    runs = [outputs(make(autoreset_mode=mode, by_ray=by_ray), plan, seed=5) for by_ray in (False, True)]
    for one, other in zip(*runs, strict=True):
        assert same(one, other)


def test_resets_of_other_environments_change_nothing():
    """Other environments are reset at any times: an environment continues as it does alone."""
    count, kept = 64, [3, 40]
    plan = actions(count)
    others = np.random.default_rng(1).random(plan.shape) < 0.2
    others[:, kept] = False
    mode = AutoresetMode.DISABLED
    quiet = outputs(make(count=count, autoreset_mode=mode), plan, seed=2)
    busy = outputs(make(count=count, autoreset_mode=mode), plan, seed=2, others=others)
    apart = 0
    for one, other in zip(quiet, busy, strict=True):
        assert same([array[kept] for array in one], [array[kept] for array in other])
        apart += (one[1] != other[1]).any()
    assert apart > STEPS / 2


THREADS = """
import sys
from vitruvius.sim.runtime import start
start(threads=int(sys.argv[1]))
from tests.sim.world.test_determinism import threaded
print("\\n".join(threaded()))
"""


def threaded() -> list[str]:
    """Return hashes that must not depend on the number of threads, in both shapes of the loop."""
    plan = actions(700)
    kinds = [(AutoresetMode.SAME_STEP, False), (AutoresetMode.NEXT_STEP, True)]
    return [
        digest(outputs(make(count=700, autoreset_mode=mode, by_ray=by_ray), plan, 1))
        for mode, by_ray in kinds
    ]


@pytest.mark.second_part("processes with other numbers of threads")
def test_the_number_of_threads_changes_no_output():
    """Compare this process, which has a thread for each processor, with one of another number."""
    other = "2" if os.cpu_count() == 1 else "1"
    assert finished([sys.executable, "-c", THREADS, other], cwd=ROOT).stdout.split() == threaded()


def golden(preset: str) -> dict[str, Any]:
    """Return the results of a seed: numbers that a reader can compare, and hashes of every bit."""
    envs, names = (
        make(GOLDEN_HOUSES[preset], 32, PRESETS[preset], max_episode_steps=150),
        ("seen", "poses", "targets", "houses", "rewards"),
    )
    bits, last = {name: hashlib.sha256() for name in names}, []
    totals = np.zeros(4)
    for parts in outputs(envs, actions(32, 400), seed=2026):
        for name, array in zip(names, parts, strict=False):
            bits[name].update(array.tobytes())
        totals += [array.sum() for array in parts[4:8]] or 0
        last = parts
    return {
        "pick-ups, terminated, truncated, blocked": totals.tolist(),
        "last poses": np.round(last[1][:4].astype(float), 5).tolist(),
        "last targets": np.round(last[2][:4].astype(float), 5).tolist(),
        "bits": {name: total.hexdigest() for name, total in bits.items()},
    }


@pytest.mark.parametrize("preset", PRESETS)
def test_a_seed_gives_the_golden_trajectories(preset):
    """Compare the readable numbers first, then every bit."""
    known, found = json.loads((GOLDEN / f"sim-{preset}.json").read_text()), golden(preset)
    for name, values in known.items():
        if name != "bits":
            np.testing.assert_allclose(found[name], values, atol=2e-5, err_msg=name)
    assert found["bits"] == known["bits"]


@pytest.mark.parametrize("mode", AutoresetMode)
def test_a_state_saved_and_restored_goes_on_bit_for_bit(mode, tmp_path):
    count, half = 50, STEPS // 2
    plan, envs = actions(count), make(count=count, autoreset_mode=mode)
    for _ in outputs(envs, plan[:half], seed=8):
        pass
    saved: dict[str, Any] = {**envs.state}
    np.savez(tmp_path / "state.npz", **saved)
    on = list(rest(envs, plan[half:]))
    other = make(count=count, autoreset_mode=mode)
    other.reset(seed=99)
    with np.load(tmp_path / "state.npz") as state:
        other.state = dict(state)
        envs.state = dict(state)
    for again in (envs, other):
        for one, two in zip(on, rest(again, plan[half:]), strict=True):
            assert same(one, two)


def rest(envs: HouseVectorEnv, plan: np.ndarray) -> Iterator[list[np.ndarray]]:
    """Yield the outputs of the rest of a plan. In the mode ``DISABLED``, first reset ended environments."""
    flags = envs.state["flags"].astype(bool)
    over = flags[0] | flags[1]
    if envs.autoreset_mode is AutoresetMode.DISABLED and over.any():
        envs.reset(options={"reset_mask": over})
    yield from outputs(envs, plan, seed=None)


@pytest.mark.parametrize("by_ray", [False, True])
def test_set_houses_compiles_nothing_and_equals_a_new_environment(by_ray):
    envs, plan = make(count=40, by_ray=by_ray), actions(40)
    before = list(outputs(envs, plan, seed=4))
    compiled = compilations()
    envs.set_houses(OTHERS)
    swapped = list(outputs(envs, plan, seed=4))
    assert compilations() < compiled + LAUNCHES
    for one, other in zip(swapped, outputs(make(OTHERS, 40, by_ray=by_ray), plan, seed=4), strict=True):
        assert same(one, other)
    envs.set_houses(HOUSES)
    for one, other in zip(before, outputs(envs, plan, seed=4), strict=True):
        assert same(one, other)


def compilations() -> float:
    """Return the seconds that Taichi has spent on compiling."""
    program: Any = impl.get_runtime().prog
    return program.get_total_compilation_time()


def test_the_count_of_compilations_notices_one():
    make(count=1)
    before = compilations()
    # A kernel that no earlier run has left in Taichi's cache.
    make(count=1, preset=replace(SHORT, noise=np.random.default_rng().uniform(0.1, 0.2))).reset()
    assert compilations() > before + 5 * LAUNCHES


if __name__ == "__main__":
    for name in PRESETS:
        rows = ",\n".join(f" {json.dumps(key)}: {json.dumps(value)}" for key, value in golden(name).items())
        (GOLDEN / f"sim-{name}.json").write_text(f"{{\n{rows}\n}}\n")
