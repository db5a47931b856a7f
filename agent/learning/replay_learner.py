"""Common parts of learners with a replay buffer: when they learn, their reports, their state."""

from abc import abstractmethod
from time import perf_counter
from typing import Any, ClassVar

import torch
from torch import Tensor

from vitruvius.agent.learning.learner import Learner, Progress, Tally
from vitruvius.agent.learning.replay import ReplayBuffer
from vitruvius.sim import HouseVectorEnv

REPORT_STEPS = 128
"""Steps of every environment between two reports."""


class ReplayLearner(Learner):
    """Run that learns from replayed steps."""

    config: Any
    replay: ReplayBuffer

    last: ClassVar[tuple[str, ...]]
    """Attributes, besides networks and buffer, that the next step depends on."""

    least_rows: int
    """Least number of rows to learn from."""

    def __init__(self, config: Any, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has the environments and the world of ``config``, and NEXT_STEP autoreset."""
        super().__init__(config, envs, report=REPORT_STEPS)
        self.updates, self.tally = 0, Tally()
        self.reset_envs()

    @property
    @abstractmethod
    def epsilon(self) -> float:
        """Current fraction of random actions."""

    @property
    def ready(self) -> bool:
        """True if the buffer holds enough to learn from."""
        least = max(self.config.learning_starts // self.config.num_envs, self.least_rows)
        return self.replay.written >= min(least, self.replay.rows)

    def iterate(self) -> Progress:
        """Step all environments and learn, up to the next report."""
        start, losses, self.tally = perf_counter(), [], Tally()
        for _ in range(REPORT_STEPS):
            losses += self.step()
        self.clock.all += perf_counter() - start
        loss = float(torch.stack(losses).mean()) if losses else 0.0
        return self.report(self.tally, loss=loss, epsilon=self.epsilon)

    @abstractmethod
    def step(self) -> list[Tensor]:
        """Step all environments once, learn if it is due, and return the losses."""

    def own_state(self) -> dict[str, Any]:
        """Return the optimiser's state, the replay buffer, and where the environments are."""
        return {
            "optimizer": self.optimizer.state_dict(),
            "replay": self.replay.state(),
            "last": {name: getattr(self, name) for name in self.last},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Restore what ``own_state`` returned."""
        self.optimizer.load_state_dict(state["optimizer"])
        self.replay.restore(state["replay"])
        for name in self.last:
            value = state["last"][name]
            setattr(self, name, value.clone() if isinstance(value, Tensor) else value)
