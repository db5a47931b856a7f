"""Explorer for bodies that drive: a planner and a rule that follows its paths. It has no trained part."""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.baselines.driving.steering import steered
from vitruvius.agent.planner import TUNED, PlannerConfig
from vitruvius.agent.policies.policies import Tracker
from vitruvius.sim.config import Config


class DrivingExplorer:
    """Policy with a map, which drives to a target that it has seen, or else to the next best view.

    This class steers along its planner's course. An ``Explorer`` is the same policy for actions on a lattice.
    """

    interventions = 0

    def __init__(self, world: Config, poses: Callable[[], np.ndarray], config: PlannerConfig = TUNED) -> None:
        """Explore environments of the configuration ``world``; ``poses`` returns the bodies' poses (E, 3).

        Raises ``ValueError`` for bodies that do not drive, and for the reasons of ``Planner``.
        """
        if not world.drives:
            raise ValueError("an explorer that drives needs the backend free")
        self.drive, self.poses = world.drive, poses
        self.tracker = Tracker(world, config)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        self.tracker.begin(environments)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions for observations (E, R, C): (v, w) (E, 2) float32, or commands' numbers (E,) int64.

        ``blocked`` (E,) bool is true where an obstacle blocked the last action.
        """
        self.tracker.actions = torch.from_numpy(self.poses().astype(np.float32))
        turn, stop_m = self.tracker.look(observation, blocked).advice.numpy().T
        return torch.from_numpy(steered(self.drive, turn, np.where(stop_m < 0, np.inf, stop_m)))
