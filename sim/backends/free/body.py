"""A disc that drives: the representation of its pose and its speeds in a state.

``origin`` is the disc's place in metres, ``cell`` its heading in radians, in [0, 2 pi), counter-clockwise
from east. ``speeds`` are the numbers of a command: forward speed (m/s) and turn rate (rad/s), or forward
speed, speed to the left and turn rate. Surveys use a lattice through a place, with cells (i, j, 0).
"""

import math

import numpy as np

from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.backends.body import SKIN
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import constants, ti

TURN = 2 * math.pi

TOUCH = 1e-3
"""Largest distance between a body and an obstacle that it drove into and slid along, metres."""


@ti.func
def cosine_sine(angle):
    """Return cosine and sine of a float32, within 1e-7 for angles of some turns.

    Polynomials of Cephes cover an eighth of a turn. Taichi's own functions differ between machines, and are
    slow.
    """
    quarter = ti.floor(angle * ti.static(2 / math.pi) + 0.5)
    r = ((angle - quarter * 1.5703125) - quarter * 4.837512969970703125e-4) - quarter * 7.549789948768648e-8
    z = r * r
    sine = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * r + r
    cosine = ((2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2) * z * z
    cosine += 1.0 - 0.5 * z
    turned = ti.cast(quarter, ti.i32)
    odd = turned & 1
    first, second = ti.select(odd, sine, cosine), ti.select(odd, cosine, sine)
    return ti.select((turned + 1) & 2, -first, first), ti.select(turned & 2, -second, second)


@ti.func
def wrapped(angle):
    """Return an angle in [0, 2 pi)."""
    around = angle - ti.static(TURN) * ti.floor(angle * ti.static(1 / TURN))
    return ti.select((around >= 0.0) & (around < ti.static(TURN)), around, 0.0)


@ti.data_oriented
class Disc:
    """A body as wide at all headings, with its eye in the middle."""

    def __init__(self, config: Config) -> None:
        """Take the radius from the configuration's body, and the lattice's pitch from its step."""
        self.radius, self.step, self.drive = config.body[0] / 2, config.step, config.drive
        self.headings = constants(np.array(HEADINGS, np.int32))
        self.sideways = config.drive.sideways > 0
        commands = config.drive.commands or (config.drive.low,)
        self.commands = constants(np.array(commands, np.float32))

    @ti.func
    def in_parts(self, speeds):
        """Return the speeds of a body that drives sideways, rounded to whole parts: see ``Drive.part``.

        Speeds are rounded so that trajectories are those of earlier versions, which kept 21 bits of each.
        """
        rounded = speeds
        if ti.static(self.sideways):
            for k in ti.static(range(3)):
                whole = ti.floor(speeds[k] * ti.static(1 / self.drive.part[k]) + 0.5)
                rounded[k] = whole * ti.static(self.drive.part[k])
        return rounded

    @ti.func
    def heading(self, cell):
        """Return the heading in radians."""
        return cell

    @ti.func
    def degrees(self, cell):
        """Return the heading in degrees."""
        return cell * ti.static(180 / math.pi)

    @ti.func
    def eighth(self, cell):
        """Return the heading in eighths of a turn, rounded."""
        return ti.cast(ti.floor(cell * ti.static(8 / TURN) + 0.5), ti.i32) & 7

    @ti.func
    def begun(self, corner, i, j, word, given):
        """Return the origin and the cell of a body at rest at a place of a lattice.

        The heading is ``given`` as bits; if that is negative, the random ``word`` determines it.
        """
        anyhow = ti.cast(word >> ti.u64(8), ti.f32) * ti.static(TURN * 2.0**-24)
        heading = ti.select(given < 0, anyhow, ti.bit_cast(given, ti.f32))
        place = corner + ti.cast(ti.Vector([i, j]), ti.f32) * ti.static(self.step)
        return place, heading

    @ti.func
    def ordered(self, action):
        """Return the numbers of an action's command, within the limits.

        The action is the number of a command, or the speeds themselves.
        """
        wanted = ti.Vector([0.0 for _ in ti.static(self.drive.low)])
        if ti.static(len(self.drive.commands) > 0):
            wanted = self.commands[ti.cast(action, ti.i32)]
        else:
            for k in ti.static(range(len(self.drive.low))):
                wanted[k] = action[k]
        for k in ti.static(range(len(self.drive.low))):
            wanted[k] = ti.max(ti.static(self.drive.low[k]), ti.min(ti.static(self.drive.high[k]), wanted[k]))
        return wanted

    @ti.func
    def number(self, action):
        """Return the number of an action, or -1 if actions have no numbers."""
        number = -1
        if ti.static(len(self.drive.commands) > 0):
            number = ti.cast(action, ti.i32)
        return number

    @ti.func
    def position(self, origin, cell):
        """Return the place of a lattice's cell, in metres."""
        return origin + ti.cast(ti.Vector([cell[0], cell[1]]), ti.f32) * ti.static(self.step)

    @ti.func
    def eye(self, origin, cell):
        """Return the eye's place, where rays start, in metres."""
        return origin

    @ti.func
    def overlaps(self, origin, cell, target, half: ti.template()):
        """Return 1 (i32) if the disc overlaps a square around ``target``; touching is not overlapping."""
        return self.overlaps_with(origin, cell, target, half, 1.0)

    @ti.func
    def overlaps_with(self, origin, cell, target, half: ti.template(), width):
        """Return ``overlaps`` for a disc that has ``width`` times its usual width."""
        away = ti.max(ti.abs(origin - target) - half, 0.0)
        near = away[0] * away[0] + away[1] * away[1]
        return ti.cast(near < width * width * ti.static((self.radius - SKIN) ** 2), ti.i32)

    @ti.func
    def meets(self, box, origin, cell, new_origin, new, width):
        """Return 1 if the disc, with ``width`` times its usual width, touches a box after a step (i32).

        The box is (west, north, east, south).
        """
        low, high = ti.Vector([box[0], box[1]]), ti.Vector([box[2], box[3]])
        away = ti.max(low - new_origin, new_origin - high, 0.0)
        near = away[0] * away[0] + away[1] * away[1]
        reach = width * ti.static(self.radius) + ti.static(TOUCH)
        return ti.cast(near < reach * reach, ti.i32)
