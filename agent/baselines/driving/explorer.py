"""Explorer for bodies that drive: a planner and a rule that follows its paths. It has no trained part."""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.baselines.driving.steering import steered
from vitruvius.agent.planner.core.config import TUNED, PlannerConfig
from vitruvius.agent.planner.driving import DrivingPlanner
from vitruvius.sim.config import Config


class DrivingExplorer:
    """Policy that drives by its map to the target that was seen, or else to the next best view."""

    interventions = 0

    def __init__(self, world: Config, poses: Callable[[], np.ndarray], config: PlannerConfig = TUNED) -> None:
        """Explore environments of the configuration ``world``; ``poses`` returns the bodies' poses (E, 3).

        Raises ``ValueError`` for rays from which the planner cannot keep a map.
        """
        self.world, self.poses, self.config = world, poses, config
        self.planner = DrivingPlanner(world, 1, config)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of ``environments`` environments."""
        if len(self.planner.course) != environments:
            self.planner = DrivingPlanner(self.world, environments, self.config)
        self.fresh = torch.ones(environments, dtype=torch.bool)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions for observations (E, R, C): (v, w) (E, 2) float32, or commands' numbers (E,) int64.

        ``blocked`` (E,) bool is true where an obstacle blocked the last action.
        """
        pose = torch.from_numpy(self.poses().astype(np.float32))
        self.planner.drive(observation, blocked, self.fresh, pose)
        self.fresh.fill_(False)
        off, room = self.planner.course.numpy().T
        return torch.from_numpy(steered(self.world.drive, off, np.where(room < 0, np.inf, room)))
