"""Baselines with a body that drives, for evaluations in the backend ``free``.

| baseline | behaviour |
|---|---|
| random drive | draws a random speed and a random turn rate at each step |
| pursuit | drives to a visible target, or else along the longest rays, and turns in front of walls |
| explorer | plans paths, knows its pose, and follows its paths by a rule (``DrivingExplorer``) |
| true path | knows the house and the target, and follows the shortest path by a rule (``TruePath``) |

Scores are shares of the true path's score, because the oracle counts steps on a lattice.
"""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from vitruvius.agent.baselines.driving.explorer import DrivingExplorer
from vitruvius.agent.baselines.driving.true_path import TruePath
from vitruvius.agent.baselines.table import REFERENCES, Privileged
from vitruvius.agent.policies.policies import Policy
from vitruvius.logic import HouseFileError
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.config import Config

TRUE_PATH = "true path"
"""Name of the baseline that ratios divide by if bodies drive."""

NEAR = 0.4
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
    sees, open_ = shown.any(axis=1), seen[:, ahead, 0].min(axis=1) * config.range > NEAR
    middle = (shown * angles).sum(axis=1) / np.maximum(1, shown.sum(axis=1))
    furthest = angles[seen[..., 0].argmax(axis=1)]
    turn = np.where(sees, 4 * middle, np.where(open_, furthest, drive.turn_speed))
    fast = np.where(sees, np.abs(middle) < 0.5, open_)
    turn = np.clip(turn, -drive.turn_speed, drive.turn_speed)
    return np.column_stack([np.where(fast, drive.speed, 0), turn]).astype(np.float32)


def true_path(envs: HouseVectorEnv, seed: int) -> Policy:
    """Return the policy of ``TruePath``. Raises ``HouseFileError`` for a house with too many corners."""
    try:
        return Privileged(TruePath(envs).act)
    except ValueError as error:
        raise HouseFileError(str(error)) from None


DRIVERS: dict[str, Callable[[HouseVectorEnv, int], Policy]] = {
    "random drive": lambda envs, seed: RandomDrive(envs.config, seed),
    "pursuit": lambda envs, seed: Pursuit(envs.config),
    "explorer": lambda envs, seed: DrivingExplorer(envs.config, lambda: envs.unwrapped.world.describe()[0]),
    TRUE_PATH: true_path,
}
"""Functions that make a baseline's policy from environments and a seed, by name."""

EXACT = (TRUE_PATH,)
"""Baselines that know their exact pose: see ``PRIVILEGED``."""

NO_AGENTS = (*REFERENCES, *DRIVERS)
"""Names of all policies that are not agents."""
