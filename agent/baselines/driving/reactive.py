"""Reactive policies for bodies that drive: a random drive and a pursuit. They have no memory."""

import numpy as np
import torch
from torch import Tensor

from vitruvius.sim.config import Config

NEAR_WALL_M = 0.4
"""Distance to a wall, in metres, at which a pursuit turns."""


class RandomDrive:
    """Policy that draws any (v, w) that the body can execute."""

    interventions = 0

    def __init__(self, config: Config, seed: int) -> None:
        """Draw for bodies of a configuration."""
        self.config, self.rng = config, np.random.default_rng(seed)

    def begin(self, environments: int) -> None:
        """Do nothing: the policy has no memory."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E, 2) float32 without a look at the observation."""
        drive = self.config.drive
        told = self.rng.uniform(drive.low, drive.high, (len(observation), 2))
        return torch.from_numpy(told.astype(np.float32))


class Pursuit:
    """Policy that pursues what its rays show."""

    interventions = 0

    def __init__(self, config: Config) -> None:
        """Pursue with rays of a configuration."""
        self.config = config

    def begin(self, environments: int) -> None:
        """Do nothing: the policy has no memory."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Return actions (E, 2) float32."""
        seen = observation[..., [self.config.column("distance"), -1]]
        return torch.from_numpy(pursue(seen.numpy(), self.config))


def pursue(seen: np.ndarray, config: Config) -> np.ndarray:
    """Return (v, w) (E, 2) float32 for rays (E, R, 2) of distance and target flag.

    The body drives towards the target if a ray shows it; otherwise it drives where the rays go furthest and
    turns in front of walls.
    """
    drive, angles, shown = config.drive, config.ray_angles, seen[..., 1] > 0
    ahead = np.abs(angles) < np.deg2rad(30)
    sees, open_ = shown.any(axis=1), seen[:, ahead, 0].min(axis=1) * config.range > NEAR_WALL_M
    middle = (shown * angles).sum(axis=1) / np.maximum(1, shown.sum(axis=1))
    furthest = angles[seen[..., 0].argmax(axis=1)]
    turn = np.where(sees, 4 * middle, np.where(open_, furthest, drive.turn_speed))
    fast = np.where(sees, np.abs(middle) < 0.5, open_)
    turn = np.clip(turn, -drive.turn_speed, drive.turn_speed)
    return np.column_stack([np.where(fast, drive.speed, 0), turn]).astype(np.float32)
