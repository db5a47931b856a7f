"""What learners from a replay buffer share: when they learn, their reports, their state."""

from abc import abstractmethod
from time import perf_counter
from typing import Any, ClassVar

import torch
from torch import Tensor

from agent.learning.learner import Learner, Progress, Tally
from agent.learning.replay import ReplayBuffer
from sim import HouseVectorEnv

REPORT = 128
"""Steps of every environment between two reports."""


class ReplayLearner(Learner):
    """A run that learns from what it replays."""

    config: Any
    replay: ReplayBuffer

    last: ClassVar[tuple[str, ...]]
    """What the next step depends on beside networks and buffer."""

    least_rows: int
    """Rows of the buffer without which there is nothing to learn from."""

    def __init__(self, config: Any, envs: HouseVectorEnv) -> None:
        """Begin a run; ``envs`` has the environments and the world of ``config``, and NEXT_STEP autoreset."""
        super().__init__(config, envs, report=REPORT)
        self.updates, self.tally = 0, Tally()
        self.reset_envs()

    @property
    @abstractmethod
    def epsilon(self) -> float:
        """Share of random actions now."""

    @property
    def ready(self) -> bool:
        """Whether the buffer holds enough to learn from."""
        least = max(self.config.learning_starts // self.config.num_envs, self.least_rows)
        return self.replay.written >= min(least, self.replay.rows)

    def iterate(self) -> Progress:
        """Step all environments and learn, up to the next report."""
        start, losses, self.tally = perf_counter(), [], Tally()
        for _ in range(REPORT):
            losses += self.step()
        self.clock.all += perf_counter() - start
        loss = float(torch.stack(losses).mean()) if losses else 0.0
        return self.report(self.tally, loss=loss, epsilon=self.epsilon)

    @abstractmethod
    def step(self) -> list[Tensor]:
        """Step all environments once, and learn where that is due; the losses."""

    def own_state(self) -> dict[str, Any]:
        """The optimiser, the replay buffer, and where the environments are."""
        return {
            "optimizer": self.optimizer.state_dict(),
            "replay": self.replay.state(),
            "last": {name: getattr(self, name) for name in self.last},
        }

    def restore_own(self, state: dict[str, Any]) -> None:
        """Take up what ``own_state`` gave."""
        self.optimizer.load_state_dict(state["optimizer"])
        self.replay.restore(state["replay"])
        for name in self.last:
            value = state["last"][name]
            setattr(self, name, value.clone() if isinstance(value, Tensor) else value)
