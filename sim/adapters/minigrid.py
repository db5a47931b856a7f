"""Houses on a grid as environments of MiniGrid (minigrid.farama.org), ``vitruvius:Vitruvius/MiniGrid-v0``.

This module needs the extra ``minigrid``. In MiniGrid, walls fill tiles; in our houses,
walls lie on the edges of cells. So a house of C x R cells has 2C + 1 by 2R + 1 tiles. There is a tile for
each cell, and a tile between two cells for the edge or the corner where they meet. A step on our grid is two
steps in MiniGrid; distances are otherwise the same.
"""

import zlib
from typing import Any

import numpy as np
from minigrid.core.grid import Grid
from minigrid.core.mission import MissionSpace
from minigrid.core.world_object import Box, Door, Goal, Wall, WorldObj
from minigrid.minigrid_env import MiniGridEnv

from vitruvius.logic import House
from vitruvius.sim.backends.backend import PIECE, WALL
from vitruvius.sim.backends.grid.cells import Cells
from vitruvius.sim.environment.arguments import Houses
from vitruvius.sim.environment.specs import KeepsSpec
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.geometry import shut
from vitruvius.sim.tasks.tasks import Targets

MISSION = "get to the green goal square"
"""Mission text that MiniGrid uses for this task."""

FREE, DOOR, ENTRANCE, FILLED, SOLID = range(5)
"""Contents of a tile: nothing, a door between rooms, a door to the outside, furniture, a wall."""

PIECE_COLOURS = "blue", "purple", "red"
"""Colours of furniture. MiniGrid has six colours: its walls are grey, its goal is green, and doors here are
yellow."""


Tile = tuple[int, int]
"""Position of a tile: east and south from the north-west corner of the grid."""


class PieceTile(WorldObj):
    """Tile of furniture: a box of MiniGrid that agents cannot open or carry."""

    def __init__(self, colour: str) -> None:
        """Create a tile with a colour of MiniGrid."""
        super().__init__("box", colour)

    def see_behind(self) -> bool:
        """Return False: furniture hides what is behind it, as for our rays."""
        return False

    def render(self, r: np.ndarray) -> np.ndarray:
        """Draw a box on a tile's pixels and return them."""
        Box(self.color).render(r)
        return r


