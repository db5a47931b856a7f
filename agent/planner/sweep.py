"""A sweep of the rays: the floor that they pass is noted as seen, and what they end on as occupied.

Sweeps are much of what a map costs, so it makes as few as tell it the same. Where the body goes straight on
and sees nothing new, every other step does; while it goes to a target that it knows, every fourth, as all
floor counts as unseen once that is picked up. And where it has only gone straight on since all was noted, a
ray passes over what the last sweep noted, or passed over itself. Together these change what an explorer picks
up by +0.0001 +- 0.0014 of the oracle's targets, in 320 validation houses.
"""

from agent.planner.cells import Grid
from agent.planner.fan import BAND, FINE, bands
from sim.runtime import ti

MARGIN = 1.0
"""Cells before the end of the last sweep from which on the floor is noted again, besides the way since."""


@ti.data_oriented
class Sweep:
    """Sweeps on a grid by so many rays of some reach, in parts of a cell. ``starts``, ``skips`` and ``fan``
    are those of ``fan.py``; ``swept`` has how far each environment's rays reached in its last sweep.
    """

    def __init__(self, grid: Grid, rays: int, reach: float) -> None:
        """Sweep this grid."""
        self.grid, self.rays, self.bands = grid, rays, bands(reach / FINE)

    @ti.func
    def due(self, time, new, known, straight):
        """Whether a step is one of a sweep, where ``new`` cells were seen in the last step, a target is
        ``known`` or not, and the body went ``straight`` on since the last sweep, or not (-1).
        """
        every = ti.select(known, 4, 2)
        return ti.cast((new > 0) | (time % every == 1) | ((straight < 0) & (known == 0)), ti.i32)

    @ti.func
    def floor(
        self,
        cells: ti.template(),
        news: ti.template(),
        starts: ti.template(),
        skips: ti.template(),
        fan: ti.template(),
        swept: ti.template(),
        e,
        corner,
        pose,
        ray,
        far,
        last_far,
        last_swept,
        straight,
        time,
    ):
        """Note the floor along a ray that reaches so ``far``, and between the last ray and this one, from the
        eye's ``corner`` and one of the fan's poses. How many cells were never seen, and how far this ray
        reached in the last sweep, which is ``last_swept`` of the last ray.
        """
        base, place, row = e * self.grid.area, e * self.rays + ray, pose * self.rays + ray
        first, middle, last = starts[2 * row - (ray > 0)], starts[2 * row], starts[2 * row + 1]
        new, along, between, here = 0, 0, 0, swept[place]
        if self.passes_over(straight, pose):
            # On a diagonal the way is longer than along either axis.
            margin = ti.static(int(FINE * MARGIN)) + ti.static(3 * FINE // 4) * straight
            between = ti.min(here, ti.select(ray > 0, last_swept, here)) - margin
            along = ti.max(ti.min(between, swept[place + (ray + 1 < self.rays)] - margin), 0)
        if far > along:
            skip = skips[row * self.bands + along // ti.static(BAND * FINE)]
            new += self.note(cells, news, fan, base, corner, middle + skip, last, far, time)
        if ti.min(far, last_far) > between:
            new += self.note(cells, news, fan, base, corner, first, middle, ti.min(far, last_far), time)
        swept[place] = far
        return new, here

    @ti.func
    def passes_over(self, straight, pose):
        """Whether rays may pass over floor. Not after a long step along a diagonal, as bodies make that fill
        cells: behind a wall's end that they go by, rays come to be as long as others were before it.
        """
        over = ti.cast(straight >= 0, ti.i32)
        if ti.static(self.grid.touching):
            over &= 1 - ((pose >> 2) & 1)
        return over

    @ti.func
    def note(
        self,
        cells: ti.template(),
        news: ti.template(),
        fan: ti.template(),
        base,
        corner,
        first,
        last,
        reach,
        time,
    ):
        """Note the cells of a part of one of the fan's lists that rays reach; how many were never seen."""
        new = 0
        for k in range(first, last):
            if fan[k] >> 16 > reach:
                break
            node = self.grid.beside(corner, fan[k] & 0xFFFF)
            new += self.grid.unseen(self.grid.see(cells, news, base, node, 0, time))
        return new

    @ti.func
    def wall(self, cells: ti.template(), news: ti.template(), base, eye, end, before, both, time):
        """Note what a ray ends on; and where the last ray ended on something too (``both``) and the two ends
        lie on one line, the wall between them. How many cells were not known to be occupied.
        """
        hits = self.grid.hit(cells, news, base, eye[0] + end[0], eye[1] + end[1], time)
        gap = ti.abs(end - before)
        if both & (gap.max() < self.grid.widest) & (gap.min() < 1e-3):
            pieces = ti.cast(ti.ceil(gap.max()), ti.i32)
            for k in range(1, pieces):
                part = eye + before + (end - before) * ti.cast(k, ti.f32) / ti.cast(pieces, ti.f32)
                hits += self.grid.hit(cells, news, base, part[0], part[1], time)
        return hits
