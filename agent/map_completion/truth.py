"""What there is to predict: of each block of a map, as the house has it."""

import numpy as np

from agent.map_completion.network import WINDOW
from agent.planner import Planner
from agent.world import make_envs
from sim import HouseVectorEnv

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
    def _house(house, lattice, anywhere, here, types: tuple[str, ...]) -> tuple[np.ndarray, ...]:
        """A house's lattice: its origin (2,), its blocks' bits (X, Y) uint8, their rooms' types (X, Y)."""
        bits, rooms = np.zeros(lattice.shape, np.uint8), np.full(lattice.shape, UNKNOWN, np.uint8)
        for places, bit in ((anywhere, FLOOR), (here, TARGET)):
            i, j = np.rint(places).astype(int).T
            bits[i, j] |= bit
        for room in sorted(house.rooms, key=lambda room: -room.area):
            if room.type in types:
                west, north, east, south = (np.array(room.box) - [*lattice.origin, *lattice.origin]) / lattice.pitch
                i, j = (slice(max(0, int(np.ceil(a))), int(b) + 1) for a, b in ((west, east), (north, south)))
                rooms[i, j] = types.index(room.type)
        return np.array(lattice.origin, float), bits, rooms

    def begin(self, begun: np.ndarray) -> None:
        """Maps begin where the bodies are now, in these environments (n,) int."""
        poses, _, houses = self.world.describe()
        self.pose[begun], self.house[begun] = poses[begun], houses[begun]

    def read(self, planner: Planner, environments: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The bits (n, W, W) uint8 of these environments' windows with such corners, and the rooms' types."""
        block, pitch = 2 * planner.cell, self.world.config.step
        axis = block * np.arange(WINDOW)
        bits = np.zeros((len(environments), WINDOW, WINDOW), np.uint8)
        rooms = np.full_like(bits, UNKNOWN)
        for n, (e, corner) in enumerate(zip(environments, corners, strict=True)):
            origin, floor, types = self.houses[self.house[e]]
            x, y, heading = self.pose[e]
            # A map's axes are the walls', its east the one that the body began along, or next to clockwise.
            quarter = round(float(heading) / (np.pi / 4)) // 2 % 4
            east, south = ((1, 0), (0, -1), (-1, 0), (0, 1))[quarter], ((0, 1), (1, 0), (0, -1), (-1, 0))[quarter]
            along, down = axis + block * corner[1], axis + block * corner[0]
            # One of the two axes of a map is each axis of the house.
            for k, (bound, start) in enumerate(zip(floor.shape, (x, y), strict=True)):
                way = along * east[k] if east[k] else down * south[k]
                at = np.rint((start + way - origin[k]) / pitch).astype(int)
                if k == 0:
                    i, i_in = np.clip(at, 0, bound - 1), (at >= 0) & (at < bound)
                else:
                    j, j_in = np.clip(at, 0, bound - 1), (at >= 0) & (at < bound)
            if east[0]:
                inside = j_in[:, None] & i_in[None]
                bits[n] = np.where(inside, floor[i[None], j[:, None]], 0)
                rooms[n] = np.where(inside, types[i[None], j[:, None]], UNKNOWN)
            else:
                inside = i_in[:, None] & j_in[None]
                bits[n] = np.where(inside, floor[i[:, None], j[None]], 0)
                rooms[n] = np.where(inside, types[i[:, None], j[None]], UNKNOWN)
        return bits, rooms
