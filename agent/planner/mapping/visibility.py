"""Visibility: the cells behind each ray, the sweep that marks them, and the walls that rays end on.

Many rays cross near cells, and far cells lie between rays. So each cell belongs to the ray that crosses it
nearest to its centre by angle, and is seen if that ray reaches beyond it. A cell between two rays is seen if
both reach beyond it. There are eight headings, and the eye stands on a cell's corner or half a cell from it,
so all cases fit in a table.
"""

import numpy as np

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.runtime import ti

FINE = 512
"""Units of distance in a cell."""

BAND_CELLS = 4
"""Number of cells of a ray that are skipped at a time if they were already marked."""


def bands(ray_range: float) -> int:
    """Return the number of multiples 0, 1, 2 ... of ``BAND_CELLS`` within a ray's range, in cells."""
    return int(ray_range / BAND_CELLS) + 1


def fan(
    config: PlannerConfig, angles: np.ndarray, ray_range: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the cells behind rays at ``angles`` (R,), radians, that reach ``ray_range`` cells.

    ``angles`` are counter-clockwise from the heading and decrease. The first array is the start of each list,
    (32, 2 R) int32, by heading and by whether the eye's place in half cells is odd (east + 2 south). The
    lists are a ray's own cells, then those between it and the next ray.

    The second array (32, R, bands) int32 is the number of its own cells that a ray passes before it has gone
    0, 1, 2 ... times ``BAND_CELLS``. The third array has all the lists, one after the other, int32. A value
    is the distance that a ray must go, in units of ``FINE``, times 2^16, plus the offset from the eye's own
    cell. An offset is south times 2^8 plus east, both modulo 2^8 (``Occupancy.beside``).
    """
    wide = int(np.ceil(ray_range)) + 1
    south, east = np.mgrid[-wide:wide, -wide:wide].reshape(2, -1)
    middles = np.append((angles[1:] + angles[:-1]) / 2, -np.inf)
    starts, skips, lists, begun = [], [], [], 0
    along = BAND_CELLS * FINE * np.arange(bands(ray_range)) << 16
    for heading in range(len(HEADINGS)):
        for odd in range(4):
            x, y = east + 0.5 - 0.5 * (odd & 1), south + 0.5 - 0.5 * (odd >> 1)
            angle = (np.arctan2(-y, x) - np.pi / 4 * heading + np.pi) % (2 * np.pi) - np.pi
            nearest = np.searchsorted(-middles, -angle)
            off, away = angle - angles[nearest], np.hypot(x, y)
            on = (np.abs(np.sin(off)) * away <= config.ray_width) & (np.cos(off) > 0)
            # Angles decrease: a cell counter-clockwise of a ray lies between the ray before it and this ray.
            list_ = np.where(on, 2 * nearest, np.where(off > 0, 2 * nearest - 1, 2 * nearest + 1))
            far = away * np.cos(off) + config.ray_beyond
            kept = (list_ >= 0) & (list_ < 2 * len(angles) - 1) & (far <= ray_range)
            order = np.lexsort((far[kept], list_[kept]))
            places = ((south[kept] & 0xFF) << 8) | (east[kept] & 0xFF)
            cells = (np.ceil(far[kept] * FINE).astype(np.int64) << 16 | places)[order]
            begins = np.searchsorted(list_[kept][order], np.arange(2 * len(angles)))
            own = zip(begins[::2], begins[1::2], strict=True)
            skips.append([np.searchsorted(cells[first:last], along) for first, last in own])
            starts.append(begun + begins)
            lists.append(cells)
            begun += len(order)
    return np.array(starts, np.int32), np.array(skips, np.int32), np.concatenate(lists).astype(np.int32)


@ti.data_oriented
class Visibility:
    """Sweeps on a map by ``rays`` rays of a range in fractions (``FINE``) of a cell.

    The planner sweeps if a sweep may show something (``due``). If the body has only gone straight on since
    the last sweep, a ray skips the cells that the last sweep marked or skipped.
    """

    def __init__(
        self, config: PlannerConfig, occupancy: Occupancy, rays: int, ray_range: float, tolerance: float
    ) -> None:
        """Sweep this map. Two ends lie on one line up to ``tolerance`` cells."""
        self.tolerance = tolerance
        self.config, self.occupancy, self.rays, self.bands = config, occupancy, rays, bands(ray_range / FINE)

    @ti.func
    def due(self, time, new, known, straight):
        """Return 1 if this step includes a sweep.

        ``new`` cells were seen in the last step; ``known`` is 1 if a target is known. ``straight`` is at
        least 0 if the body has only gone straight on since the last sweep, otherwise -1.
        """
        every = ti.select(
            known, ti.static(self.config.sweep_interval_known), ti.static(self.config.sweep_interval)
        )
        return ti.cast((new > 0) | (time % every == 1) | ((straight < 0) & (known == 0)), ti.i32)

    @ti.func
    def floor(
        self, memory: ti.template(), tables: ti.template(), base, place, corner, pose, ray, far, last_far,
        last_reached, straight, time,
    ):  # fmt: skip
        """Mark the floor along a ray that reaches ``far``, and between the last ray and this one.

        ``corner`` is the eye's corner, ``pose`` one of the fan's poses, ``place`` the ray's index in
        ``reached``. ``last_reached`` is how far the last ray reached in the last sweep. Returns the number of
        cells that were never seen, and how far this ray reached in the last sweep.
        """
        row = pose * self.rays + ray
        first, middle = tables.starts[2 * row - (ray > 0)], tables.starts[2 * row]
        last = tables.starts[2 * row + 1]
        new, along, between, here = 0, 0, 0, memory.reached[place]
        if self.skips(straight, pose):
            # On a diagonal the way is longer than along either axis.
            margin = ti.static(int(FINE * self.config.sweep_margin)) + ti.static(3 * FINE // 4) * straight
            between = ti.min(here, ti.select(ray > 0, last_reached, here)) - margin
            along = ti.max(ti.min(between, memory.reached[place + (ray + 1 < self.rays)] - margin), 0)
        if far > along:
            skip = tables.skips[row * self.bands + along // ti.static(BAND_CELLS * FINE)]
            new += self.mark(memory, tables, base, corner, middle + skip, last, far, time)
        if ti.min(far, last_far) > between:
            new += self.mark(memory, tables, base, corner, first, middle, ti.min(far, last_far), time)
        memory.reached[place] = far
        return new, here

    @ti.func
    def skips(self, straight, pose):
        """Return 1 if rays may skip floor.

        They may not after a long step along a diagonal, as bodies that fill cells make. Behind the end of a
        wall, rays can then be as long as others were before the step.
        """
        over = ti.cast(straight >= 0, ti.i32)
        if ti.static(self.occupancy.touching):
            over &= 1 - ((pose >> 2) & 1)
        return over

    @ti.func
    def mark(self, memory: ti.template(), tables: ti.template(), base, corner, first, last, far, time):
        """Mark the cells of one of the fan's lists that rays reach; return how many were never seen."""
        new = 0
        for k in range(first, last):
            if tables.fan[k] >> 16 > far:
                break
            node = self.occupancy.beside(corner, tables.fan[k] & 0xFFFF)
            new += self.occupancy.unseen(self.occupancy.see(memory, base, node, 0, time))
        return new

    @ti.func
    def wall(self, memory: ti.template(), base, eye, end, before, both, time):
        """Mark a ray's end, and a wall from the last end to this one.

        There is a wall if the last ray ended on something, too (``both``), and the two ends lie on one line.
        Returns how many cells were not known to be occupied.
        """
        hits = self.occupancy.hit(memory, base, eye[0] + end[0], eye[1] + end[1], time)
        gap = ti.abs(end - before)
        if both & (gap.max() < self.occupancy.wall_gap) & (gap.min() < self.tolerance):
            pieces = ti.cast(ti.ceil(gap.max()), ti.i32)
            for k in range(1, pieces):
                part = eye + before + (end - before) * ti.cast(k, ti.f32) / ti.cast(pieces, ti.f32)
                hits += self.occupancy.hit(memory, base, part[0], part[1], time)
        return hits
