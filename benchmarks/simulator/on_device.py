"""What a device does, in a process of its own: Taichi runs on one device a process.

``python -m benchmarks.simulator.on_device DEVICE FILE [COUNT ...] [--parts PART ...]``: steps per second by
environments, printed as JSON, and what some environments go through, into FILE, to be compared with another
device's.
"""

import json
from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch

from agent.planner import Planner
from benchmarks.common.pages import write_arrays
from sim import HouseVectorEnv
from sim.config import PRESETS

ENVIRONMENTS = (64, 1024, 4096, 16384, 65536, 262144, 1048576)
ROUNDS, STEPS = 15, 16
TRAIL, TRAILED = 500, 64
"""Steps and environments whose outcomes are compared."""
SHARES = (0.15, 0.15, 0.7)
"""Of the actions turn left, turn right and forward."""
PARTS = ("continuous", "free", "planner")
"""What is measured: backends, and planners that bodies follow."""
PLANNERS = 16384
"""Environments with planners at most, as each has maps of half a megabyte."""


def main(device: str, file: str, counts: Sequence[int], parts: Sequence[str]) -> None:
    """Write the outcomes, print the rates of each part."""
    write_trails(device, file)
    measured = {}
    for part in parts:
        rates = planner_rates if part == "planner" else partial(step_rates, backend=part)
        most = PLANNERS if part == "planner" else max(counts)
        measured[part] = [rates(device, count) for count in counts if count <= most]
    print(json.dumps(measured))


def write_trails(device: str, file: str) -> None:
    """Write what environments of each preset, and planners, go through: ``trail``, ``led``."""
    found: Any = {}
    for preset in PRESETS:
        found |= {f"{preset}/{part}": rows for part, rows in trail(device, preset).items()}
    write_arrays(Path(file), **found, advice=led(device))


def trail(device: str, preset: str) -> dict[str, np.ndarray]:
    """What ``TRAILED`` environments go through in ``TRAIL`` steps with random actions: ``events`` (T, E, 5)
    reward, ends, bump and house, ``places`` (T, E, 5) pose and target, ``seen`` (T, E, R, C).
    """
    backend = "free" if preset == "drive" else "continuous"
    envs = HouseVectorEnv(num_envs=TRAILED, preset=preset, targets="mixed", backend=backend, device=device)
    envs.reset(seed=0)
    events, places, seen = [], [], []
    for actions in random_actions(envs, TRAIL).astype(np.int64):
        observation, reward, terminated, truncated, info = envs.step(actions)
        events.append(np.column_stack([reward, terminated, truncated, info["blocked"], info["house"]]))
        places.append(np.column_stack([info["pose"], info["target"]]))
        seen.append(observation)
    return {"events": np.array(events), "places": np.array(places), "seen": np.array(seen)}


def random_actions(envs: HouseVectorEnv, steps: int) -> np.ndarray:
    """Numbers of actions (steps, E), or (v, w) where a body drives by its speeds (steps, E, 2) float32."""
    rng, size = np.random.default_rng(0), (steps, envs.num_envs)
    if not envs.config.drives:
        return rng.choice(3, p=SHARES, size=size)
    drive = envs.config.drive
    if drive.commands:
        return rng.integers(len(drive.commands), size=size)
    return rng.uniform(drive.low, drive.high, (*size, 2)).astype(np.float32)


def step_rates(device: str, count: int, backend: str) -> dict[str, float | list[float]]:
    """Steps per second of ``count`` environments, of ``step_torch`` and its kernel: quartiles of rounds."""
    envs = HouseVectorEnv(num_envs=count, targets="mixed", backend=backend, device=device)
    envs.reset(seed=0)
    actions = list(torch.as_tensor(random_actions(envs, STEPS), device=device))
    return {
        "environments": count,
        "step_torch": timed(device, count, [lambda each=each: envs.step_torch(each) for each in actions]),
        "kernel": timed(device, count, [lambda: envs.world.run("step")] * STEPS),
    }


def led(device: str) -> np.ndarray:
    """What planners advise (T, E) in ``TRAIL`` steps of ``TRAILED`` environments that follow them."""
    envs = HouseVectorEnv(num_envs=TRAILED, targets="secondary", device=device)
    follow, planner = follower(envs)
    advice = []
    for _ in range(TRAIL):
        follow()
        advice.append(planner.advice.cpu().numpy().copy())
    return np.array(advice)


def planner_rates(device: str, count: int) -> dict[str, float | list[float]]:
    """Steps per second of planners and the environments that follow them: quartiles of rounds."""
    envs = HouseVectorEnv(num_envs=count, targets="secondary", device=device)
    follow, _ = follower(envs)
    return {"environments": count, "planner": timed(device, count, [follow] * STEPS)}


def follower(envs: HouseVectorEnv) -> tuple[Callable[[], None], Planner]:
    """A step of environments by the advice of their planners, and these."""
    planner, device = Planner(envs.config, envs.num_envs), envs.device
    begun = torch.ones(envs.num_envs, dtype=torch.bool, device=device)
    planner.step(torch.as_tensor(envs.reset(seed=0)[0], device=device), ~begun, planner.advice, begun)

    def follow() -> None:
        observation, _, terminated, truncated, info = envs.step_torch(planner.advice)
        planner.step(observation, info["blocked"], planner.advice, begun)
        torch.logical_or(terminated, truncated, out=begun)

    begun.fill_(False)
    return follow, planner


def timed(device: str, count: int, steps: Sequence[Callable[[], object]]) -> list[float]:
    """Quartiles of how many steps of ``count`` environments are made a second, after a round to warm up."""
    measured = []
    for _ in range(1 + ROUNDS):
        before = perf_counter()
        for step in steps:
            step()
        if device == "cuda":
            torch.cuda.synchronize()
        measured.append(len(steps) * count / (perf_counter() - before))
    return np.percentile(measured[1:], [25, 50, 75]).tolist()


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("device")
    parser.add_argument("file")
    parser.add_argument("counts", nargs="*", type=int, default=ENVIRONMENTS)
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=PARTS)
    given = parser.parse_args()
    main(given.device, given.file, given.counts, given.parts)
