"""What a device does, in a process of its own: Taichi runs on one device a process.

``python -m benchmarks.simulator.on_device DEVICE FILE [COUNT ...]``: steps a second by environments, printed
as JSON, and what some environments go through, into FILE, to be compared with another device's.
"""

import json
from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch

from benchmarks.common.pages import write_arrays
from sim import HouseVectorEnv
from sim.config import PRESETS

ENVIRONMENTS = (64, 1024, 4096, 16384, 65536, 262144, 1048576)
ROUNDS, STEPS = 15, 16
TRAIL, TRAILED = 500, 64
"""Steps and environments whose outcomes are compared."""
SHARES = (0.15, 0.15, 0.7)
"""Of the actions."""


def main(device: str, file: str, counts: Sequence[int]) -> None:
    """Write the outcomes, print the rates."""
    write_trails(device, file)
    print(json.dumps([rates(device, count) for count in counts]))


def write_trails(device: str, file: str) -> None:
    """Write what environments of each preset go through: ``trail``."""
    found: Any = {}
    for preset in PRESETS:
        found |= {f"{preset}/{part}": rows for part, rows in trail(device, preset).items()}
    write_arrays(Path(file), **found)


def trail(device: str, preset: str) -> dict[str, np.ndarray]:
    """What ``TRAILED`` environments go through in ``TRAIL`` steps with random actions: ``events`` (T, E, 5)
    reward, ends, bump and house, ``places`` (T, E, 5) pose and target, ``seen`` (T, E, R, C).
    """
    envs = HouseVectorEnv(num_envs=TRAILED, preset=preset, targets="mixed", device=device)
    envs.reset(seed=0)
    plan = np.random.default_rng(0).choice(3, p=SHARES, size=(TRAIL, TRAILED))
    events, places, seen = [], [], []
    for actions in plan:
        observation, reward, terminated, truncated, info = envs.step(actions)
        events.append(np.column_stack([reward, terminated, truncated, info["blocked"], info["house"]]))
        places.append(np.column_stack([info["pose"], info["target"]]))
        seen.append(observation)
    return {"events": np.array(events), "places": np.array(places), "seen": np.array(seen)}


def rates(device: str, count: int) -> dict[str, float | list[float]]:
    """Steps a second of ``count`` environments, of ``step_torch`` and of its kernel: quartiles of rounds."""
    envs = HouseVectorEnv(num_envs=count, targets="mixed", device=device)
    envs.reset(seed=0)
    plan = np.random.default_rng(0).choice(3, p=SHARES, size=(STEPS, count))
    actions = list(torch.as_tensor(plan, device=device))

    def timed(step: Callable[[torch.Tensor], object]) -> list[float]:
        measured = []
        for _ in range(1 + ROUNDS):
            before = perf_counter()
            for each in actions:
                step(each)
            if device == "cuda":
                torch.cuda.synchronize()
            measured.append(STEPS * count / (perf_counter() - before))
        return np.percentile(measured[1:], [25, 50, 75]).tolist()

    return {
        "environments": count,
        "step_torch": timed(envs.step_torch),
        "kernel": timed(lambda each: envs.world.run("step")),
    }


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("device")
    parser.add_argument("file")
    parser.add_argument("counts", nargs="*", type=int, default=ENVIRONMENTS)
    given = parser.parse_args()
    main(given.device, given.file, given.counts)
