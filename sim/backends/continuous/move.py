"""Motion in the continuous backend: boxes block a body that would touch them as it slides."""

import numpy as np

from vitruvius.sim.actions import FORWARD
from vitruvius.sim.backends.backend import Bank, Lattice, lattice_over
from vitruvius.sim.backends.blocks import HEADER, cell_of, end_of
from vitruvius.sim.backends.body import SKIN, Body, eighths, slides_into
from vitruvius.sim.backends.continuous.layout import BOXES, FIRST_BOX, FIRST_PIECE, FLOOR, ROOMS, listed
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import ti


@ti.data_oriented
class Motion:
    """A body among boxes, with the collision rule of the configuration."""

    config: Config
    body: Body

    def lattice(self, shape: Geometry, origin: np.ndarray | None = None) -> Lattice:
        """Return the lattice of places that steps lead to."""
        return lattice_over(shape, self.config.step, origin)

    def place(self, bank: Bank, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return origins and cells of the given poses. A heading must be a multiple of 45 degrees."""
        cell = np.zeros((len(pose), 3), np.int32)
        cell[:, 2] = eighths(pose).astype(np.int64) % 8
        shift = np.where(cell[:, 2] % 2, self.config.eye[1] - self.config.eye[0], 0.0)
        return np.ascontiguousarray(pose[:, :2] - shift[:, None], np.float32), cell

    @ti.func
    def stands(self, numbers: ti.template(), indices: ti.template(), house, origin, cell):
        """Return 1 if a body can be at a cell: see ``Backend.stands``."""
        return 1 - self.blocked(numbers, indices, house, origin, cell, cell, 1.0)

    @ti.func
    def move(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, action):
        """Return the cell after an action, and ``blocked``: see ``Backend.move``."""
        return self.move_with(numbers, indices, house, origin, cell, action, 1.0)

    @ti.func
    def move_with(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, action, width):
        """Return ``move`` for a body that has ``width`` times its usual width."""
        new, blocked = cell, 0
        if action == FORWARD:
            new = self.body.ahead(cell)
            blocked = self.blocked(numbers, indices, house, origin, cell, new, width)
        else:
            new = self.body.turned(cell, action)
            # A square of the same size at all headings always can turn.
            if ti.static(self.config.body[0] != self.config.body[1]):
                blocked = self.blocked(numbers, indices, house, origin, new, new, width)
        return new, blocked

    @ti.func
    def blocked(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, new, width):
        """Return 1 (i32) if something is in the way from a cell to a new one."""
        result = 0
        if ti.static(self.config.collision == "swept"):
            # The body's north-west corner stays in place during a turn, so the body may grow at both ends of
            # its path.
            half = width * self.body.half(new)
            p = self.body.centre(origin, cell) + (self.body.half(new) - self.body.half(cell))
            q = self.body.centre(origin, new)
            block, first_box = cell_of(numbers, indices, house, p), indices[house * HEADER + FIRST_BOX]
            for k in range(end_of(indices, block, 1)):
                result |= self.meets(numbers, first_box + 4 * listed(indices, block, k), p, q, half)
        else:
            result = self.original(
                numbers, indices, house, self.body.centre(origin, new), self.body.half(new)
            )
        return result

    @ti.func
    def meets(self, numbers: ti.template(), box, p, q, half):
        """Return 1 (i32) if a square that slides from p to q meets a box."""
        corners = ti.Vector([numbers[box], numbers[box + 1], numbers[box + 2], numbers[box + 3]])
        return slides_into(corners, p, q, half)

    @ti.func
    def original(self, numbers: ti.template(), indices: ti.template(), house, centre, half):
        """Return 1 if the original program's rule, with its gaps, forbids the new place.

        A body astride a room's boundary must be within the span of that room's door, whichever wall the door
        is in. A body inside a room must not meet furniture. A body that is inside no room, astride or not,
        must be inside the main room's rectangle. In our own files, rooms lie outside of that rectangle, so a
        body astride need not be in it.
        """
        header = house * HEADER
        floor = indices[header + FLOOR]
        met, inside, touched = 0, 0, 0
        for k in range(indices[header + ROOMS]):
            room = floor + 8 * (k + 1)
            door = room + 4
            x, y = ti.abs(centre[0] - numbers[room]), ti.abs(centre[1] - numbers[room + 1])
            width, height = numbers[room + 2], numbers[room + 3]
            if (x < width + half - ti.static(SKIN)) & (y < height + half - ti.static(SKIN)):
                touched = 1
                if (x <= width - half + ti.static(SKIN)) & (y <= height - half + ti.static(SKIN)):
                    inside = 1
                else:
                    along = centre[0] - numbers[door]
                    if numbers[door + 2] == 0:
                        along = centre[1] - numbers[door + 1]
                    span = ti.max(numbers[door + 2], numbers[door + 3])
                    met |= ti.cast(ti.abs(along) > span - half + ti.static(SKIN), ti.i32)
        if inside:
            piece, last = (
                indices[header + FIRST_PIECE],
                indices[header + FIRST_BOX] + 4 * indices[header + BOXES],
            )
            while piece < last:
                met |= self.meets(numbers, piece, centre, centre, half)
                piece += 4
        if not inside:
            area = floor + 4 * touched
            x, y = ti.abs(centre[0] - numbers[area]), ti.abs(centre[1] - numbers[area + 1])
            width, height = numbers[area + 2], numbers[area + 3]
            within = (x <= width - half + ti.static(SKIN)) & (y <= height - half + ti.static(SKIN))
            met |= ti.cast(not within, ti.i32)
        return met
