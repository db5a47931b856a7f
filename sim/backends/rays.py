"""Rays in few directions, and what shortens them: lines along an axis.

Headings are multiples of 45 degrees and rays a divisor of that apart, so a table holds all directions and no
kernel knows trigonometry. A distance is kept as the bits of a float32 in a uint32: among those of floats that
are not negative the order is that of the floats, and all negative ones, hits behind the eye, are greater. So
one minimum does for two comparisons, and loops over rays have no branch: they become vector instructions.
"""

import numpy as np

from sim.backends.backend import NAMED, TARGET
from sim.backends.body import Body
from sim.config import Config
from sim.runtime import constants, ti

OVERLAP = 2e-5
"""Metres by which a line reaches beyond its ends for a ray, so that none slips through where two meet."""

EXACT = 128.0
"""Distance from the origin, in metres, up to which the rounding error of float32 is less than ``OVERLAP``."""

MARGIN = 1e-3
"""Metres by which a rough test is more generous than it needs to be: more than rounding can take away."""

PARALLEL = 1e-30
"""In place of a zero sine or cosine: a ray along an axis meets no line along it, in plain arithmetic."""


def overlap(lines: np.ndarray) -> np.ndarray:
    """Return the extension (n,) of each line beyond its ends, in metres, for lines with coordinates (n, k).

    The extension is ``OVERLAP``. Beyond ``EXACT`` metres from the origin it grows with the spacing of
    float32.
    """
    reach = np.abs(lines).max(axis=1)
    return OVERLAP * np.exp2(np.ceil(np.log2(np.maximum(reach, EXACT) / EXACT)))


def outermost(config: Config) -> float:
    """Degrees from the heading to the ray that is furthest off it."""
    return max(config.first_ray, config.ray_spacing * (config.rays - 1) - config.first_ray)


def directions(config: Config) -> np.ndarray:
    """Degrees from east, counter-clockwise, of every direction: heading h looks along those from row
    ``turn * ((8 - h) % 8)`` on, where ``turn`` rows make 45 degrees. (7 turn + R,) float64.
    """
    rows = np.arange(7 * config.rays_in_a_turn + config.rays)
    return config.first_ray - 45 * rows / config.rays_in_a_turn


