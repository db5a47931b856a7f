"""What the examples share: their options, our avoidance layer as a wrapper, and the score at the end.

It is that of ``vitruvius evaluate``: an episode in each held-out house, the same starts and the same targets
in the same order for all policies, as a ratio to the oracle. The JSON has the form of that command's, which
shows it in its tables by ``--scores``.
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

from agent import banks
from agent.avoidance import subsume
from agent.evaluation.baselines import BASELINES
from agent.evaluation.episodes import play
from agent.evaluation.protocol import shortest_ways
from agent.evaluation.result import Result
from agent.evaluation.scores import ScoredBank, ScoreFile, modes_of
from agent.learning.config import TargetMode
from agent.learning.environments import make_envs, shield
from logic import load
from logic.house.files import write_whole
from sim import DEFAULT, Config
from sim.actions import ACTIONS
from sim.baselines.coverage import Coverage
from sim.config import PRESETS

Act = Callable[[Tensor], Tensor]
"""From observations (E, n) to preferences (E, 3)."""


def forget(environments: int) -> None:
    """E episodes begin: for agents that remember nothing."""


def rays(seen: Tensor) -> Tensor:
    """The rays (E, 40, 2) of observations (E, n), of which they are the first part."""
    return seen[:, : 2 * DEFAULT.rays].unflatten(1, (DEFAULT.rays, 2))


@dataclass(frozen=True)
class Task:
    """What is learnt in, for how long, and what is measured in."""

    houses: Annotated[Path, tyro.conf.Positional]
    """House file to learn in: vitruvius generate makes one."""

    held_out: Path = Path(banks.NAME)
    """House file to be measured in, or a frozen bank: test-v1, home-test-v1."""

    targets: TargetMode = "main"
    """Where targets lie."""

    steps: int = 500_000
    """Environment steps to learn from."""

    environments: int = 64
    """Environments stepped at once."""

    observe: tuple[str, ...] = ("rays",)
    """What the agent may know, rays first: of sim.Config.observe."""

    avoid: bool = False
    """Put our avoidance layer over the agent: a step into something becomes a turn."""

    seed: int = 0
    """Of the training. Starts and targets that are measured with do not depend on it."""

    out: Path | None = None
    """File for all figures, and each house's, as JSON: vitruvius evaluate --scores FILE shows them."""

    @property
    def config(self) -> Config:
        """What an observation is: one row of numbers, (E, n)."""
        return replace(PRESETS["default"], observe=self.observe, flat=True)

    @property
    def numbers(self) -> int:
        """How many numbers it has."""
        return self.config.rays * self.config.channels + self.config.extra_numbers

    def make_envs(self) -> VectorEnv:
        """The environments to learn in. They begin the next episode in the step that ends one."""
        banks.require_training(load(self.houses), self.houses)
        envs = gymnasium.make_vec(
            "sim:Vitruvius/House-v0",
            num_envs=self.environments,
            houses=str(self.houses),
            targets=self.targets,
            preset=self.config,
            seed=self.seed,
            autoreset_mode="SameStep",
        )
        return Avoiding(envs) if self.avoid else envs

    def score(self, name: str, act: Act, begin: Callable[[int], None] = forget) -> Result:
        """Measure, print and write how good an agent is, that is told when E episodes ``begin``."""
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
    """Environments under our avoidance layer: an agent's step into something becomes a turn to the left."""

    def __init__(self, env: VectorEnv) -> None:
        """Guard the body by what its rays show."""
        super().__init__(env)
        self.autoreset_mode: AutoresetMode = env.metadata["autoreset_mode"]  # TorchRL asks for it
        self.shield = shield(env.unwrapped)  # pyright: ignore[reportArgumentType]

    def reset(self, **kwargs: Any) -> tuple[Any, dict[str, Any]]:
        """As the environments do."""
        seen, info = self.env.reset(**kwargs)
        self.allowed = self.allows(seen, info)
        return seen, info

    def step(self, actions: Any) -> tuple[Any, ...]:
        """Make those of the actions (E,) that are allowed."""
        made = subsume(one_hot(torch.as_tensor(actions), ACTIONS).float(), self.allowed)
        seen, *rest, info = self.env.step(made.numpy())
        self.allowed = self.allows(seen, info)
        return seen, *rest, info

    def allows(self, seen: Any, info: dict[str, Any]) -> Tensor:
        """Which actions (E, 3) bool may come next. Found at once, as what is returned is the caller's."""
        return self.shield(rays(torch.from_numpy(seen)), torch.from_numpy(info["blocked"]))


class Agent:
    """A function from observations to preferences as a ``Policy``, by itself or under avoidance."""

    def __init__(self, act: Act, begin: Callable[[int], None], envs: Any = None) -> None:
        """Act under the avoidance layer for the body of ``envs``, if they are given."""
        self.act, self.begins = act, begin
        self.avoidance, self.interventions = shield(envs) if envs else None, 0

    def begin(self, environments: int) -> None:
        """An episode begins in each of that many environments."""
        self.interventions = 0
        self.begins(environments)

    @torch.no_grad()
    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E,) int64 for observations (E, n); ``blocked`` (E,) bool: the last move was."""
        chosen = self.act(observation).argmax(1)
        if self.avoidance is None:
            return chosen
        actions = subsume(one_hot(chosen, ACTIONS).float(), self.avoidance(rays(observation), blocked))
        self.interventions += int((actions != chosen).sum())
        return actions


class Frames:
    """The last observations of each environment in one row, the newest at the end; zeros before the first."""

    def __init__(self, number: int, size: int) -> None:
        """So many, of (E, size) each."""
        self.number, self.size = number, size

    def begin(self, environments: int) -> None:
        """Forget all."""
        self.row = torch.zeros(environments, self.number * self.size)

    def __call__(self, observation: Tensor) -> Tensor:
        """(E, number * size), with an observation (E, size) more."""
        self.row = torch.cat([self.row[:, self.size :], observation], dim=1)
        return self.row
