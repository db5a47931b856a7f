"""Explorers that know a part of the house from the start, to measure the effect of that knowledge.

Each kind of ``PRIORS`` includes the ones before it. ``benchmarks.planner.explorers`` selects them by
``--prior``.
"""

import numpy as np
from torch import Tensor

from benchmarks.planner.odds import BESIDE, SIDE, TargetSpots
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.planner import Planner
from vitruvius.agent.planner.core.config import CERTAIN
from vitruvius.agent.policies.policies import Tracker
from vitruvius.sim import HouseVectorEnv

FLOOR, ROOMS, WALLS = PRIORS = "floor", "rooms", "walls"
"""Kinds of prior knowledge: the unseen ground that is floor, where targets may lie in some room; the rooms in
which targets do lie; and the solid cells of a map of the whole house, with their surroundings, but no cell as
seen."""

ELSEWHERE = 15
"""Weight of floor in other rooms, in units of ``CERTAIN``: it may be on a path to the targets' rooms. 5 and
30 do as well."""


class Informed(Tracker):
    """Tracker whose planners know their houses as a prior, from the start of each episode."""

    microseconds = np.nan
    """NaN, because the time of these planners is not compared."""

    def __init__(self, envs: HouseVectorEnv, what: str) -> None:
        """Take one of ``PRIORS``.

        Walls are known after an episode from the same starts and a call of ``remember``.
        """
        super().__init__(envs.config, prior=True)
        self.environments, self.walls = envs.unwrapped.world, None
        anywhere = make_envs(envs.unwrapped.houses, 1, "mixed")
        anywhere.reset(seed=0)
        self.counts = [(anywhere, CERTAIN)] if what == FLOOR else [(anywhere, ELSEWHERE), (envs, CERTAIN)]

    def begin(self, environments: int) -> None:
        """Discard everything, and look up the houses of the bodies."""
        super().begin(environments)
        poses, _, houses = self.environments.describe()
        self.planner.arrays["prior"].fill(self.predict(poses, houses).ravel())

    def predict(self, poses: np.ndarray, houses: np.ndarray) -> np.ndarray:
        """Return the weights of blocks of the maps (E, SIDE / 2, SIDE / 2) uint8.

        The bodies are at these poses, in these houses.
        """
        ground = np.zeros((len(houses), SIDE // 2, SIDE // 2), np.uint8)
        for envs, count in self.counts:
            truth = TargetSpots(envs, poses, self.planner.cell)
            for e, house in enumerate(map(int, houses)):
                away, _ = truth.trees[house].query(truth.where(e, NODES), distance_upper_bound=BESIDE)
                ground[e][(away < BESIDE).reshape(SIDE // 2, -1)] = count
        return ground

    def look(self, observation: Tensor, blocked: Tensor) -> Planner:
        """Return the planners after the last actions; the first time, add the walls."""
        first = bool(self.fresh.all())
        found = super().look(observation, blocked)
        if first and self.walls is not None:
            self.planner.add_walls(self.walls)
        return found

    def remember(self) -> None:
        """Keep the walls of the current maps, for episodes with the same starts."""
        self.walls = self.planner.walls


def _nodes() -> np.ndarray:
    """Return every other node along both axes, in the order of a map: (n, 2) east and south of the start."""
    axis = (np.arange(0, SIDE, 2) + SIDE // 2) % SIDE - SIDE // 2
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


NODES = _nodes()
