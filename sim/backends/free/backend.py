"""The free backend: a disc with continuous motion, and walls at any angle."""

from collections.abc import Sequence
from dataclasses import replace

from vitruvius.logic import House
from vitruvius.sim.backends.backend import Bank
from vitruvius.sim.backends.free.move import Motion
from vitruvius.sim.backends.free.pack import pack
from vitruvius.sim.backends.free.see import Sight
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import ti


@ti.data_oriented
class FreeMotion(Motion, Sight):
    """A driving disc among rectangles at any angle: see ``sim.backends.backend.Backend``."""

    lacks = ("last_action", "geodesic")

    @staticmethod
    def fit(config: Config, houses: Sequence[House]) -> Config:
        """Return the configuration for any houses.

        Raises ``ValueError`` for settings that only bodies on a lattice have.
        """
        if config.body[0] != config.body[1]:
            found = f"{config.body[0]:.3f} and {config.body[1]:.3f} m"
            raise ValueError(
                f"body is {found}: in the backend free the robot is a disc, so both sides must be equal"
            )
        for wrong, words in (
            (config.collision != "swept", "collision 'original'"),
            (not config.random_start, "random_start=False, but a task with a start"),
            (config.eye != (config.body[0] / 2,) * 2, "eye outside the middle of the body"),
            (config.closed_doors, "closed_doors"),
            (config.geodesic, "distance to the target (geodesic), which counts grid steps"),
        ):
            if wrong:
                raise ValueError(f"the backend free does not support {words}")
        return replace(config, drives=True)

    def pack(self, houses: Sequence[House]) -> Bank:
        """Copy houses to the device: see ``Backend``."""
        return pack(houses, self.config)
