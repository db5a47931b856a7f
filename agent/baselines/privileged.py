"""Policies that read the simulator's state."""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor


class Privileged:
    """Policy that reads the simulator's state and not the observation: an oracle or a searcher."""

    interventions = 0

    def __init__(self, act: Callable[[], np.ndarray], begin: Callable[[], None] = lambda: None) -> None:
        """Make the policy; ``act`` returns the actions (E,) int64 from where the bodies are."""
        self.act, self._begin = act, begin

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each environment."""
        self._begin()

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E,) int64 without a look at the observation."""
        return torch.from_numpy(self.act())
