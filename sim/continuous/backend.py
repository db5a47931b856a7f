"""The continuous backend: any place, any axis-aligned house."""

from collections.abc import Sequence

from logic import House
from sim.backend import Bank
from sim.body import Body
from sim.config import Config
from sim.continuous.move import Motion
from sim.continuous.pack import pack
from sim.continuous.see import Sight
from sim.runtime import ti


@ti.data_oriented
class Continuous(Motion, Sight):
    """A body among boxes: see ``sim.backend.Backend``."""

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