@ti.data_oriented
class Hits:
    """What shortens ``lanes`` rays of one look at a time: all of them on a CPU, one on a GPU."""

    def __init__(self, config: Config, lanes: int, outermost: float) -> None:
        """``outermost``: degrees from the heading to the ray that is furthest off it."""
        self.config, self.lanes = config, lanes
        # At one distance the target comes after pieces, whatever their kinds.
        self.last = NAMED + len(config.kinds) if config.kinds else TARGET
        self.none = int(np.float32(config.range).view(np.uint32))
        self.floats = ti.types.vector(lanes, ti.f32)
        self.bits = ti.types.vector(lanes, ti.u32)
        self.widest = float(np.cos(np.deg2rad(min(180.0, max(0.0, outermost)))))

    @ti.func
    def meet(
        self,
        nearest: ti.template(),
        kinds: ti.template(),
        over: ti.template(),
        slope: ti.template(),
        ahead,
        aside,
        half,
        kind,
        noted: ti.template(),
    ):
        """Shorten the rays that hit a line: ``ahead`` metres along the axis that it lies across, its middle
        ``aside`` metres along the other, ``half`` from there to its ends. Where it is ``noted`` what they
        hit, of two hits at one distance the lower kind counts.
        """
        for r in range(ti.static(self.lanes)):
            distance = ti.bit_cast(ahead * over[r], ti.u32)
            hit = ti.abs(ahead * slope[r] - aside) <= half
            if ti.static(noted):
                hit &= (distance < nearest[r]) | ((distance == nearest[r]) & (kind < kinds[r]))
                nearest[r] = ti.select(hit, distance, nearest[r])
                kinds[r] = ti.select(hit, kind, kinds[r])
            else:
                nearest[r] = ti.select(hit, ti.min(distance, nearest[r]), nearest[r])

    @ti.func
    def within(self, offset, half, ahead):
        """Whether a square at an offset from the eye, so far ``ahead`` in the look's direction, may be within
        the range and the field of view: never False where it is.
        """
        radius = half * ti.static(2**0.5)
        away = ti.sqrt(offset[0] * offset[0] + offset[1] * offset[1])
        slack = ti.static(1 + abs(self.widest)) * radius + ti.static(MARGIN)
        return (ahead > ti.static(self.widest) * away - slack) & (
            away < ti.static(self.config.range + MARGIN) + radius
        )

    @ti.func
    def meet_target(
        self,
        nearest: ti.template(),
        kinds: ti.template(),
        over_x: ti.template(),
        slope_x: ti.template(),
        over_y: ti.template(),
        slope_y: ti.template(),
        eye,
        target,
    ):
        """Shorten the rays that hit the target on the sides that face the eye. From inside none does: it is
        there only where somebody put it there.
        """
        half, kind = ti.static(self.config.target / 2), ti.u32(self.last)
        low, high = target - half, target + half
        outside = (low > eye).any() or (high < eye).any()
        sides = ti.select(outside, 0.5 * (high - low) + ti.static(OVERLAP), -1.0)
        ahead, aside = ti.select(low > eye, low, high) - eye, 0.5 * (low + high) - eye
        self.meet(nearest, kinds, over_x, slope_x, ahead[0], aside[1], sides[1], kind, True)
        self.meet(nearest, kinds, over_y, slope_y, ahead[1], aside[0], sides[0], kind, True)
        if ti.static(self.last != TARGET):
            for r in range(ti.static(self.lanes)):
                kinds[r] = ti.select(kinds[r] == ti.static(self.last), ti.u32(TARGET), kinds[r])

    @ti.func
    def metres(self, nearest):
        """Distances as floats."""
        return ti.bit_cast(nearest, ti.f32)


@ti.data_oriented
class Rays(Hits):
    """Rays in few directions, from a table."""

    def __init__(self, config: Config, lanes: int) -> None:
        super().__init__(config, lanes, outermost(config))
        self.turn = config.rays_in_a_turn
        degrees = directions(config)
        east, south = np.cos(np.deg2rad(degrees)), -np.sin(np.deg2rad(degrees))
        east[degrees % 180 == 90] = PARALLEL
        south[degrees % 180 == 0] = PARALLEL
        self.count = len(degrees)
        table = np.concatenate([1 / east, south / east, 1 / south, east / south]).astype(np.float32)
        self.table = constants(table)

    @ti.func
    def first(self, heading, ray):
        """The row of a look's first ray."""
        return ((8 - heading) & 7) * ti.static(self.turn) + ray

    @ti.func
    def across(self, first, axis: ti.template(), over: ti.template(), slope: ti.template()):
        """Directions as lines across an axis (0: x, 1: y) meet them: how far a ray goes for each metre along
        that axis, and how far along the other. Local copies: from the table they would cost the vectors.
        """
        at = first + ti.static(2 * axis * self.count)
        for r in range(ti.static(self.lanes)):
            over[r] = self.table[at + r]
        for r in range(ti.static(self.lanes)):
            slope[r] = self.table[at + ti.static(self.count) + r]

    @ti.func
    def may_see(self, offset, half, direction):
        """Whether a square at an offset from the eye may be seen by a look in a direction (steps east and
        south): see ``within``. Most are not, and cost no more.
        """
        length = ti.select((direction[0] != 0) & (direction[1] != 0), ti.static(2**0.5), 1.0)
        ahead = (offset[0] * direction[0] + offset[1] * direction[1]) / length
        return self.within(offset, half, ahead)


@ti.data_oriented
class RayBody:
    """A body and its rays: what a backend is made with."""

    def __init__(self, config: Config, lanes: int) -> None:
        self.config, self.body, self.rays = config, Body(config), Rays(config, lanes)
