"""Doors that are closed when an episode begins, and that a body opens by walking against them.

Doors are independent of the backend, in whose houses all doorways are open. A closed door is a segment across
its doorway that blocks bodies and rays. So every backend supports doors without any code for them.

    doorways  rows of a house | for each house its doors: west, north, east, south, metres; NaN for none
    pushes    for each environment the number of steps that a body has pushed each door of its house
"""

from collections.abc import Sequence

import numpy as np

from vitruvius.sim.backends.backend import DOOR, TARGET
from vitruvius.sim.backends.body import Body, slides_into
from vitruvius.sim.backends.rays import MARGIN, OVERLAP, Rays, overlap
from vitruvius.sim.config import Config
from vitruvius.sim.geometry import Geometry
from vitruvius.sim.runtime import Array, ti


def doorways(shapes: Sequence[Geometry]) -> np.ndarray:
    """Return the doors of houses for kernels, (1 + 4 H D,) float32.

    The first number is D, the largest number of doors of a house, at least 1.
    """
    most = max(1, *(len(shape.doors) for shape in shapes))
    rows = np.full((len(shapes), most, 4), np.nan)
    for k, shape in enumerate(shapes):
        middle, half = shape.doors[:, :2], shape.doors[:, 2:]
        corners = np.hstack([middle - half, middle + half])
        wider = (overlap(corners.reshape(-1, 4)) - OVERLAP)[:, None] * (half > 0)
        rows[k, : len(middle)] = corners + np.hstack([-wider, wider])
    return np.concatenate([[most], rows.ravel()]).astype(np.float32)


def door_arrays(config: Config, shapes: Sequence[Geometry], num_envs: int) -> dict[str, Array]:
    """Return a world's arrays of doors; without closed doors, kernels do not read these arrays."""
    rows = doorways(shapes) if config.closed_doors else np.ones(1, np.float32)
    return {"doorways": Array.of(rows), "pushes": Array(ti.u8, num_envs * int(rows[0]))}


@ti.data_oriented
class Doors:
    """Doors for the poses and rays of a configuration.

    A door is its number in its house. ``doors`` is a record of kernels' arrays that has ``doorways`` and
    ``pushes``.
    """

    def __init__(self, config: Config, body: Body, lanes: int) -> None:
        """Prepare to cast ``lanes`` rays at a time."""
        self.body, self.steps = body, config.closed_doors
        self.rays = Rays(config, lanes)

    @ti.func
    def count(self, doors: ti.template()):
        """Return the number of doors that the arrays have for each house and environment."""
        return ti.cast(doors.doorways[0], ti.i32)

    @ti.func
    def segment(self, doors: ti.template(), house, door):
        """Return a door (west, north, east, south)."""
        at = 1 + 4 * (house * self.count(doors) + door)
        return ti.Vector([doors.doorways[at + k] for k in range(4)])

    @ti.func
    def left(self, doors: ti.template(), e, door):
        """Return the number of steps (i32) that a body must still push a door to open it."""
        pushed = ti.cast(doors.pushes[e * self.count(doors) + door], ti.i32)
        return ti.max(0, ti.static(self.steps) - pushed)

    @ti.func
    def meets(self, doors: ti.template(), house, door, origin, cell, new):
        """Return 1 if a body that moves between two cells meets a door.

        If both cells are one: if it is in the door.
        """
        p, q = self.body.centre(origin, cell), self.body.centre(origin, new)
        return slides_into(self.segment(doors, house, door), p, q, self.body.half(new))

    @ti.func
    def ahead(self, doors: ti.template(), e, house, origin, cell):
        """Return the first closed door that a step forward meets, or -1."""
        found, new = -1, self.body.ahead(cell)
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            if found < 0 and self.left(doors, e, door) > 0:  # noqa: SIM102 - ``and`` computes both sides
                if self.meets(doors, house, door, origin, cell, new):
                    found = door
        return found

    @ti.func
    def cost(self, doors: ti.template(), e, house, origin, cell):
        """Return the number of steps (i32) that push closed doors before a step forward enters them."""
        cost, new = 0, self.body.ahead(cell)
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            left = self.left(doors, e, door)
            if left > 0:
                enters = self.meets(doors, house, door, origin, cell, new)
                cost += left * (enters & 1 - self.meets(doors, house, door, origin, cell, cell))
        return cost

    @ti.func
    def near(self, doors: ti.template(), house, origin, cell):
        """Return True if a step from a cell, at some heading, may meet a door, open or not."""
        p, found = self.body.centre(origin, cell), False
        half = self.body.half(cell) + ti.static(self.body.step + MARGIN)
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            found |= slides_into(self.segment(doors, house, door), p, p, half) != 0
        return found

    @ti.func
    def push(self, doors: ti.template(), e, door):
        """Push a closed door for one step."""
        at = e * self.count(doors) + door
        doors.pushes[at] = ti.cast(ti.cast(doors.pushes[at], ti.i32) + 1, ti.u8)

    @ti.func
    def close(self, doors: ti.template(), e, house, origin, cell):
        """Close all doors except those that the body is in."""
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            inside = self.meets(doors, house, door, origin, cell, cell)
            steps = ti.select(inside, ti.static(self.steps), 0)
            doors.pushes[e * self.count(doors) + door] = ti.cast(steps, ti.u8)

    @ti.func
    def hide(
        self, doors: ti.template(), e, house, origin, cell, ray, distance: ti.template(), kind: ti.template()
    ):
        """Shorten the rays, from number ``ray`` on, that end behind closed doors.

        Of hits at the same distance, walls and furniture come before a door, and a door before the target.
        """
        eye, first = self.body.eye(origin, cell), self.rays.first(cell[2], ray)
        over, slope = self.rays.floats(0.0), self.rays.floats(0.0)
        for axis in ti.static(range(2)):
            self.rays.across(first, axis, over, slope)
            for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
                line = self.segment(doors, house, door)
                if self.left(doors, e, door) > 0 and line[axis] == line[axis + 2]:
                    low, high = line[1 - axis], line[3 - axis]
                    ahead, aside = line[axis] - eye[axis], 0.5 * (low + high) - eye[1 - axis]
                    half = 0.5 * (high - low) + ti.static(OVERLAP)
                    for r in range(ti.static(self.rays.lanes)):
                        far = ahead * over[r]
                        nearer = (far < distance[r]) | ((far == distance[r]) & (kind[r] == ti.static(TARGET)))
                        hit = (ti.abs(ahead * slope[r] - aside) <= half) & (far >= 0) & nearer
                        distance[r] = ti.select(hit, far, distance[r])
                        kind[r] = ti.select(hit, ti.u32(ti.static(DOOR)), kind[r])
