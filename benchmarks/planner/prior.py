"""Explorers that know a part of the house from the start, to see what that knowledge changes.

Each kind of ``PRIORS`` has the ones before it too. ``benchmarks.planner.explorers`` has them by ``--prior``.
"""

import numpy as np
from torch import Tensor

from agent.learning.environments import make_envs
from agent.planner import Planner
from agent.planner.config import CERTAIN
from agent.policies.policies import Tracker
from benchmarks.planner.odds import BESIDE, SIDE, TargetSpots
from sim import HouseVectorEnv

FLOOR, ROOMS, WALLS = PRIORS = "floor", "rooms", "walls"
"""Which of the ground that was never seen is floor, where targets may lie in some room; in which rooms they
do lie; and what a map of the whole house shows to be occupied, solid and near, but none of it as seen."""

ELSEWHERE = 15
"""What floor in other rooms counts, of ``CERTAIN``: it may be on a path to those. 5 and 30 do as well."""


class Informed(Tracker):
    """Keeps planners of environments whose prior is that of their houses, from the start of each episode."""

    microseconds = np.nan
    """The time of these planners is not compared."""

    def __init__(self, envs: HouseVectorEnv, what: str) -> None:
        """Give one of ``PRIORS``; walls after an episode from the same starts, when asked to ``remember``."""
        super().__init__(envs.config, prior=True)
        self.environments, self.walls = envs.unwrapped.world, None
        anywhere = make_envs(envs.unwrapped.houses, 1, "mixed")
        anywhere.reset(seed=0)
        self.counts = [(anywhere, CERTAIN)] if what == FLOOR else [(anywhere, ELSEWHERE), (envs, CERTAIN)]

    def begin(self, environments: int) -> None:
        """Forget, and look up the houses that the bodies are in."""
        super().begin(environments)
        poses, _, houses = self.environments.describe()
        self.planner.arrays["prior"].fill(self.predict(poses, houses).ravel())

    def predict(self, poses: np.ndarray, houses: np.ndarray) -> np.ndarray:
        """What blocks of the maps (E, SIDE / 2, SIDE / 2) uint8 count, for bodies at these poses in these
        houses.
        """
        ground = np.zeros((len(houses), SIDE // 2, SIDE // 2), np.uint8)
        for envs, count in self.counts:
            truth = TargetSpots(envs, poses, self.planner.cell)
            for e, house in enumerate(map(int, houses)):
                away, _ = truth.trees[house].query(truth.where(e, NODES), distance_upper_bound=BESIDE)
                ground[e][(away < BESIDE).reshape(SIDE // 2, -1)] = count
        return ground

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """The planners, with what the last actions led to, and at first with the walls."""
        first = bool(self.fresh.all())
        found = super().look(observation, blocked)
        if first and self.walls is not None:
            self.planner.add_walls(self.walls)
        return found

    def remember(self) -> None:
        """Take the walls from the maps as they are, for episodes that begin where this one began."""
        self.walls = self.planner.walls


def _nodes() -> np.ndarray:
    """Every other node along both axes, in the order of a map: its way (n, 2) east and south of the start."""
    axis = (np.arange(0, SIDE, 2) + SIDE // 2) % SIDE - SIDE // 2
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


NODES = _nodes()
