"""Sight in the free backend: rays hit the nearest of the lines listed for the eye's cell and sector."""

import numpy as np

from vitruvius.sim.backends.blocks import AHEAD, HEADER, LINE, cell_of, end_of
from vitruvius.sim.backends.free.body import TURN, Disc, cosine_sine
from vitruvius.sim.backends.free.layout import FIRST_LINE, ROW, SECTORS, listed
from vitruvius.sim.backends.rays import PARALLEL, Hits, outermost
from vitruvius.sim.config import DEVIATIONS, Config
from vitruvius.sim.runtime import constants, ti


def swing(config: Config) -> float:
    """Return the largest error of a ray's direction, in degrees."""
    return DEVIATIONS * config.angle_noise


@ti.data_oriented
class FreeRays(Hits):
    """Rays in any directions, computed from the heading for each look."""

    def __init__(self, config: Config, lanes: int) -> None:
        super().__init__(config, lanes, outermost(config) + swing(config))
        angles = config.ray_angles
        self.table = constants(np.concatenate([np.cos(angles), np.sin(angles)]).astype(np.float32))

    @ti.func
    def aim(self, heading, ray, off: ti.template(), east: ti.template(), south: ti.template()):
        """Compute the unit vectors of rays, from number ``ray`` on, each turned by ``off`` radians."""
        cosine, sine = cosine_sine(heading)
        for r in range(ti.static(self.lanes)):
            east[r] = self.table[ray + r]
        for r in range(ti.static(self.lanes)):
            south[r] = self.table[ti.static(self.config.rays) + ray + r]
        for r in range(ti.static(self.lanes)):
            first, second = east[r], south[r]
            if ti.static(self.config.angle_noise > 0):
                turned, aside = cosine_sine(off[r])
                first, second = first * turned - second * aside, second * turned + first * aside
            east[r] = cosine * first - sine * second
            south[r] = -(sine * first + cosine * second)

    @ti.func
    def cross(
        self,
        along: ti.template(),
        aside: ti.template(),
        over: ti.template(),
        slope: ti.template(),
    ):
        """Compute how rays meet lines across an axis, from their components ``along`` and ``aside`` the axis.

        ``Rays.across`` explains the results.
        """
        for r in range(ti.static(self.lanes)):
            part = ti.select(ti.abs(along[r]) < ti.static(PARALLEL), ti.static(PARALLEL), along[r])
            over[r] = 1.0 / part
            slope[r] = aside[r] * over[r]


@ti.data_oriented
class Sight:
    """Rays among lines at any angle."""

    def __init__(self, config: Config, lanes: int) -> None:
        self.config, self.body, self.rays = config, Disc(config), FreeRays(config, lanes)

    @ti.func
    def see(self, numbers: ti.template(), indices: ti.template(), house, origin, cell, target, ray):
        """Return the distances and kinds of rays: see ``Backend.see``.

        Of hits at the same distance, walls come first, then furniture, then the target.
        """
        return self.look(numbers, indices, house, origin, cell, target, ray, self.rays.floats(0.0))

    @ti.func
    def look(
        self,
        numbers: ti.template(),
        indices: ti.template(),
        house,
        origin,
        cell,
        target,
        ray,
        off: ti.template(),
    ):
        """Return ``see`` for rays with direction errors ``off``, in radians."""
        heading = self.body.heading(cell)
        east, south = self.rays.floats(0.0), self.rays.floats(0.0)
        over_x, slope_x = self.rays.floats(0.0), self.rays.floats(0.0)
        over_y, slope_y = self.rays.floats(0.0), self.rays.floats(0.0)
        self.rays.aim(heading, ray, off, east, south)
        self.rays.cross(east, south, over_x, slope_x)
        self.rays.cross(south, east, over_y, slope_y)
        nearest, kinds = self.rays.bits(ti.static(self.rays.none)), self.rays.bits(0)
        block, first_line = cell_of(numbers, indices, house, origin), indices[house * HEADER + FIRST_LINE]
        lists = 1 + 3 * (ti.cast(ti.floor(heading * ti.static(SECTORS / TURN) + 0.5), ti.i32) % SECTORS)
        upright, level = end_of(indices, block, lists + 1), end_of(indices, block, lists + 2)
        for k in range(end_of(indices, block, lists), upright):
            at = first_line + ROW * listed(indices, block, k)
            ahead, aside, half = numbers[at] - origin[0], numbers[at + 1] - origin[1], numbers[at + 4]
            kind = ti.cast(ti.abs(numbers[at + 5]), ti.u32)
            self.rays.meet(
                nearest, kinds, over_x, slope_x, ahead, aside, half, kind, ti.static(self.config.notes_hits)
            )
        for k in range(upright, level):
            at = first_line + ROW * listed(indices, block, k)
            ahead, aside, half = numbers[at + 1] - origin[1], numbers[at] - origin[0], numbers[at + 4]
            kind = ti.cast(ti.abs(numbers[at + 5]), ti.u32)
            self.rays.meet(
                nearest, kinds, over_y, slope_y, ahead, aside, half, kind, ti.static(self.config.notes_hits)
            )
        for k in range(level, end_of(indices, block, lists + 3)):
            # A line at an angle is a line across an axis for rays that are turned with it.
            at = first_line + ROW * listed(indices, block, k)
            x, y, u, v = numbers[at], numbers[at + 1], numbers[at + 2], numbers[at + 3]
            kind = ti.cast(ti.abs(numbers[at + 5]), ti.u32)
            ahead = (y - origin[1]) * u - (x - origin[0]) * v
            aside = (x - origin[0]) * u + (y - origin[1]) * v
            over, slope = self.rays.floats(0.0), self.rays.floats(0.0)
            for r in range(ti.static(self.rays.lanes)):
                part = south[r] * u - east[r] * v
                over[r] = 1.0 / ti.select(ti.abs(part) < ti.static(PARALLEL), ti.static(PARALLEL), part)
                slope[r] = (east[r] * u + south[r] * v) * over[r]
            self.rays.meet(
                nearest,
                kinds,
                over,
                slope,
                ahead,
                aside,
                numbers[at + 4],
                kind,
                ti.static(self.config.notes_hits),
            )
        cosine, sine = cosine_sine(heading)
        offset = target - origin
        if self.rays.within(offset, ti.static(self.config.target / 2), offset[0] * cosine - offset[1] * sine):
            self.rays.meet_target(nearest, kinds, over_x, slope_x, over_y, slope_y, origin, target)
        return self.rays.metres(nearest), kinds

    @ti.func
    def prefetch(self, numbers: ti.template(), indices: ti.template(), house, origin, cell):
        """Read the first cache lines of a block: see ``Backend.prefetch``."""
        block = cell_of(numbers, indices, house, origin)
        some = indices[block]
        for k in ti.static(range(LINE, AHEAD, LINE)):
            some &= indices[block + k]
        return some
