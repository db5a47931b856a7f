"""The continuous backend, for any place in any axis-aligned house."""

from collections.abc import Sequence

from vitruvius.logic import House
from vitruvius.sim.backends.backend import Bank
from vitruvius.sim.backends.continuous.move import Motion
from vitruvius.sim.backends.continuous.pack import pack
from vitruvius.sim.backends.continuous.see import Sight
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import require_straight
from vitruvius.sim.runtime import ti


@ti.data_oriented
class Continuous(Motion, Sight):
    """A body among boxes: see ``sim.backends.backend.Backend``."""

    @staticmethod
    def fit(config: Config, houses: Sequence[House]) -> Config:
        """Return the configuration unchanged. Raises ``ValueError`` for a house with walls at an angle."""
        require_straight(houses, "continuous")
        config.require_few_directions()
        return config

    def pack(self, houses: Sequence[House]) -> Bank:
        """Copy houses to the device: see ``Backend``."""
        return pack(houses, self.config)
