"""The continuous backend, for any place in any axis-aligned house."""

from collections.abc import Sequence

from logic import House
from sim.backends.backend import Bank
from sim.backends.continuous.move import Motion
from sim.backends.continuous.pack import pack
from sim.backends.continuous.see import Sight
from sim.config import Config
from sim.geometry import require_straight
from sim.runtime import ti


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
