"""Work between two reports of a run: evaluation in held-out houses, checkpoints, and the user's hook.

The work does not affect learning: with and without it, the trained network is the same.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import torch

from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.banks import house_key, require_training
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.learning.learner import Progress
from vitruvius.agent.learning.simulator import simulator
from vitruvius.agent.policies.episodes import moments
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.checkpoint import Checkpoint
from vitruvius.logic import House
from vitruvius.logic.dataset.splits import VALIDATION
from vitruvius.logic.errors import RequestError
from vitruvius.sim.tasks.tasks import task
from vitruvius.sim.tasks.terms import counted

MAX_HELD_OUT = 1024
"""Largest number of held-out houses on which an agent is evaluated during training."""


@dataclass(frozen=True)
class Watching:
    """Options for evaluation, checkpoints and the hook during a run, with steps of the environment."""

    held_out: Sequence[House] = ()
    """Houses for evaluation, none of which the agent is trained on. An evaluation plays one episode in
    each."""

    evaluate_every: int = 0
    """Steps between two evaluations; 0: no evaluation. The run keeps the agent with the best evaluation."""

    keep_every: int = 0
    """Steps between two checkpoints in the folder ``checkpoints``; 0: no such checkpoints."""

    hook: Callable[[Progress], object] | None = None
    """Function that the run calls with each report."""

    def require(self, config: TrainConfig, learnt_in: frozenset[int]) -> None:
        """Raise ``RequestError`` for options that the run cannot follow, before the run starts.

        ``learnt_in`` has the keys of the training houses. Raises ``HouseFileError`` for held-out houses that
        are reserved for benchmarks.
        """
        for name in ("evaluate_every", "keep_every"):
            if getattr(self, name) < 0:
                raise RequestError(f"{name} must be 0 or more steps, not {getattr(self, name)}")
        if not self.evaluate_every:
            return
        if not 0 < len(self.held_out) <= MAX_HELD_OUT:
            raise RequestError(
                f"evaluate_every needs 1 to {MAX_HELD_OUT:,} held-out houses, not {len(self.held_out):,}: "
                "name a house file with --held-out"
            )
        if config.device != "cpu":
            raise RequestError("evaluate_every: evaluation on held-out houses needs device cpu")
        require_training(self.held_out, "held-out houses")
        for index, house in enumerate(self.held_out):
            if house_key(house) in learnt_in:
                raise RequestError(
                    f"held-out house {index}: the agent is trained on this house: choose others"
                )


class RunWatcher:
    """Observer of a run, which evaluates the agent and keeps checkpoints between two reports."""

    def __init__(self, asked: Watching, made: Checkpoint, folder: Path, history: Sequence[Progress]) -> None:
        """Start with the reports that the run in ``folder`` has so far."""
        self.asked, self.made, self.folder = asked, made, folder
        self.steps = history[-1].steps if history else 0
        self.best = max((now.held_out for now in history if now.held_out is not None), default=float("-inf"))
        self.envs = None
        if asked.evaluate_every:
            config, wanted = made.config, counted(task(made.config.targets))
            number = len(asked.held_out)
            self.envs = make_envs(
                asked.held_out, number, wanted, preset=simulator(config), backend=config.backend
            )

    def look(self, now: Progress) -> Progress:
        """Do the work that is due after a report. Return the report, with the result of an evaluation."""
        if self.envs is not None and (self._is_due(now, self.asked.evaluate_every) or now.fraction >= 1):
            now = replace(now, held_out=self._evaluated())
            if now.held_out is not None and now.held_out > self.best:
                self.best = now.held_out
                self._keep(now, self.folder / "best.safetensors")
        if self._is_due(now, self.asked.keep_every):
            (self.folder / "checkpoints").mkdir(exist_ok=True)
            self._keep(now, self.folder / "checkpoints" / f"{now.steps}.safetensors")
        self.steps = now.steps
        if self.asked.hook:
            self.asked.hook(now)
        return now

    def close(self) -> None:
        """Close the environments."""
        if self.envs is not None:
            self.envs.close()

    def _is_due(self, now: Progress, every: int) -> bool:
        return every > 0 and now.steps // every > self.steps // every

    def _keep(self, now: Progress, path: Path) -> None:
        checkpoint.save(replace(self.made, steps=now.steps), path)

    def _evaluated(self) -> float:
        """Return the mean number of targets in an episode in the held-out houses.

        All evaluations have the same starts and targets.
        """
        envs: Any = self.envs
        network, count = self.made.network, envs.num_envs
        learning = network.training
        policy = policy_of(network.eval(), self.made.config, envs)
        houses = {"house": torch.arange(count).numpy()}
        observation = torch.as_tensor(envs.reset(seed=VALIDATION.start, options=houses)[0])
        targets, playing = torch.zeros(count), torch.ones(count, dtype=torch.bool)
        for now in moments(envs, policy, observation):
            targets += now.reward * playing
            playing = ~now.ended
        network.train(learning)
        return float(targets.mean())
