"""Baselines of bodies that drive, in the backend ``free``, which evaluations show there in place of others.

| baseline | is |
|---|---|
| random drive | another v and w at each step, drawn from all |
| pursuit | to a target in sight, else where rays go furthest, and around before walls: by rule |
| explorer | the planner, whose paths are followed by rule (``DrivingExplorer``): knows its pose |
| searcher | knows the house and its pose, but not where the target is (``DrivingSearcher``) |
| true path | knows the house and the target, and follows the shortest path by rule (``TruePath``) |
| bound | no player: what none can do better (``TimeBound``) |

Every score is a share of the bound's: the oracle counts steps on a lattice.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np
import torch
from torch import Tensor

from agent.evaluation.baselines import REFERENCES, Privileged
from agent.evaluation.episodes import COVERAGE_STEPS, EpisodeScores
from agent.policies.driving import DrivingExplorer
from agent.policies.policies import Policy
from logic import HouseFileError
from sim import HouseVectorEnv
from sim.baselines.bound import TimeBound
from sim.baselines.driving_searcher import DrivingSearcher
from sim.baselines.true_path import TruePath
from sim.config import Config

NEAR = 0.4
"""Metres before a wall at which a pursuit turns."""


class RandomDrive:
    """Any (v, w) that the body can be told."""

    interventions = 0

    def __init__(self, config: Config, seed: int) -> None:
        """For bodies of a configuration."""
        self.config, self.rng = config, np.random.default_rng(seed)

    def begin(self, environments: int) -> None:
        """Nothing is remembered."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E, 2) float32; the observation is not read."""
        drive = self.config.drive
        told = self.rng.uniform(drive.low, drive.high, (len(observation), 2))
        return torch.from_numpy(told.astype(np.float32))


class Pursuit:
    """Pursues what its rays show."""

    interventions = 0

    def __init__(self, config: Config) -> None:
        """For rays of a configuration."""
        self.config = config

    def begin(self, environments: int) -> None:
        """Nothing is remembered."""

    def __call__(self, observation: Tensor, blocked: Tensor) -> Tensor:
        """Actions (E, 2) float32."""
        seen = observation[..., [self.config.column("distance"), -1]]
        return torch.from_numpy(pursue(seen.numpy(), self.config))


def pursue(seen: np.ndarray, config: Config) -> np.ndarray:
    """(v, w) (E, 2) float32 for rays (E, R, 2), distance and whether it ends on the target: towards the
    target, where a ray does; else where rays go furthest, and around before walls.
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


Knows = TypeVar("Knows", TimeBound, TruePath, DrivingSearcher)


def knowing(make: Callable[[HouseVectorEnv], Knows], envs: HouseVectorEnv) -> Knows:
    """What knows the houses of environments. Raises ``HouseFileError`` for one of too many corners."""
    try:
        return make(envs)
    except ValueError as error:
        raise HouseFileError(str(error)) from None


def searcher(envs: HouseVectorEnv, seed: int) -> Policy:
    """It knows the house, not the target: see ``sim.baselines.driving_searcher``."""
    searcher = knowing(DrivingSearcher, envs)
    return Privileged(searcher.act, searcher.begin)


DRIVERS: dict[str, Callable[[HouseVectorEnv, int], Policy]] = {
    "random drive": lambda envs, seed: RandomDrive(envs.config, seed),
    "pursuit": lambda envs, seed: Pursuit(envs.config),
    "explorer": lambda envs, seed: DrivingExplorer(envs.config, lambda: envs.unwrapped.world.describe()[0]),
    "searcher": searcher,
    "true path": lambda envs, seed: Privileged(knowing(TruePath, envs).act),
}
"""By name, what makes a baseline's policy for environments and a seed."""

EXACT = ("true path",)
"""Those that know where they are, beside the searcher: see ``PRIVILEGED``."""

NO_AGENTS = (*REFERENCES, *DRIVERS, "bound")
"""Names of all that is shown beside agents."""


def bound_scores(bound: TimeBound) -> tuple[EpisodeScores, np.ndarray]:
    """What no policy does better in the episodes (E,) that have begun, and the fewest steps to their first
    target.
    """
    first, count = bound.first(), bound.world.num_envs
    nothing = np.zeros((len(COVERAGE_STEPS), count)), np.zeros(count, int)
    return EpisodeScores(bound.most().astype(float), count * bound.steps, 0, 0, first, *nothing), first
