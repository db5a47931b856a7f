"""Motion in the grid backend: table look-ups of a body's cell."""

import numpy as np

from vitruvius.sim.actions import FORWARD
from vitruvius.sim.backends.backend import Bank, Lattice
from vitruvius.sim.backends.body import Body, eighths
from vitruvius.sim.backends.grid.cells import STANDS, middle
from vitruvius.sim.backends.grid.pack import COLUMNS, FIRST_CELL, HEADER, ROWS
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import ti

CENTRED = 1e-3
"""Largest distance of a given pose from the middle of a cell, in metres."""


@ti.func
def looked_up(indices: ti.template(), house, cell):
    """Return the table entry of a cell; 0 outside the house."""
    header = house * HEADER
    columns, rows, known = indices[header + COLUMNS], indices[header + ROWS], 0
    if 0 <= cell[0] < columns and 0 <= cell[1] < rows:
        known = indices[indices[header + FIRST_CELL] + cell[1] * columns + cell[0]]
    return known


@ti.data_oriented
class Motion:
    """A body that is one cell wide and moves from cell to cell."""

    config: Config
    body: Body

    def lattice(self, shape: Geometry, origin: np.ndarray | None = None) -> Lattice:
        """Return the lattice of the middles of a house's cells."""
        west, north, east, south = shape.bounds
        side = self.config.step
        size = round((east - west) / side), round((south - north) / side)
        return Lattice(middle(shape, side), side, size)

    def place(self, bank: Bank, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the cells of the given poses.

        Raises ``ValueError`` for a pose that is not in the middle of a cell.
        """
        heading = eighths(pose)
        origin = np.stack([self.lattice(bank.geometries[number]).origin for number in house])
        steps = (pose[:, :2] - origin) / self.config.step
        off = np.abs(steps - np.round(steps)).max(axis=1) * self.config.step
        if off.max() > CENTRED:
            e = int(off.argmax())
            x, y = (origin[e] + np.round(steps[e]) * self.config.step).tolist()
            raise ValueError(
                f"pose {e} is not at the centre of a cell: the nearest centre is ({x:.3f}, {y:.3f}) m"
            )
        return origin, np.column_stack([np.round(steps), heading % 8]).astype(np.int32)

    @ti.func
    def stands(self, numbers: ti.template(), indices: ti.template(), house, origin, cell):
        """Return 1 if a body can be at a cell: see ``Backend.stands``."""
        return looked_up(indices, house, cell) >> STANDS & 1

    @ti.func
    def move(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, action):
        """Return the cell after an action, and ``blocked``: see ``Backend.move``."""
        new, blocked = cell, 0
        if action == FORWARD:
            new = self.body.ahead(cell)
            blocked = 1 - (looked_up(indices, house, cell) >> cell[2] & 1)
        else:
            new = self.body.turned(cell, action)
        return new, blocked
