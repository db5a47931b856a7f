"""A square body and its eye, at poses that are counted in steps and headings."""

import numpy as np

from sim.actions import HEADINGS, LEFT
from sim.config import Config
from sim.runtime import constants, ti

SKIN = 1e-5
"""Metres: a body that reaches less far than this into something touches it, and what merely touches neither
blocks nor is picked up."""


@ti.func
def slides_into(box, p, q, half):
    """Whether a square that slides from p to q meets a box (west, north, east, south) (i32): three axes to
    separate them by, x, y and across the way. The same bits for p to q as for q to p, so that ways can be
    searched backwards.
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
    """The headings of poses (E, 3), in eighths of a turn (E,) float64. ``ValueError`` for what are none."""
    turns = pose[:, 2] / (np.pi / 4)
    if not np.isfinite(pose).all() or np.abs(turns - np.round(turns)).max() > 1e-3:
        raise ValueError("a pose is (x, y, heading): finite, heading a multiple of pi/4 radians")
    return np.round(turns)


@ti.data_oriented
class Body:
    """Where a body is at a pose: an ``origin`` (x, y), metres, and a ``cell`` (i, j, heading), int32."""

    def __init__(self, config: Config) -> None:
        """Take the body's sides, its eye and its step from the configuration."""
        self.step, self.sides, self.eyes = config.step, config.body, config.eye
        self.headings = constants(np.array(HEADINGS, np.int32))

    @ti.func
    def begun(self, corner, i, j, word, given):
        """The origin and the cell of a body at a place of a lattice, with a ``given`` heading, or by a random
        ``word`` if that is negative.
        """
        anyhow = ti.cast((word * ti.u64(8)) >> ti.u64(32), ti.i32)
        return corner, ti.Vector([i, j, ti.select(given < 0, anyhow, given)])

    @ti.func
    def number(self, action):
        """The number of an action."""
        return action

    @ti.func
    def heading(self, cell):
        """Radians, counter-clockwise from east."""
        return ti.cast(cell[2], ti.f32) * ti.static(np.pi / 4)

    @ti.func
    def degrees(self, cell):
        """The heading in degrees."""
        return 45.0 * cell[2]

    @ti.func
    def eighth(self, cell):
        """The heading in eighths of a turn."""
        return cell[2]

    @ti.func
    def overlaps(self, origin, cell, target, half: ti.template()):
        """Whether the body overlaps a square about ``target`` (i32); touching is not overlapping."""
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
        """The cell that is one step forward."""
        forward = self.headings[cell[2]]
        return ti.Vector([cell[0] + forward[0], cell[1] + forward[1], cell[2]])

    @ti.func
    def turned(self, cell, action):
        """The cell after a turn."""
        return ti.Vector([cell[0], cell[1], (cell[2] + ti.select(action == LEFT, 1, 7)) & 7])

    @ti.func
    def position(self, origin, cell):
        """The eye's place at straight headings, which the lattice is of, metres."""
        return origin + ti.cast(ti.Vector([cell[0], cell[1]]), ti.f32) * ti.static(self.step)

    @ti.func
    def eye(self, origin, cell):
        """Where rays start, metres."""
        shift = ti.static(self.eyes[1] - self.eyes[0])
        return self.position(origin, cell) + ti.select(cell[2] & 1, shift, 0.0)

    @ti.func
    def half(self, cell):
        """Half the body's side at a cell's heading, metres."""
        return 0.5 * ti.select(cell[2] & 1, ti.static(self.sides[1]), ti.static(self.sides[0]))

    @ti.func
    def centre(self, origin, cell):
        """The body's centre, metres: its north-west corner is the same at all headings."""
        return self.position(origin, cell) + (self.half(cell) - ti.static(self.eyes[0]))
