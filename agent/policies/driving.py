"""The explorer of bodies that drive: a planner and a rule that follows its paths. It learns nothing."""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from agent.planner.config import TUNED, PlannerConfig
from agent.planner.driving import DrivingPlanner
from sim.baselines.steering import steered
from sim.config import Config


class DrivingExplorer:
    """Drives to the target that was seen, or else to the next best view, by its map."""

    interventions = 0

    def __init__(self, world: Config, poses: Callable[[], np.ndarray], config: PlannerConfig = TUNED) -> None:
        """Explore environments of the configuration ``world``; ``poses`` says where the bodies (E, 3) are.

        Raises ``ValueError`` for rays that it cannot keep a map by.
        """
        self.world, self.poses, self.config = world, poses, config
        self.planner = DrivingPlanner(world, 1, config)

    def begin(self, environments: int) -> None:
        """Forget the past: an episode begins in each of that many environments."""
        if len(self.planner.course) != environments:
            self.planner = DrivingPlanner(self.world, environments, self.config)
        self.fresh = torch.ones(environments, dtype=torch.bool)

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions for observations (E, R, C): (v, w) (E, 2) float32, or the numbers (E,) int64 of commands;
        ``blocked`` (E,) bool: something was in the way of the last ones.
        """
        pose = torch.from_numpy(self.poses().astype(np.float32))
        self.planner.drive(observation, blocked, self.fresh, pose)
        self.fresh.fill_(False)
        off, room = self.planner.course.numpy().T
        return torch.from_numpy(steered(self.world.drive, off, np.where(room < 0, np.inf, room)))
