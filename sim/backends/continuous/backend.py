"""The continuous backend: any place, any axis-aligned house."""

from collections.abc import Sequence

from logic import House
from sim.backends.backend import Bank
from sim.backends.body import Body
from sim.backends.continuous.move import Motion
from sim.backends.continuous.pack import pack
from sim.backends.continuous.see import Sight
from sim.config import Config
from sim.runtime import ti


@ti.data_oriented
class Continuous(Motion, Sight):
    """A body among boxes: see ``sim.backends.backend.Backend``."""

    def __init__(self, config: Config, lanes: int) -> None:
        """See ``Backend``."""
        self.config, self.body = config, Body(config)
        Motion.__init__(self, config, self.body)
        Sight.__init__(self, config, self.body, lanes)

    @staticmethod
    def fit(config: Config, houses: Sequence[House]) -> Config:
        """Any house will do."""
        return config

    def pack(self, houses: Sequence[House]) -> Bank:
        """See ``Backend``."""
        return pack(houses, self.config)
