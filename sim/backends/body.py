"""A square body and its eye, at poses that are counted in steps and headings."""

import numpy as np

from vitruvius.sim.actions import HEADINGS, LEFT
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import constants, ti

SKIN = 1e-5
"""Depth of contact in metres. A body that reaches into something by less than this touches it: touching
blocks no move and picks up no target."""


@ti.func
def slides_into(box, p, q, half):
    """Return 1 (i32) if a square that slides from p to q meets a box (west, north, east, south).

    Three axes may separate the two: x, y, and the normal of the path. The result is the same, bit for bit,
    from p to q and from q to p, so that paths can be searched backwards.
    """
    west, north, east, south = box[0], box[1], box[2], box[3]
    x, y = 0.5 * (p[0] + q[0] - west - east), 0.5 * (p[1] + q[1] - north - south)
    dx, dy = ti.abs(q[0] - p[0]), ti.abs(q[1] - p[1])
    width = 0.5 * (east - west) + half - ti.static(SKIN)
    height = 0.5 * (south - north) + half - ti.static(SKIN)
    near = (ti.abs(x) < width + 0.5 * dx) & (ti.abs(y) < height + 0.5 * dy)
    across = ti.abs((q[0] - p[0]) * y - (q[1] - p[1]) * x) <= dx * height + dy * width
    return ti.cast(near & across, ti.i32)


def eighths(pose: np.ndarray) -> np.ndarray:
    """Return the headings of poses (E, 3) in eighths of a turn, (E,) float64.

    Raises ``ValueError`` for other headings, and for numbers that are not finite.
    """
    turns = pose[:, 2] / (np.pi / 4)
    if not np.isfinite(pose).all() or np.abs(turns - np.round(turns)).max() > 1e-3:
        raise ValueError(
            "a pose is (x, y, heading), three finite numbers; the heading must be a multiple of pi/4 radians"
        )
    return np.round(turns)


@ti.data_oriented
class Body:
    """Geometry of a body at a pose: an ``origin`` (x, y), metres, and a ``cell`` (i, j, heading), int32."""

    def __init__(self, config: Config) -> None:
        """Take the body's sides, its eye and its step from the configuration."""
        self.step, self.sides, self.eyes = config.step, config.body, config.eye
        self.headings = constants(np.array(HEADINGS, np.int32))

    @ti.func
    def begun(self, corner, i, j, word, given):
        """Return the origin and the cell of a body at a place of a lattice.

        The heading is ``given``; if that is negative, the random ``word`` determines it.
        """
        anyhow = ti.cast((word * ti.u64(8)) >> ti.u64(32), ti.i32)
        return corner, ti.Vector([i, j, ti.select(given < 0, anyhow, given)])

    @ti.func
    def number(self, action):
        """Return the number of an action."""
        return action

    @ti.func
    def heading(self, cell):
        """Return the heading in radians, counter-clockwise from east."""
        return ti.cast(cell[2], ti.f32) * ti.static(np.pi / 4)

    @ti.func
    def degrees(self, cell):
        """Return the heading in degrees."""
        return 45.0 * cell[2]

    @ti.func
    def eighth(self, cell):
        """Return the heading in eighths of a turn."""
        return cell[2]

    @ti.func
    def overlaps(self, origin, cell, target, half: ti.template()):
        """Return 1 (i32) if the body overlaps a square around ``target``; touching is not overlapping."""
        return self.overlaps_with(origin, cell, target, half, 1.0)

    @ti.func
    def overlaps_with(self, origin, cell, target, half: ti.template(), width):
        """Return ``overlaps`` for a body that has ``width`` times its usual width."""
        near = width * self.half(cell) + ti.static(half - SKIN)
        return ti.cast(ti.abs(self.centre(origin, cell) - target).max() < near, ti.i32)

    @ti.func
    def meets(self, box, origin, cell, new_origin, new, width):
        """Return 1 (i32) if a box blocks the body, ``width`` times as wide as usual, between two cells."""
        half = self.half(new)
        begin = self.centre(origin, cell) + (half - self.half(cell))
        return slides_into(box, begin, self.centre(new_origin, new), width * half)

    @ti.func
    def ahead(self, cell):
        """Return the cell that is one step forward."""
        forward = self.headings[cell[2]]
        return ti.Vector([cell[0] + forward[0], cell[1] + forward[1], cell[2]])

    @ti.func
    def turned(self, cell, action):
        """Return the cell after a turn."""
        return ti.Vector([cell[0], cell[1], (cell[2] + ti.select(action == LEFT, 1, 7)) & 7])

    @ti.func
    def position(self, origin, cell):
        """Return the eye's place at headings along an axis, in metres.

        The lattice consists of these places.
        """
        return origin + ti.cast(ti.Vector([cell[0], cell[1]]), ti.f32) * ti.static(self.step)

    @ti.func
    def eye(self, origin, cell):
        """Return the eye's place, where rays start, in metres."""
        shift = ti.static(self.eyes[1] - self.eyes[0])
        return self.position(origin, cell) + ti.select(cell[2] & 1, shift, 0.0)

    @ti.func
    def half(self, cell):
        """Return half the body's side at a cell's heading, in metres."""
        return 0.5 * ti.select(cell[2] & 1, ti.static(self.sides[1]), ti.static(self.sides[0]))

    @ti.func
    def centre(self, origin, cell):
        """Return the body's centre in metres. The body's north-west corner is the same at all headings."""
        return self.position(origin, cell) + (self.half(cell) - ti.static(self.eyes[0]))
