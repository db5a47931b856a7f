"""What there is to predict: of each block of a map, as the house has it."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import convolve1d

from agent.algorithms.map_completion.network import WINDOW
from agent.learning.environments import make_envs
from agent.planner.frame import metres, quarters
from logic import House
from sim import HouseVectorEnv
from sim.backends.backend import Lattice
from sim.geometry import Geometry
from sim.tasks.places import Places

GROUND = "outside", "wall", "door"
"""Kinds of ground that every house has; after these come the types of rooms, and the kinds of pieces."""

UNKNOWN = 255
"""Ground of a kind that is none of those that are predicted."""


class Blocks(NamedTuple):
    """Of n windows, or of a house's lattice."""

    floor: np.ndarray
    """(n, W, W) uint8, 1 where a target may lie in some task."""

    solid: np.ndarray
    """(n, W, W) uint8, 1 where a wall runs through a block, or furniture stands on its middle."""

    target: np.ndarray
    """(n, W, W) float32: the probability that the next target lies in a block, the last one left aside."""

    kinds: np.ndarray
    """(n, W, W) uint8: the kind of ground."""


class Truth:
    """The floor, the targets' places and the rooms of the houses that E environments are in, on their maps.

    What lies beyond half a torus from the start is not told apart from its other side.
    """

    def __init__(self, envs: HouseVectorEnv, kinds: tuple[str, ...], cell: float) -> None:
        """Of these environments' houses, with rooms and pieces of these ``kinds``; ``cell`` is that of the
        maps, metres.
        """
        self.world, self.cell = envs.unwrapped.world, cell
        anywhere = make_envs(envs.unwrapped.houses, 1, "all", preset=envs.config)
        self.houses = [
            self._house(house, shape, lattice, one, other, kinds)
            for house, shape, lattice, one, other in zip(
                envs.unwrapped.houses,
                self.world.bank.geometries,
                self.world.lattices,
                anywhere.unwrapped.world.places,
                self.world.places,
                strict=True,
            )
        ]
        self.pose = np.zeros((self.world.num_envs, 3))
        self.house = np.zeros(self.world.num_envs, int)

    def _house(
        self,
        house: House,
        shape: Geometry,
        lattice: Lattice,
        anywhere: Places,
        here: Places,
        kinds: tuple[str, ...],
    ) -> tuple[np.ndarray, Blocks]:
        """The blocks about the places of a house's lattice and of what lies around it (X, Y): the first
        place, metres, and what is so.
        """
        # A block reaches a cell to each side of its node: the outer walls are in blocks about places outside.
        about = round(self.cell / lattice.pitch)
        north_west = np.array(lattice.origin, float) - about * lattice.pitch
        wide, high = (along + 2 * about for along in lattice.shape)
        lattice = Lattice(north_west, lattice.pitch, (wide, high))
        floor, target = np.zeros(lattice.shape, np.uint8), np.zeros(lattice.shape, np.float32)
        floor[tuple(np.rint(anywhere.targets).astype(int).T + about)] = 1
        listed = np.rint(here.listed).astype(int) + about
        np.add.at(target, tuple(listed.T), 1 / len(listed))
        # Places on a block's edge are half in it.
        weights = np.array([0.5, *[1.0] * (2 * about - 1), 0.5])
        for axis in range(2):
            target = convolve1d(target, weights, axis=axis, mode="constant")
        ground = _ground(house, lattice, kinds, about)
        return north_west, Blocks(floor, _solid(shape, lattice, about), target, ground)

    def begin(self, begun: np.ndarray) -> None:
        """Maps begin where the bodies are now, in these environments (n,) int."""
        poses, _, houses = self.world.describe()
        self.pose[begun], self.house[begun] = poses[begun], houses[begun]

    def read(self, environments: np.ndarray, corners: np.ndarray) -> Blocks:
        """The blocks of these environments' windows with such corners."""
        shape = len(environments), WINDOW, WINDOW
        found = Blocks(*(np.zeros(shape, each) for each in (np.uint8, np.uint8, np.float32, np.uint8)))
        along = np.arange(WINDOW)[:, None] * np.eye(2)[:, None]
        for n, (e, corner) in enumerate(zip(environments, corners, strict=True)):
            origin, house = self.houses[self.house[e]]
            # A map's axes are the house's: all blocks of a column have one x or one y, and those of a row.
            places = metres(self.pose[e], along + corner[::-1], 2 * self.cell) - origin
            turned = quarters(self.pose[e, 2]) % 2
            lines = np.stack([places[turned, :, 0], places[1 - turned, :, 1]])
            lines = np.rint(lines / self.world.config.step).astype(int)
            inside = (lines >= 0) & (lines < np.array(house.floor.shape)[:, None])
            there = np.ix_(*(line[kept] for line, kept in zip(lines, inside, strict=True)))
            for field, whole in zip(found, house, strict=True):
                (field[n] if turned else field[n].T)[np.ix_(*inside)] = whole[there]
        return found


def _solid(shape: Geometry, lattice: Lattice, about: int) -> np.ndarray:
    """Where a wall runs through a block about a lattice's place (X, Y) uint8, which reaches so many steps to
    each side, or furniture stands on the place.
    """
    solid, half = np.zeros(lattice.shape, np.uint8), about * lattice.pitch
    east, south = (lattice.origin[axis] + lattice.pitch * np.arange(lattice.shape[axis]) for axis in range(2))
    for x, y, wide, high in shape.solids:
        solid[np.ix_(np.abs(east - x) <= max(wide, half), np.abs(south - y) <= max(high, half))] = 1
    return solid


def _ground(house: House, lattice: Lattice, kinds: tuple[str, ...], about: int) -> np.ndarray:
    """The kinds of ground about a lattice's places (X, Y) uint8: numbers in ``GROUND``, then ``kinds``.
    Walls, which have no thickness, are the places up to ``about`` steps from them, and doors too.
    """
    ground, names = np.zeros(lattice.shape, np.uint8), (*GROUND, *kinds)

    def fill(box: tuple[float, float, float, float], name: str, margin: float = 0.0) -> None:
        low, high = (np.reshape(box, (2, 2)) - lattice.origin) / lattice.pitch
        low, high = np.ceil(low - margin).astype(int).clip(0), np.floor(high + margin).astype(int) + 1
        ground[low[0] : max(0, high[0]), low[1] : max(0, high[1])] = (
            names.index(name) if name in names else UNKNOWN
        )

    rooms = sorted(house.rooms, key=lambda room: -room.area)
    for room in rooms:
        fill(room.box, room.type)
    for room in rooms:
        west, north, east, south = room.box
        for wall in (
            *((west, north, east, north), (west, south, east, south)),
            *((west, north, west, south), (east, north, east, south)),
        ):
            fill(wall, "wall", about)
    for door in house.doors:
        fill(door.box, "door", about)
    for room in rooms:
        for piece in room.pieces:
            fill(piece.box, piece.type)
    return ground
