"""Targets after the first, for tasks with several targets at once. Each backend adds them to its rays."""

from typing import Any

from vitruvius.sim.backends.free.body import cosine_sine
from vitruvius.sim.backends.free.see import FreeRays
from vitruvius.sim.backends.rays import Rays
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import ti


@ti.data_oriented
class OtherTargets:
    """Functions of kernels for the other targets, whose centres are in ``others``, metres, by environment."""

    def __init__(self, config: Config, body: Any, lanes: int, number: int) -> None:
        """Cast ``lanes`` rays at a time, at ``number`` targets."""
        self.config, self.body, self.number, self.half = config, body, number, config.target / 2
        self.rays: Any = FreeRays(config, lanes) if config.drives else Rays(config, lanes)

    @ti.func
    def centre(self, others: ti.template(), e, k):
        """Return the centre of target k."""
        at = 2 * (e * ti.static(self.number) + k)
        return ti.Vector([others[at], others[at + 1]])

    @ti.func
    def put(self, others: ti.template(), e, k, centre):
        """Move target k to a centre."""
        at = 2 * (e * ti.static(self.number) + k)
        others[at], others[at + 1] = centre[0], centre[1]

    @ti.func
    def met(self, others: ti.template(), e, origin, cell, width):
        """Return the first target that the body, ``width`` times as wide as usual, overlaps; -1 for none."""
        found = -1
        for k in ti.static(range(self.number)):
            if found < 0:
                there = self.centre(others, e, k)
                if self.body.overlaps_with(origin, cell, there, ti.static(self.half), width):
                    found = k
        return found

    @ti.func
    def show(
        self, others: ti.template(), e, origin, cell, ray, off: ti.template(), distance: ti.template(),
        kind: ti.template(),
    ):  # fmt: skip
        """Shorten the rays through a target. Rays count from ``ray``; ``off`` has their errors, radians."""
        eye = self.body.eye(origin, cell)
        over_x, slope_x = self.rays.floats(0.0), self.rays.floats(0.0)
        over_y, slope_y = self.rays.floats(0.0), self.rays.floats(0.0)
        if ti.static(self.config.drives):
            east, south = self.rays.floats(0.0), self.rays.floats(0.0)
            self.rays.aim(self.body.heading(cell), ray, off, east, south)
            self.rays.cross(east, south, over_x, slope_x)
            self.rays.cross(south, east, over_y, slope_y)
        else:
            first = self.rays.first(cell[2], ray)
            self.rays.across(first, 0, over_x, slope_x)
            self.rays.across(first, 1, over_y, slope_y)
        nearest = ti.bit_cast(distance, ti.u32)
        for k in range(self.number):  # pyright: ignore[reportArgumentType]
            centre = self.centre(others, e, k)
            if self.may_see(centre - eye, cell):
                self.rays.meet_target(nearest, kind, over_x, slope_x, over_y, slope_y, eye, centre)
        for r in range(ti.static(self.rays.lanes)):
            distance[r] = ti.bit_cast(nearest[r], ti.f32)

    @ti.func
    def may_see(self, offset, cell):
        """Return False if no ray can reach a target at an offset from the eye: see ``Hits.within``."""
        ahead = 0.0
        if ti.static(self.config.drives):
            cosine, sine = cosine_sine(self.body.heading(cell))
            ahead = offset[0] * cosine - offset[1] * sine
        else:
            direction = self.body.headings[cell[2]]
            length = ti.select((direction[0] != 0) & (direction[1] != 0), ti.static(2**0.5), 1.0)
            ahead = (offset[0] * direction[0] + offset[1] * direction[1]) / length
        return self.rays.within(offset, ti.static(self.half), ahead)
