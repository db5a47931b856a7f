"""Doors that are closed when an episode begins, and that a body opens by walking against them.

Doors are independent of the backend, in whose houses all doorways are open. A closed door is a segment across
its doorway that blocks bodies and rays. So a backend of robots on a lattice supports doors
without any code for them; ``free`` refuses them. Doors are an overlay: see ``sim.backends.overlay``.
"""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np

from vitruvius.sim.actions import FORWARD
from vitruvius.sim.arrays import ArrayRow
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


@ti.data_oriented
class Doors:
    """Doors for the poses and rays of a configuration: an ``Overlay``.

    Functions take a door as its number in its house. ``doors`` is a record of arrays that has ``ROWS``.
    """

    ROWS: ClassVar[tuple[ArrayRow, ...]] = (
        ArrayRow(
            "doorways", ti.f32, ("n",), unit="m",
            meaning="largest number of doors of a house, at least 1; then this number of boxes for each "
            "house (west, north, east, south), NaN where it has fewer doors",
            written="packing", read="doors",
        ),
        ArrayRow(
            "pushes", ti.u8, ("n",), unit="steps",
            meaning="steps for which the body has pushed each door of its house, by environment",
            written="reset, step", read="doors", saved=True,
        ),
    )  # fmt: skip

    KIND: ClassVar[int] = DOOR
    COLUMN: ClassVar[str] = "is door"

    def __init__(self, config: Config, body: Body, lanes: int) -> None:
        """Prepare to cast ``lanes`` rays at a time."""
        self.body, self.steps = body, config.closed_doors
        self.rays = Rays(config, lanes)

    @staticmethod
    def asked(config: Config) -> bool:
        """Return True if doors are closed at first: see ``Overlay``."""
        return config.closed_doors > 0

    @staticmethod
    def check(knows_distance: bool) -> None:
        """Raise ``ValueError`` for distances, which are of open doors: see ``Overlay``."""
        if knows_distance:
            raise ValueError(
                "the distance to the target needs open doors: for closed doors use vitruvius.sim.Oracle"
            )

    @staticmethod
    def arrays(shapes: Sequence[Geometry], num_envs: int) -> dict[str, Array]:
        """Return the arrays of doors: see ``Overlay``."""
        rows = doorways(shapes)
        return {"doorways": Array.of(rows), "pushes": Array(ti.u8, num_envs * int(rows[0]))}

    @ti.func
    def begin(self, world: ti.template(), e, state):
        """Close all doors except those that the body is in: see ``Overlay``."""
        for door in range(self.count(world)):  # pyright: ignore[reportArgumentType]
            inside = self.meets(world, state.house, door, state.origin, state.cell, state.cell)
            steps = ti.select(inside, ti.static(self.steps), 0)
            world.pushes[e * self.count(world) + door] = ti.cast(steps, ti.u8)

    @ti.func
    def cut(self, world: ti.template(), e, state, action, moved, blocked):
        """Return the move, ``blocked`` if a closed door is in the way, and that door: see ``Overlay``."""
        door = -1
        if action == FORWARD:
            door = self.ahead(world, e, state.house, state.origin, state.cell)
            blocked |= ti.cast(door >= 0, ti.i32)
        return moved, blocked, door

    @ti.func
    def advance(self, world: ti.template(), e, state, met):
        """Push the closed door ``met`` for one step: see ``Overlay``."""
        if met >= 0:
            at = e * self.count(world) + met
            world.pushes[at] = ti.cast(ti.cast(world.pushes[at], ti.i32) + 1, ti.u8)

    @staticmethod
    def drawn(config: Config, arrays: Mapping[str, np.ndarray], shape: Geometry, e: int) -> np.ndarray:
        """Return the closed doors: see ``Overlay``."""
        first = e * int(arrays["doorways"][0])
        closed = arrays["pushes"][first : first + len(shape.doors)] < config.closed_doors
        middle, half = shape.doors[closed, :2], shape.doors[closed, 2:]
        return np.hstack([middle - half, middle + half])

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
    def hide(self, world: ti.template(), e, state, ray, distance: ti.template(), kind: ti.template()):
        """Shorten the rays, from number ``ray`` on, that end behind closed doors: see ``Overlay``.

        Of hits at the same distance, walls and furniture come before a door, and a door before the target.
        """
        eye, first = self.body.eye(state.origin, state.cell), self.rays.first(state.cell[2], ray)
        over, slope = self.rays.floats(0.0), self.rays.floats(0.0)
        for axis in ti.static(range(2)):
            self.rays.across(first, axis, over, slope)
            for door in range(self.count(world)):  # pyright: ignore[reportArgumentType]
                line = self.segment(world, state.house, door)
                if self.left(world, e, door) > 0 and line[axis] == line[axis + 2]:
                    low, high = line[1 - axis], line[3 - axis]
                    ahead, aside = line[axis] - eye[axis], 0.5 * (low + high) - eye[1 - axis]
                    half = 0.5 * (high - low) + ti.static(OVERLAP)
                    for r in range(ti.static(self.rays.lanes)):
                        far = ahead * over[r]
                        nearer = (far < distance[r]) | ((far == distance[r]) & (kind[r] == ti.static(TARGET)))
                        hit = (ti.abs(ahead * slope[r] - aside) <= half) & (far >= 0) & nearer
                        distance[r] = ti.select(hit, far, distance[r])
                        kind[r] = ti.select(hit, ti.u32(ti.static(DOOR)), kind[r])
