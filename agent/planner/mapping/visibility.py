"""What the rays show: the cells behind each ray, the sweep that marks them, and the walls that rays end on.

Rays cross near cells in numbers and miss far ones between them. So each cell belongs to the ray that crosses
it nearest to its centre by angle, and is seen if that one reaches beyond it; or it lies between two rays, and
is seen if both do. Headings are eight, and the eye stands on a cell's corner or half a cell from it: all
cases fit in a table.
"""

import numpy as np

from agent.planner.config import PlannerConfig
from agent.planner.mapping.occupancy import Occupancy
from sim.actions import HEADINGS
from sim.runtime import ti

FINE = 512
"""Parts of a cell in which distances are counted."""

BAND = 4
"""Cells of a ray that are skipped at a time, where they were marked before."""


def bands(ray_range: float) -> int:
    """How many distances of 0, 1, 2 ... times ``BAND`` cells there are within a ray's range, in cells."""
    return int(ray_range / BAND) + 1


def fan(
    config: PlannerConfig, angles: np.ndarray, ray_range: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells behind rays at ``angles`` (R,), radians counter-clockwise from the heading, falling, that reach
    ``ray_range`` cells.

    Returns where each list begins (32, 2 R) int32, by heading and by whether the eye's place in half cells
    is odd (east + 2 south): a ray's own cells, then those between it and the next one. Then how many of its
    own cells a ray passes before it has gone 0, 1, 2 ... times ``BAND`` cells (32, R, bands) int32. And all
    the lists, one after the other, int32: how far a ray must go, in parts of a cell, times 2^16, and the
    way there from the eye's own cell, south times 2^8 and east, both modulo 2^8 (``Occupancy.beside``).
    """
    wide = int(np.ceil(ray_range)) + 1
    south, east = np.mgrid[-wide:wide, -wide:wide].reshape(2, -1)
    middles = np.append((angles[1:] + angles[:-1]) / 2, -np.inf)
    starts, skips, lists, begun = [], [], [], 0
    along = BAND * FINE * np.arange(bands(ray_range)) << 16
    for heading in range(len(HEADINGS)):
        for odd in range(4):
            x, y = east + 0.5 - 0.5 * (odd & 1), south + 0.5 - 0.5 * (odd >> 1)
            angle = (np.arctan2(-y, x) - np.pi / 4 * heading + np.pi) % (2 * np.pi) - np.pi
            nearest = np.searchsorted(-middles, -angle)
            off, away = angle - angles[nearest], np.hypot(x, y)
            on = (np.abs(np.sin(off)) * away <= config.ray_width) & (np.cos(off) > 0)
            # Rays fall: what is counter-clockwise of one lies between the one before and it.
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
    """Sweeps on a map by ``rays`` rays of some range, in parts of a cell.

    A sweep is made where it may show something (``due``). Where the body has only gone straight on since the
    last one, a ray skips the cells that the last sweep marked or skipped.
    """

    def __init__(
        self, config: PlannerConfig, occupancy: Occupancy, rays: int, ray_range: float, tolerance: float
    ) -> None:
        """Sweep this map. Two ends lie on one line up to ``tolerance`` cells."""
        self.tolerance = tolerance
        self.config, self.occupancy, self.rays, self.bands = config, occupancy, rays, bands(ray_range / FINE)

    @ti.func
    def due(self, time, new, known, straight):
        """Whether a step is one of a sweep, where ``new`` cells were seen in the last step, a target is
        ``known`` or not, and the body went ``straight`` on since the last sweep, or not (-1).
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
        """Mark the floor along a ray that reaches ``far``, and between the last ray and this one, from the
        eye's ``corner`` and one of the fan's poses; ``place`` is the ray's in ``reached``. How many cells
        were never seen, and how far this ray reached in the last sweep, which is ``last_reached`` of the last
        ray."""
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
            skip = tables.skips[row * self.bands + along // ti.static(BAND * FINE)]
            new += self.mark(memory, tables, base, corner, middle + skip, last, far, time)
        if ti.min(far, last_far) > between:
            new += self.mark(memory, tables, base, corner, first, middle, ti.min(far, last_far), time)
        memory.reached[place] = far
        return new, here

    @ti.func
    def skips(self, straight, pose):
        """Whether rays may skip floor. Not after a long step along a diagonal, as bodies make that fill
        cells: behind a wall's end that they go by, rays come to be as long as others were before it.
        """
        over = ti.cast(straight >= 0, ti.i32)
        if ti.static(self.occupancy.touching):
            over &= 1 - ((pose >> 2) & 1)
        return over

    @ti.func
    def mark(self, memory: ti.template(), tables: ti.template(), base, corner, first, last, far, time):
        """Mark the cells of a part of one of the fan's lists that rays reach; how many were never seen."""
        new = 0
        for k in range(first, last):
            if tables.fan[k] >> 16 > far:
                break
            node = self.occupancy.beside(corner, tables.fan[k] & 0xFFFF)
            new += self.occupancy.unseen(self.occupancy.see(memory, base, node, 0, time))
        return new

    @ti.func
    def wall(self, memory: ti.template(), base, eye, end, before, both, time):
        """Mark what a ray ends on; and where the last ray ended on something too (``both``) and the two ends
        lie on one line, the wall between them. How many cells were not known to be occupied.
        """
        hits = self.occupancy.hit(memory, base, eye[0] + end[0], eye[1] + end[1], time)
        gap = ti.abs(end - before)
        if both & (gap.max() < self.occupancy.wall_gap) & (gap.min() < self.tolerance):
            pieces = ti.cast(ti.ceil(gap.max()), ti.i32)
            for k in range(1, pieces):
                part = eye + before + (end - before) * ti.cast(k, ti.f32) / ti.cast(pieces, ti.f32)
                hits += self.occupancy.hit(memory, base, part[0], part[1], time)
        return hits
