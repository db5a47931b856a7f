"""Common parts of the examples: options, the avoidance layer as a wrapper, and the final score.

The score is that of ``vitruvius evaluate``: an episode in each held-out house, with the same starts and the
same targets in the same order for all policies, as a ratio to the oracle. The JSON has the form of that
command's file, so ``vitruvius evaluate --scores`` shows it in tables.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import gymnasium
import numpy as np
import torch
import tyro
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from torch import Tensor
from torch.nn.functional import one_hot

from vitruvius import load
from vitruvius.agent import banks
from vitruvius.agent.avoidance import subsume
from vitruvius.agent.baselines.coverage import Coverage
from vitruvius.agent.baselines.table import BASELINES
from vitruvius.agent.evaluation.episodes import play
from vitruvius.agent.evaluation.protocol import shortest_ways
from vitruvius.agent.evaluation.result import Result
from vitruvius.agent.evaluation.scores import ScoredBank, ScoreFile, modes_of
from vitruvius.agent.learning.config import TargetMode
from vitruvius.agent.learning.environments import make_envs, shield
from vitruvius.logic.files.writing import write_whole
from vitruvius.sim import DEFAULT, Config
from vitruvius.sim.actions import ACTIONS
from vitruvius.sim.config import PRESETS

Act = Callable[[Tensor], Tensor]
"""Function from observations (E, n) to preferences (E, 3)."""


def forget(environments: int) -> None:
    """Do nothing as E episodes begin: for agents without a memory."""


def rays(seen: Tensor) -> Tensor:
    """Return the rays (E, 40, 2) of observations (E, n), which are their first part."""
    return seen[:, : 2 * DEFAULT.rays].unflatten(1, (DEFAULT.rays, 2))


@dataclass(frozen=True)
class Task:
    """Settings of training and evaluation."""

    houses: Annotated[Path, tyro.conf.Positional]
    """House file to train on: vitruvius generate makes one."""

    held_out: Path = Path(banks.NAME)
    """House file to evaluate on, or a frozen bank: test-v1, home-test-v1."""

    targets: TargetMode = "main"
    """Location of the targets."""

    steps: int = 500_000
    """Environment steps of the training."""

    environments: int = 64
    """Number of environments stepped together."""

    observe: tuple[str, ...] = ("rays",)
    """Signals that the agent observes, rays first: names of sim.Config.observe."""

    avoid: bool = False
    """Put the avoidance layer over the agent: a step into an obstacle becomes a turn."""

    seed: int = 0
    """Seed of the training. Starts and targets of the evaluation do not depend on it."""

    out: Path | None = None
    """File for all figures, and each house's, as JSON: vitruvius evaluate --scores FILE shows them."""

    @property
    def config(self) -> Config:
        """Simulator settings with observations as one row of numbers, (E, n)."""
        return replace(PRESETS["default"], observe=self.observe, flat=True)

    @property
    def numbers(self) -> int:
        """Number of values in an observation."""
        return self.config.rays * self.config.channels + self.config.extra_numbers

    def make_envs(self) -> VectorEnv:
        """Return the environments to train in. They begin the next episode in the step that ends one."""
        banks.require_training(load(self.houses), self.houses)
        envs = gymnasium.make_vec(
            "vitruvius:Vitruvius/House-v0",
            num_envs=self.environments,
            houses=str(self.houses),
            targets=self.targets,
            preset=self.config,
            seed=self.seed,
            autoreset_mode="SameStep",
        )
        return Avoiding(envs) if self.avoid else envs

    def score(self, name: str, act: Act, begin: Callable[[int], None] = forget) -> Result:
        """Evaluate an agent, print and write its score; ``begin`` is called when E episodes begin."""
        name += " + avoidance" if self.avoid else ""
        houses = banks.named(self.held_out)
        envs = make_envs(houses, len(houses), self.targets, preset=self.config)
        agent = Agent(act, begin, envs if self.avoid else None)
        policies = {name: agent, "oracle": BASELINES["oracle"](envs, 0)}
        coverage = Coverage(envs)
        runs = {each: (play(envs, policy, 0, coverage=coverage),) for each, policy in policies.items()}
        rooms = np.array([len(house.secondary) for house in houses])
        result = Result(self.targets, rooms, shortest_ways(envs, 0), runs)
        if self.out:
            bank = ScoredBank(banks.bank_hash(houses), str(self.held_out), len(houses))
            modes = modes_of([result])
            file = ScoreFile(bank, 0, modes, agents=[name], training_steps=self.steps)
            write_whole(self.out, file.json())
        print(
            f"{name}, {self.steps:,} steps: {result.targets(name).text(1)} targets, "
            f"{result.ratio(name).text()} of the oracle's, {self.targets}, {len(houses)} houses"
        )
        return result


class Avoiding(VectorWrapper):
    """Environments with the avoidance layer: an agent's step into an obstacle becomes a turn to the left."""

    def __init__(self, env: VectorEnv) -> None:
        """Guard the body by its rays."""
        super().__init__(env)
        self.autoreset_mode: AutoresetMode = env.metadata["autoreset_mode"]  # TorchRL asks for it
        self.shield = shield(env.unwrapped)  # pyright: ignore[reportArgumentType]

    def reset(self, **kwargs: Any) -> tuple[Any, dict[str, Any]]:
        """Reset the environments."""
        seen, info = self.env.reset(**kwargs)
        self.allowed = self.allows(seen, info)
        return seen, info

    def step(self, actions: Any) -> tuple[Any, ...]:
        """Step the environments with those of the actions (E,) that are allowed."""
        made = subsume(one_hot(torch.as_tensor(actions), ACTIONS).float(), self.allowed)
        seen, *rest, info = self.env.step(made.numpy())
        self.allowed = self.allows(seen, info)
        return seen, *rest, info

    def allows(self, seen: Any, info: dict[str, Any]) -> Tensor:
        """Return the mask (E, 3) bool of allowed next actions.

        It is computed at once, as the returned observations belong to the caller.
        """
        return self.shield(rays(torch.from_numpy(seen)), torch.from_numpy(info["blocked"]))


class Agent:
    """Policy made of a function from observations to preferences, with or without avoidance."""

    def __init__(self, act: Act, begin: Callable[[int], None], envs: Any = None) -> None:
        """Act under the avoidance layer for the body of ``envs``, if they are given."""
        self.act, self.begins = act, begin
        self.avoidance, self.interventions = shield(envs) if envs else None, 0

    def begin(self, environments: int) -> None:
        """Begin an episode in each of ``environments`` environments."""
        self.interventions = 0
        self.begins(environments)

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 for observations (E, n) and the mask (E,) bool ``blocked``."""
        chosen = self.act(observation).argmax(1)
        if self.avoidance is None:
            return chosen
        actions = subsume(one_hot(chosen, ACTIONS).float(), self.avoidance(rays(observation), blocked))
        self.interventions += int((actions != chosen).sum())
        return actions


class Frames:
    """Last observations of each environment in one row, the newest at the end; zeros before the first."""

    def __init__(self, number: int, size: int) -> None:
        """Keep ``number`` observations of (E, size) each."""
        self.number, self.size = number, size

    def begin(self, environments: int) -> None:
        """Forget the past."""
        self.row = torch.zeros(environments, self.number * self.size)

    def __call__(self, observation: Tensor) -> Tensor:
        """Return the row (E, number * size) with an observation (E, size) added."""
        self.row = torch.cat([self.row[:, self.size :], observation], dim=1)
        return self.row