class MiniGridHouseEnv(KeepsSpec, MiniGridEnv):  # pyright: ignore[reportIncompatibleVariableOverride]
    """Environment in which an agent of MiniGrid looks for a target in a house.

    An episode has the house, the start and the first target of ``HouseEnv`` with ``backend="grid"`` and the
    same seed. A heading between two axes is turned right to the next axis. Everything else is MiniGrid's:
    actions, view of tiles, reward, and the end at the goal. Houses that are smaller than the largest one have
    walls around them.

    ``houses``: as for ``HouseVectorEnv``, generated with one ``--cell``. ``targets``: as for
    ``HouseVectorEnv``. ``doors_open``: True if doors between rooms are always open, as in our simulator.
    Otherwise they are shut, and MiniGrid's action ``toggle`` opens them. Doors to the outside are locked.
    ``max_steps``: length of an episode. ``arguments``: those of ``MiniGridEnv``. Raises ``ValueError`` for
    houses that do not fit a grid.
    """

    def __init__(
        self,
        houses: Houses,
        *,
        targets: Targets = "main",
        doors_open: bool = True,
        max_steps: int = 1500,
        **arguments: Any,
    ) -> None:
        self.envs = HouseVectorEnv(houses, backend="grid", targets=targets)
        self.doors_open, self.episode_steps, self._episode = doors_open, max_steps, {}
        self._cells = [Cells(shape, self.envs.config.step) for shape in self.envs.geometries]
        width, height = (2 * max(size) + 1 for size in zip(*(each.size for each in self._cells), strict=True))
        super().__init__(
            MissionSpace(mission_func=_mission), width=width, height=height, max_steps=max_steps, **arguments
        )

    def lengthen(self, steps: int) -> None:
        """Truncate episodes after ``steps``: see ``KeepsSpec``."""
        self.max_steps = self.episode_steps = steps

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode. ``options`` and the returned info are those of ``HouseEnv``."""
        batched = {key: np.asarray(value)[None] for key, value in (options or {}).items()}
        _, info = self.envs.reset(seed=seed, options=batched)
        self._episode = {key: value[0] for key, value in info.items()}
        observation, _ = super().reset(seed=seed)
        return observation, dict(self._episode)

    def close(self) -> None:
        """Close the environment; it cannot be reset afterwards."""
        self.envs.close()
        super().close()

    def _gen_grid(self, width: int, height: int) -> None:
        """Build the house of the episode: see ``MiniGridEnv``."""
        number = int(self._episode["house"])
        cells, house = self._cells[number], self.envs.houses[number]
        found, colours = tiles(house, cells), _colours(house, cells)
        self.grid = Grid(width, height)
        for x, y in np.ndindex(width, height):
            inside = x < found.shape[0] and y < found.shape[1]
            self.grid.set(x, y, self._object(int(found[x, y]), int(colours[x, y])) if inside else Wall())
        x, y, heading = self._episode["pose"]
        self.agent_pos = tile(cells, (x, y))
        self.agent_dir = -(round(heading / (np.pi / 4)) // 2) % 4
        goal = tile(cells, self._episode["target"])
        if found[goal] != FREE:
            x, y = self._episode["target"]
            raise ValueError(f"house {number}: the target at ({x:.3f}, {y:.3f}) m is not in a free cell")
        self.put_obj(Goal(), *goal)

    def _object(self, kind: int, colour: int) -> WorldObj | None:
        if kind == FREE:
            return None
        if kind == FILLED:
            return PieceTile(PIECE_COLOURS[colour])
        if kind == SOLID:
            return Wall()
        return Door("yellow", is_open=kind == DOOR and self.doors_open, is_locked=kind == ENTRANCE)


def tiles(house: House, cells: Cells) -> np.ndarray:
    """Return the contents of each tile of a house, (2 columns + 1, 2 rows + 1) int.

    Cell (i, j) is tile (2i + 1, 2j + 1). The tile of an edge is free if a body can cross the edge. The tile
    of a corner is free if all four edges around it are free.
    """
    columns, rows = cells.size
    found = np.full((2 * columns + 1, 2 * rows + 1), FREE)
    inner = np.full((columns + 2, rows + 2), SOLID)
    inner[1:-1, 1:-1] = np.select([cells.stands, cells.filled], [FREE, FILLED], SOLID)
    found[1::2, 1::2] = inner[1:-1, 1:-1]
    found[::2, 1::2] = _edges(cells.upright, inner[:-1, 1:-1], inner[1:, 1:-1])
    found[1::2, ::2] = _edges(cells.level, inner[1:-1, :-1], inner[1:-1, 1:])
    around = np.pad(found, 1)
    corners = (around[:-2:2, 1:-1:2], around[2::2, 1:-1:2], around[1:-1:2, :-2:2], around[1:-1:2, 2::2])
    found[::2, ::2] = np.max(corners, axis=0)
    for door in house.doors:
        if door.opening:
            continue
        west, north, east, south = _in_cells(cells, shut(house, door))
        # The whole door, except the corners at its ends, which belong to the wall.
        across = slice(2 * west + (west < east), 2 * east + (west == east))
        along = slice(2 * north + (north < south), 2 * south + (north == south))
        found[across, along] = ENTRANCE if door.is_entrance else DOOR
    return found


def _colours(house: House, cells: Cells) -> np.ndarray:
    """Return the index in ``PIECE_COLOURS`` for each tile, (2 columns + 1, 2 rows + 1) int.

    Furniture of one type always has the same colour.
    """
    columns, rows = cells.size
    found = np.zeros((2 * columns + 1, 2 * rows + 1), int)
    for room in house.rooms:
        for piece in room.pieces:
            west, north, east, south = _in_cells(cells, piece.box)
            colour = zlib.crc32(piece.type.encode()) % len(
                PIECE_COLOURS
            )  # not hash(), which differs by process
            found[2 * west : 2 * east + 1, 2 * north : 2 * south + 1] = colour
    return found


def _in_cells(cells: Cells, box: tuple[float, ...]) -> list[int]:
    """Return a box (west, north, east, south), metres, in cells."""
    return np.round((np.array(box) - np.tile(cells.corner, 2)) / cells.side).astype(int).tolist()


def tile(cells: Cells, place: Any) -> Tile:
    """Return the tile of a place (x, y) in a house, metres."""
    i, j = np.floor((np.asarray(place) - cells.corner) / cells.side).astype(int)
    return int(2 * i + 1), int(2 * j + 1)


def _edges(edge: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the contents of edge tiles from what is on the edges and in the cells on both sides."""
    worst = np.maximum(before, after)
    return np.select([edge == WALL, edge == PIECE], [SOLID, FILLED], worst)


def _mission() -> str:
    return MISSION
