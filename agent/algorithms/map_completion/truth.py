"""Labels of map completion: properties of each block of a map in the true house."""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import convolve1d

from vitruvius.agent.algorithms.map_completion.network import WINDOW
from vitruvius.agent.learning.environments import make_envs
from vitruvius.agent.planner.core.frame import metres, quarters
from vitruvius.logic import House
from vitruvius.sim import HouseVectorEnv
from vitruvius.sim.backends.backend import Lattice
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.tasks.places import Places

GROUND = "outside", "wall", "door"
"""Kinds of ground in every house; the types of rooms and the kinds of furniture follow them."""

UNKNOWN = 255
"""Kind of ground that is not predicted."""


class Blocks(NamedTuple):
    """Labels of n windows, or of a house's lattice."""

    floor: np.ndarray
    """(n, W, W) uint8: 1 if a target may lie in the block in some task."""

    solid: np.ndarray
    """(n, W, W) uint8: 1 if a wall runs through the block or furniture stands on its middle."""

    target: np.ndarray
    """(n, W, W) float32: probability that the next target lies in the block, without regard to the last
    target."""

    kinds: np.ndarray
    """(n, W, W) uint8: kind of ground."""


class Truth:
    """Floor, target places and rooms of the true houses of E environments, on the environments' maps.

    Places farther than half a torus from the start coincide with places on its other side.
    """

    def __init__(self, envs: HouseVectorEnv, kinds: tuple[str, ...], cell: float) -> None:
        """Read the houses of these environments, with rooms and furniture of these ``kinds``.

        ``cell`` is the side of the maps' cells, metres.
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
        """Return the first place of a house's lattice, metres, and the blocks about its places (X, Y).

        The lattice includes a margin around the house.
        """
        # A block reaches a cell to each side of its node, so outer walls lie in blocks about places outside.
        about = round(self.cell / lattice.pitch)
        north_west = np.array(lattice.origin, float) - about * lattice.pitch
        wide, high = (along + 2 * about for along in lattice.shape)
        lattice = Lattice(north_west, lattice.pitch, (wide, high))
        floor, target = np.zeros(lattice.shape, np.uint8), np.zeros(lattice.shape, np.float32)
        floor[tuple(np.rint(anywhere.targets).astype(int).T + about)] = 1
        listed = np.rint(here.listed).astype(int) + about
        np.add.at(target, tuple(listed.T), 1 / len(listed))
        # Places on a block's edge count half.
        weights = np.array([0.5, *[1.0] * (2 * about - 1), 0.5])
        for axis in range(2):
            target = convolve1d(target, weights, axis=axis, mode="constant")
        ground = _ground(house, lattice, kinds, about)
        return north_west, Blocks(floor, _solid(shape, lattice, about), target, ground)

    def begin(self, begun: np.ndarray) -> None:
        """Let maps begin where the bodies are now, in these environments (n,) int."""
        poses, _, houses = self.world.describe()
        self.pose[begun], self.house[begun] = poses[begun], houses[begun]

    def read(self, environments: np.ndarray, corners: np.ndarray) -> Blocks:
        """Return the blocks of these environments' windows with these corners."""
        shape = len(environments), WINDOW, WINDOW
        found = Blocks(*(np.zeros(shape, each) for each in (np.uint8, np.uint8, np.float32, np.uint8)))
        along = np.arange(WINDOW)[:, None] * np.eye(2)[:, None]
        for n, (e, corner) in enumerate(zip(environments, corners, strict=True)):
            origin, house = self.houses[self.house[e]]
            # A map's axes are the house's: the blocks of a column share one x or one y, as do those of a row.
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
    """Return a mask (X, Y) uint8 of the places whose block has a wall or furniture.

    A wall counts if it runs through the block, which reaches ``about`` steps to each side of the place.
    Furniture counts if it stands on the place.
    """
    solid, half = np.zeros(lattice.shape, np.uint8), about * lattice.pitch
    east, south = (lattice.origin[axis] + lattice.pitch * np.arange(lattice.shape[axis]) for axis in range(2))
    for x, y, wide, high in shape.solids:
        solid[np.ix_(np.abs(east - x) <= max(wide, half), np.abs(south - y) <= max(high, half))] = 1
    return solid


def _ground(house: House, lattice: Lattice, kinds: tuple[str, ...], about: int) -> np.ndarray:
    """Return the kinds of ground about a lattice's places (X, Y) uint8.

    A kind is an index in ``GROUND``, then ``kinds``. Walls, which have no thickness, are the places up to
    ``about`` steps from them, and doors are, too.
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
