"""What there is to predict: of each block of a map, as the house has it."""

import numpy as np

from agent.map_completion.network import WINDOW
from agent.planner import Planner
from agent.world import make_envs
from logic import House
from sim import HouseVectorEnv
from sim.backend import Lattice

UNKNOWN = 255
"""The type of a room that has none of those that are predicted."""

FLOOR, TARGET = 1, 2
"""Bits of a block: a target may lie there in some task, and in this one."""


class Truth:
    """The floor, the targets' places and the rooms of the houses that E environments are in, on their maps.

    What lies beyond half a torus from the start is not told apart from its other side.
    """

    def __init__(self, envs: HouseVectorEnv, types: tuple[str, ...]) -> None:
        """Of these environments' houses, with rooms of these types."""
        self.world = envs.unwrapped.world
        anywhere = make_envs(envs.unwrapped.houses, 1, "all", preset=envs.config)
        self.houses = [
            self._house(house, lattice, one.targets, other.targets, types)
            for house, lattice, one, other in zip(
                envs.unwrapped.houses,
                self.world.lattices,
                anywhere.unwrapped.world.places,
                self.world.places,
                strict=True,
            )
        ]
        self.pose = np.zeros((self.world.num_envs, 3))
        self.house = np.zeros(self.world.num_envs, int)

    @staticmethod
    def _house(
        house: House, lattice: Lattice, anywhere: np.ndarray, here: np.ndarray, types: tuple[str, ...]
    ) -> tuple[np.ndarray, ...]:
        """A house's lattice: its origin (2,), its blocks' bits (X, Y) uint8, their rooms' types (X, Y)."""
        bits, rooms = np.zeros(lattice.shape, np.uint8), np.full(lattice.shape, UNKNOWN, np.uint8)
        for places, bit in ((anywhere, FLOOR), (here, TARGET)):
            i, j = np.rint(places).astype(int).T
            bits[i, j] |= bit
        for room in sorted(house.rooms, key=lambda room: -room.area):
            if room.type in types:
                box = (np.reshape(room.box, (2, 2)) - lattice.origin) / lattice.pitch
                low, high = np.ceil(box[0]).clip(0).astype(int), np.floor(box[1]).astype(int) + 1
                rooms[low[0] : high[0], low[1] : high[1]] = types.index(room.type)
        return np.array(lattice.origin, float), bits, rooms

    def begin(self, begun: np.ndarray) -> None:
        """Maps begin where the bodies are now, in these environments (n,) int."""
        poses, _, houses = self.world.describe()
        self.pose[begun], self.house[begun] = poses[begun], houses[begun]

    def read(
        self, planner: Planner, environments: np.ndarray, corners: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """The bits (n, W, W) uint8 of these environments' windows with such corners, and the rooms' types."""
        bits = np.zeros((len(environments), WINDOW, WINDOW), np.uint8)
        rooms = np.full_like(bits, UNKNOWN)
        south, east = np.mgrid[:WINDOW, :WINDOW]
        for n, (e, corner) in enumerate(zip(environments, corners, strict=True)):
            origin, floor, types = self.houses[self.house[e]]
            # A map's axes are the walls', its east the one that the body began along, or next to clockwise.
            quarter = round(float(self.pose[e, 2]) / (np.pi / 4)) // 2 % 4
            (x, y), (u, v) = QUARTERS[quarter], QUARTERS[quarter - 1]
            ways = (
                x * (east + corner[1]) + u * (south + corner[0]),
                y * (east + corner[1]) + v * (south + corner[0]),
            )
            metres = self.pose[e, :2, None, None] + 2 * planner.cell * np.stack(ways)
            i, j = np.rint((metres - origin[:, None, None]) / self.world.config.step).astype(int)
            inside = (i >= 0) & (i < floor.shape[0]) & (j >= 0) & (j < floor.shape[1])
            bits[n, inside], rooms[n, inside] = floor[i[inside], j[inside]], types[i[inside], j[inside]]
        return bits, rooms


QUARTERS = (1, 0), (0, -1), (-1, 0), (0, 1)
"""East and south of a house that headings lead to, by quarters of a turn; a map's south is the one before."""
