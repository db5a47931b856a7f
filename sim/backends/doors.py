"""Doors that are closed when an episode begins, and that a body opens by walking at them.

They lie over a backend's house, in which all doorways are open: a closed door is a segment across its doorway
that bodies meet and rays end on. So every backend has them, and none knows of them.

    doorways  rows of a house | for each house its doors: west, north, east, south, metres; NaN for none
    pushes    for each environment how many steps a body has walked at each door of its house
"""

from collections.abc import Sequence

import numpy as np

from sim.backends.backend import DOOR, TARGET
from sim.backends.body import Body, slides_into
from sim.backends.rays import MARGIN, OVERLAP, Rays, overlap
from sim.config import Config
from sim.geometry import Geometry
from sim.runtime import Array, ti


def doorways(shapes: Sequence[Geometry]) -> np.ndarray:
    """The doors of houses as kernels read them, (1 + 4 H D,) float32, with the greatest number D of doors of
    a house, at least 1, first.
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
    """A world's arrays of doors; of a configuration without closed doors, arrays that nothing reads."""
    rows = doorways(shapes) if config.closed_doors else np.ones(1, np.float32)
    return {"doorways": Array.of(rows), "pushes": Array(ti.u8, num_envs * int(rows[0]))}


@ti.data_oriented
class Doors:
    """Doors among the poses and the rays of a configuration. A door is its number in its house; ``doors`` is
    a record of kernels' arrays that has ``doorways`` and ``pushes``.
    """

    def __init__(self, config: Config, body: Body, lanes: int) -> None:
        """Cast ``lanes`` rays at a time."""
        self.body, self.steps = body, config.closed_doors
        self.rays = Rays(config, lanes)

    @ti.func
    def count(self, doors: ti.template()):
        """How many doors the arrays keep for each house and environment."""
        return ti.cast(doors.doorways[0], ti.i32)

    @ti.func
    def segment(self, doors: ti.template(), house, door):
        """A door (west, north, east, south)."""
        at = 1 + 4 * (house * self.count(doors) + door)
        return ti.Vector([doors.doorways[at + k] for k in range(4)])

    @ti.func
    def left(self, doors: ti.template(), e, door):
        """How many steps must still be walked at a door until it is open (i32)."""
        pushed = ti.cast(doors.pushes[e * self.count(doors) + door], ti.i32)
        return ti.max(0, ti.static(self.steps) - pushed)

    @ti.func
    def meets(self, doors: ti.template(), house, door, origin, cell, new):
        """Whether a body that goes from a cell to another meets a door, or where both are one, is in it."""
        p, q = self.body.centre(origin, cell), self.body.centre(origin, new)
        return slides_into(self.segment(doors, house, door), p, q, self.body.half(new))

    @ti.func
    def ahead(self, doors: ti.template(), e, house, origin, cell):
        """The first closed door that a step forward meets, -1 for none."""
        found, new = -1, self.body.ahead(cell)
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            if found < 0 and self.left(doors, e, door) > 0:  # noqa: SIM102 - ``and`` computes both sides
                if self.meets(doors, house, door, origin, cell, new):
                    found = door
        return found

    @ti.func
    def cost(self, doors: ti.template(), e, house, origin, cell):
        """How many steps must be walked at closed doors until a step forward enters their doorways (i32)."""
        cost, new = 0, self.body.ahead(cell)
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            left = self.left(doors, e, door)
            if left > 0:
                enters = self.meets(doors, house, door, origin, cell, new)
                cost += left * (enters & 1 - self.meets(doors, house, door, origin, cell, cell))
        return cost

    @ti.func
    def near(self, doors: ti.template(), house, origin, cell):
        """Whether a step from a cell, at some heading, may meet a door, open or not."""
        p, found = self.body.centre(origin, cell), False
        half = self.body.half(cell) + ti.static(self.body.step + MARGIN)
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            found |= slides_into(self.segment(doors, house, door), p, p, half) != 0
        return found

    @ti.func
    def push(self, doors: ti.template(), e, door):
        """Walk at a closed door for a step."""
        at = e * self.count(doors) + door
        doors.pushes[at] = ti.cast(ti.cast(doors.pushes[at], ti.i32) + 1, ti.u8)

    @ti.func
    def close(self, doors: ti.template(), e, house, origin, cell):
        """Close all doors but those that a body stands in."""
        for door in range(self.count(doors)):  # pyright: ignore[reportArgumentType]
            inside = self.meets(doors, house, door, origin, cell, cell)
            steps = ti.select(inside, ti.static(self.steps), 0)
            doors.pushes[e * self.count(doors) + door] = ti.cast(steps, ti.u8)

    @ti.func
    def hide(
        self, doors: ti.template(), e, house, origin, cell, ray, distance: ti.template(), kind: ti.template()
    ):
        """Shorten rays, from number ``ray`` on, that end behind closed doors. Of hits at one distance walls
        and pieces come before a door, and a door before the target.
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
