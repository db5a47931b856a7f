"""Rays in few directions, and the axis-aligned lines that shorten them.

Headings are multiples of 45 degrees, and the angle between rays divides 45 degrees. So a table has all
directions, and no kernel needs trigonometry. A distance is stored as the bits of a float32 in a uint32. For
floats that are not negative, the order of the bits is the order of the floats; negative ones, hits behind the
eye, are larger than all others. So one minimum replaces two comparisons, and loops over rays have no branch:
they become vector instructions.
"""

import numpy as np

from vitruvius.sim.backends.backend import NAMED, TARGET
from vitruvius.sim.backends.body import Body
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import constants, ti

OVERLAP = 2e-5
"""Extension of a line beyond its ends for rays, in metres, so that no ray slips through where two lines
meet."""

EXACT = 128.0
"""Distance from the origin, in metres, up to which the rounding error of float32 is less than ``OVERLAP``."""

MARGIN = 1e-3
"""Tolerance of rough tests, in metres; it is larger than any rounding error."""

PARALLEL = 1e-30
"""Replacement for a sine or cosine of zero, so that a ray along an axis misses lines along that axis without
a special case."""


def overlap(lines: np.ndarray) -> np.ndarray:
    """Return the extension (n,) of each line beyond its ends, in metres, for lines with coordinates (n, k).

    The extension is ``OVERLAP``. Beyond ``EXACT`` metres from the origin it grows with the spacing of
    float32.
    """
    reach = np.abs(lines).max(axis=1)
    return OVERLAP * np.exp2(np.ceil(np.log2(np.maximum(reach, EXACT) / EXACT)))


def outermost(config: Config) -> float:
    """Return the angle in degrees from the heading to the ray that is furthest from it."""
    return max(config.first_ray, config.ray_spacing * (config.rays - 1) - config.first_ray)


def directions(config: Config) -> np.ndarray:
    """Return all directions in degrees counter-clockwise from east, (7 turn + R,) float64.

    Heading h has the directions from row ``turn * ((8 - h) % 8)`` on, where ``turn`` rows make 45 degrees.
    """
    rows = np.arange(7 * config.rays_in_a_turn + config.rays)
    return config.first_ray - 45 * rows / config.rays_in_a_turn


@ti.data_oriented
class Hits:
    """Functions that shorten ``lanes`` rays of one look at a time: all rays on a CPU, one ray on a GPU."""

    def __init__(self, config: Config, lanes: int, outermost: float) -> None:
        """Take ``outermost``, the angle in degrees from the heading to the ray that is furthest from it."""
        self.config, self.lanes = config, lanes
        # At the same distance the target comes after furniture of any kind.
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
        """Shorten the rays that hit a line.

        The line is ``ahead`` metres along the axis that it crosses, its middle ``aside`` metres along the
        other axis, and its ends ``half`` metres from the middle. If hits are ``noted``, the lower kind wins
        at equal distances.
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
        """Return False only if a square at an offset from the eye is outside the range or the field of view.

        The square is ``ahead`` metres in the direction of the look.
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
        """Shorten the rays that hit the target on the sides that face the eye.

        From inside the target no ray hits it; that happens only to a target that the user put there.
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
        """Return distances as floats."""
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
        """Return the row of a look's first ray."""
        return ((8 - heading) & 7) * ti.static(self.turn) + ray

    @ti.func
    def across(self, first, axis: ti.template(), over: ti.template(), slope: ti.template()):
        """Copy the directions of rays, relative to lines across an axis (0: x, 1: y).

        ``over`` is the length of a ray for each metre along that axis, ``slope`` the distance along the other
        axis. Local copies keep the loops vectorised; reads from the table would not.
        """
        at = first + ti.static(2 * axis * self.count)
        for r in range(ti.static(self.lanes)):
            over[r] = self.table[at + r]
        for r in range(ti.static(self.lanes)):
            slope[r] = self.table[at + ti.static(self.count) + r]

    @ti.func
    def may_see(self, offset, half, direction):
        """Return False only if a look cannot see a square at an offset from the eye.

        ``direction`` of the look: steps east and south. ``within`` explains the test. Most looks do not see
        the target, and end here.
        """
        length = ti.select((direction[0] != 0) & (direction[1] != 0), ti.static(2**0.5), 1.0)
        ahead = (offset[0] * direction[0] + offset[1] * direction[1]) / length
        return self.within(offset, half, ahead)


@ti.data_oriented
class RayBody:
    """A body and its rays, which a backend is created with."""

    def __init__(self, config: Config, lanes: int) -> None:
        self.config, self.body, self.rays = config, Body(config), Rays(config, lanes)
