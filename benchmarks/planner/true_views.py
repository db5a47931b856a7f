"""Agent that follows the values of views in the true house: the upper limit of a view network."""

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.algorithms.search.chooser import ViewChooser, best
from vitruvius.agent.algorithms.search.network import ViewNetwork
from vitruvius.agent.algorithms.search.values import TrueValues
from vitruvius.agent.algorithms.search.windows import ViewMaps, views
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.planner import Planner
from vitruvius.agent.policies.policies import Explorer
from vitruvius.sim import HouseVectorEnv


class TrueChooser(ViewChooser):
    """Chooser of the true best views, by labels instead of a network's values."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        super().__init__(ViewNetwork((1, 1)), envs.config, self.told)
        self.envs = envs
        self.truth: TrueValues | None = None

    def __call__(self, planner: Planner) -> None:
        """Choose the next views: see ``Chooser``."""
        if self.truth is None:
            self.truth = TrueValues(self.envs, planner)
        self.truth.watch(np.flatnonzero(planner.read("time").numpy() == 1), self.reader_of(planner))
        super().__call__(planner)

    def told(self, environments: np.ndarray, maps: ViewMaps) -> Tensor:
        """Return the best views by their labels."""
        reader, truth = self.reader, self.truth
        assert reader is not None
        assert truth is not None
        worth = truth.read(environments, reader.corners(environments))
        return best(torch.where(views(maps), worth, -torch.inf), maps)


def true_views(envs: HouseVectorEnv) -> Explorer:
    """Return the agent with the true values."""
    return Explorer(shield(envs), envs.config, chooser=TrueChooser(envs))
