"""Sweep of rays from any place at any heading: floor before the rays' ends, walls at any angle.

Floor is looked up point by point, along arcs about the eye. A point between two rays is seen if both rays
reach beyond it. A point that lies on a ray is seen if that ray reaches beyond it.
"""

import numpy as np

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.mapping.visibility import FINE
from vitruvius.sim.runtime import ti

POINT_PITCH_CELLS = 0.7
"""Cells between points along a ray, and approximately along an arc: a cell's diagonal has two points."""


@ti.data_oriented
class Sweep:
    """Sweeps of ``rays`` rays that are ``spacing`` radians apart."""

    def __init__(
        self, config: PlannerConfig, occupancy: Occupancy, rays: int, spacing: float, tolerance: float
    ) -> None:
        """Sweep this map. Ends lie on one line up to ``tolerance`` cells."""
        self.occupancy, self.rays, self.tolerance = occupancy, rays, tolerance
        self.beyond, self.width = config.ray_beyond, config.ray_width / 2
        self.spacing, self.fan = spacing, spacing * (rays - 1)

    @ti.func
    def floor(self, memory: ti.template(), tables: ti.template(), base, e, eye, cosine, sine, furthest, time):
        """Mark the floor before the rays' ends; return the number of cells that were never seen.

        The rays' ends lie in ``reached``, the furthest ``furthest`` fractions (``FINE``) of a cell away.
        """
        new, away = 0, POINT_PITCH_CELLS
        most = ti.cast(furthest, ti.f32) / ti.static(float(FINE)) - self.beyond
        while away <= most:
            points = ti.max(1, ti.cast(ti.ceil(ti.static(self.fan / POINT_PITCH_CELLS) * away), ti.i32))
            far = ti.cast((away + self.beyond) * ti.static(float(FINE)), ti.i32)
            for k in range(points + 1):
                at = ti.cast(k, ti.f32) * ti.static(float(self.rays - 1)) / ti.cast(points, ti.f32)
                ray = ti.min(ti.cast(at, ti.i32), ti.static(self.rays - 2))
                share = at - ti.cast(ray, ti.f32)
                aside, place = away * ti.static(float(self.spacing)), e * self.rays + ray
                one = ti.cast(memory.reached[place] >= far, ti.i32)
                other = ti.cast(memory.reached[place + 1] >= far, ti.i32)
                seen = one & other
                if share * aside < self.width:
                    seen |= one
                if (1.0 - share) * aside < self.width:
                    seen |= other
                if seen:
                    first = ti.Vector([tables.rays[2 * ray], tables.rays[2 * ray + 1]])
                    next_ = ti.Vector([tables.rays[2 * ray + 2], tables.rays[2 * ray + 3]])
                    way = first + share * (next_ - first)
                    point = eye + away * turned(way, cosine, sine)
                    node = self.occupancy.at(
                        ti.cast(ti.floor(point[0]), ti.i32), ti.cast(ti.floor(point[1]), ti.i32)
                    )
                    new += self.occupancy.unseen(self.occupancy.see(memory, base, node, 0, time))
            away += POINT_PITCH_CELLS
        return new

    @ti.func
    def wall(self, memory: ti.template(), base, eye, end, before, earlier, ends, time):
        """Mark a ray's end, and the walls from it to earlier ends.

        ``ends`` is how many of the last rays in a row ended on something, 2 at most. Two ends on a line along
        an axis belong to one wall, as do three ends on any line. Returns how many cells were not known to be
        occupied.
        """
        hits, gap = self.occupancy.hit(memory, base, eye[0] + end[0], eye[1] + end[1], time), end - before
        if (ends > 0) & (ti.abs(gap).max() < self.occupancy.wall_gap):
            joined = ti.cast(ti.abs(gap).min() < self.tolerance, ti.i32)
            if ends > 1:
                last = before - earlier
                off = ti.abs(gap.cross(last))
                if (off < self.tolerance * last.norm()) & (ti.abs(last).max() < self.occupancy.wall_gap):
                    joined = 1
                    hits += self.join(memory, base, eye + earlier, last, time)
            if joined:
                hits += self.join(memory, base, eye + before, gap, time)
        return hits

    @ti.func
    def join(self, memory: ti.template(), base, first, way, time):
        """Mark a wall from a place along ``way``; return how many cells were not known to be occupied."""
        hits, pieces = 0, ti.cast(ti.ceil(ti.abs(way).max()), ti.i32)
        for k in range(1, pieces):
            part = first + way * ti.cast(k, ti.f32) / ti.cast(pieces, ti.f32)
            hits += self.occupancy.hit(memory, base, part[0], part[1], time)
        return hits


@ti.func
def turned(way, cosine, sine):
    """Return a direction from the heading, (forward, left), as cells east and south."""
    return ti.Vector([cosine * way[0] - sine * way[1], -(sine * way[0] + cosine * way[1])])


def rays_of(angles: np.ndarray) -> np.ndarray:
    """Return the directions (R, 2) float32, forward and left, of rays at ``angles`` (R,) radians."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1).astype(np.float32)
