"""Common parts of the examples in the backend free: options, and a comparison with two baselines.

The score is the number of targets in an episode in held-out houses, with the same starts and targets for all.
One baseline drives at random speeds; the other pursues what its rays show, by rules.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import gymnasium
import numpy as np
import tyro
from gymnasium.wrappers.vector import RescaleAction

from vitruvius import load
from vitruvius.agent import banks
from vitruvius.agent.baselines.driving import reactive
from vitruvius.sim import DEFAULT

CONFIG = replace(DEFAULT, observe=("rays", "speed"), flat=True)
"""Simulator settings: the agent sees 40 rays and knows its speed."""

Act = Callable[[np.ndarray], np.ndarray]
"""Function from observations (E, 82) to actions (E, 2) in [-1, 1]."""


@dataclass(frozen=True)
class Driving:
    """Settings of training and evaluation."""

    houses: Annotated[Path, tyro.conf.Positional]
    """House file to train on: vitruvius generate makes one."""

    held_out: Path = Path(banks.NAME)
    """House file to evaluate on, or a frozen bank: test-v1, home-test-v1."""

    targets: str = "main"
    """Location of the targets."""

    steps: int = 3_000_000
    """Environment steps of the training."""

    environments: int = 256
    """Number of environments stepped together."""

    seed: int = 0
    """Seed of the training. Starts and targets of the evaluation do not depend on it."""

    def to_learn_in(self) -> gymnasium.vector.VectorEnv:
        """Return the environments to train in."""
        banks.require_training(load(self.houses), self.houses)
        return self.make_envs(str(self.houses), self.environments)

    def make_envs(self, houses: Any, number: int) -> gymnasium.vector.VectorEnv:
        """Return environments whose actions are from -1 to 1."""
        envs = gymnasium.make_vec(
            "vitruvius:Vitruvius/House-v0", num_envs=number, houses=houses, targets=self.targets,
            backend="free", preset=CONFIG, seed=self.seed, autoreset_mode="SameStep",
        )  # fmt: skip
        return RescaleAction(envs, np.full(2, -1, np.float32), np.full(2, 1, np.float32))

    def play(self, act: Act) -> np.ndarray:
        """Return the targets (H,) picked up in an episode of each held-out house."""
        houses = banks.named(self.held_out)
        envs = self.make_envs(houses, len(houses))
        seen, _ = envs.reset(seed=0, options={"house": np.arange(len(houses))})
        found = np.zeros(len(houses))
        for _ in range(CONFIG.steps):
            seen, reward, *_ = envs.step(np.clip(act(seen), -1, 1))
            found += reward
        return found

    def score(self, name: str, act: Act) -> dict[str, float]:
        """Measure and print the targets in an episode of an agent, and of both baselines."""
        rng = np.random.default_rng(0)
        agents: dict[str, Act] = {
            name: act,
            "pursuit": pursue,
            "random": lambda seen: rng.uniform(-1, 1, (len(seen), 2)).astype(np.float32),
        }
        found = {each: self.play(act) for each, act in agents.items()}
        for each, targets in found.items():
            error = 1.96 * targets.std() / len(targets) ** 0.5
            print(
                f"{each}: {targets.mean():.2f} ± {error:.2f} targets, {self.targets}, {len(targets)} houses"
            )
        return {each: float(targets.mean()) for each, targets in found.items()}


def pursue(seen: np.ndarray) -> np.ndarray:
    """Drive towards a visible target; otherwise where rays go furthest, and turn in front of walls."""
    told = reactive.pursue(seen[:, :80].reshape(-1, 40, 2), CONFIG)
    low, high = np.array(CONFIG.drive.low), np.array(CONFIG.drive.high)
    return (2 * (told - low) / (high - low) - 1).astype(np.float32)
