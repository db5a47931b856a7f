"""A body that drives along the shortest path to its target, by rule: it knows house and target.

It pursues the next corner of its path (``path_follower``), or the target: it turns to where that lies as fast
as it can still stop turning, and drives the faster the less it is off. It looks no further than to the target
that it has, and no path of its is the fastest that there is.
"""

import numpy as np

from sim.baselines.path_follower import PathFollower
from sim.baselines.steering import steered
from sim.environment.vector import HouseVectorEnv
from sim.world.world import World


class TruePath:
    """The E bodies of a ``HouseVectorEnv``, told what to do by one who knows the way."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Drive these; the bank must stay as it is. ``ValueError`` where bodies do not drive."""
        self.world: World = envs.unwrapped.world
        config = self.world.config
        if not config.drives:
            raise ValueError("a true path is driven: take the backend free, or an oracle")
        config.drive.require_heading("a true path")
        self.follower = PathFollower(self.world)
        self.follower.arrays["half"].fill(np.full(self.world.num_envs, config.target / 2, np.float32))

    def act(self) -> np.ndarray:
        """What to do next: (v, w) (E, 2) float32, or the numbers (E,) int64 of the nearest commands."""
        pose, target, house = self.world.describe()
        self.follower.arrays["goal"].fill(target.ravel())
        bearing, _ = self.follower.follow(house, pose)
        return steered(self.world.config.drive, bearing - pose[:, 2])
