"""Marks on planners' maps that the planners do not keep.

Marks are the places where targets were picked up in an episode, and those where rays met furniture of the
kinds that observations distinguish. Marks help to predict the next target.
"""

import numpy as np
from torch import Tensor

from vitruvius.agent.algorithms.map_completion.network import FINDS, PIECES, WINDOW
from vitruvius.agent.planner import Planner
from vitruvius.sim.config import Config

INSIDE_CELLS = 0.3
"""Distance beyond a ray's end, in cells, of the point that is taken to lie in the furniture."""


class Marks:
    """Marks of E environments' maps."""

    def __init__(self, world: Config, planner: Planner) -> None:
        self.world, self.planner = world, planner
        side = 1 << planner.config.map_bits - 1
        self.blocks = np.zeros((len(planner.advice), 2, side, side), np.uint8)
        """Number of targets picked up in a block; and 1 + the index in ``Config.kinds`` of the furniture that
        rays met there last, 0 for none. South by east on the planner's torus."""
        self.found = np.zeros(len(planner.advice), np.int32)
        self.directions = planner.arrays["directions"].numpy().reshape(8, world.rays, 2)

    def note(self, observation: Tensor) -> None:
        """Mark what the planners' last step shows; ``observation`` (E, R, C) is that of the step."""
        x, y, heading, time, found = (
            self.planner.read(name).numpy() for name in ("x", "y", "heading", "time", "found")
        )
        begun, last = np.flatnonzero(time == 1), self.blocks.shape[-1] - 1
        self.blocks[begun], self.found[begun] = 0, 0
        picked = np.flatnonzero(found > self.found)
        # The body's place, as the target was within its reach, in half cells: four to a block.
        at = picked, FINDS, (y[picked] + 2 >> 2) & last, (x[picked] + 2 >> 2) & last
        self.blocks[at] = np.minimum(self.blocks[at], 254) + 1
        self.found[:] = found
        if not self.world.kinds:
            return
        shown, columns = observation.numpy(), [self.world.column(f"kind {kind}") for kind in self.world.kinds]
        distance = shown[..., self.world.column("distance")]
        environment, ray, kind = shown[..., columns].nonzero()
        way = self.directions[heading[environment], ray]
        away = (distance[environment, ray] + INSIDE_CELLS / np.linalg.norm(way, axis=-1))[:, None] * way
        east, south = (
            np.floor((each[environment] / 2 + way + 1) / 2).astype(int) & last
            for each, way in zip((x, y), away.T, strict=True)
        )
        self.blocks[environment, PIECES, south, east] = kind + 1

    def read(self, environments: np.ndarray, corners: np.ndarray) -> np.ndarray:
        """Return the marks (n, 2, W, W) uint8 in windows of these environments with these corners (n, 2)."""
        side, axis = self.blocks.shape[-1], np.arange(WINDOW)
        south, east = ((corners[:, k, None] + axis) % side for k in range(2))
        rows = self.blocks[environments[:, None], :, south]  # (n, W, 2, side)
        taken = np.take_along_axis(rows, east[:, None, None, :], axis=3)
        return np.ascontiguousarray(taken.swapaxes(1, 2))
