"""Outcomes on a device: ``python -m benchmarks.speed.trails DEVICE FILE`` writes arrays to compare."""

from argparse import ArgumentParser
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.common.pages import write_arrays
from benchmarks.speed.worker import follower, random_actions
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import PRESETS

TRAIL, TRAILED = 500, 64
"""Steps and environments whose outcomes are compared."""


def write_trails(device: str, file: str) -> None:
    """Write what environments of each preset, and planners, go through: ``trail``, ``led``."""
    found: Any = {}
    for preset in PRESETS:
        found |= {f"{preset}/{part}": rows for part, rows in trail(device, preset).items()}
    write_arrays(Path(file), **found, advice=led(device))


def trail(device: str, preset: str) -> dict[str, np.ndarray]:
    """Return the outcomes of ``TRAILED`` environments in ``TRAIL`` steps with random actions.

    ``events`` (T, E, 5): reward, ends, bump and house; ``places`` (T, E, 5): pose and target; ``seen``
    (T, E, R, C).
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


def led(device: str) -> np.ndarray:
    """Return the advice of planners (T, E) in ``TRAIL`` steps of ``TRAILED`` environments."""
    envs = HouseVectorEnv(num_envs=TRAILED, targets="secondary", device=device)
    follow, planner = follower(envs)
    advice = []
    for _ in range(TRAIL):
        follow()
        advice.append(planner.advice.cpu().numpy().copy())
    return np.array(advice)


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("device")
    parser.add_argument("file")
    given = parser.parse_args()
    write_trails(given.device, given.file)
