"""Planner with perfect predictions: the upper limit of map completion for the explorer."""

import numpy as np
import torch

from vitruvius.agent.algorithms.map_completion.foresight import Foresight
from vitruvius.agent.algorithms.map_completion.network import WINDOW, CompletionNetwork, Prediction
from vitruvius.agent.algorithms.map_completion.truth import Truth
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv

SURE = 9.0
"""Logit that is as good as certain."""


class TrueForesight(Foresight):
    """Foresight with the true map instead of a network's prediction."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        super().__init__(envs.config, CompletionNetwork(0, len(envs.config.kinds), (1, 1)))
        self.truth = Truth(envs, (), self.planner.cell)

    def foresee(self, environments: np.ndarray) -> None:
        """Write the truth in these environments (n,) int."""
        self.truth.begin(np.flatnonzero(self.planner.read("time").numpy() == 1))
        self.asked = environments
        super().foresee(environments)

    def predict(self, windows: np.ndarray, marks: np.ndarray, starts: np.ndarray) -> Prediction:
        """Return the truth of these windows, in the form of ``Foresight.predict``."""
        floor, solid, target, _ = self.truth.read(self.asked, -starts.astype(int))
        sure = (torch.from_numpy(np.where(each, SURE, -SURE)).float() for each in (floor, solid == 0))
        nothing = torch.zeros(len(floor), 0, WINDOW // 2, WINDOW // 2)
        return Prediction(*sure, torch.from_numpy(target).clamp(min=1e-9).log(), nothing)


def truth(envs: HouseVectorEnv) -> Explorer:
    """Return the explorer with the truth."""
    return Explorer(shield(envs), envs.config, tracker=TrueForesight(envs))
