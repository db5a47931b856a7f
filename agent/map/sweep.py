# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false
# pyright: reportOptionalCall=false, reportIndexIssue=false, reportArgumentType=false
"""A sweep of the rays: the floor that they pass is noted as seen, and what they end on as occupied.

Sweeps are much of what a map costs, so it makes as few as tell it the same. Where the body goes straight on
and sees nothing new, every other step does; while it goes to a target that it knows, every fourth, as all
floor counts as unseen once that is picked up. And where it has only gone straight on since the last sweep, a
ray passes over what that one noted. Together these change what an explorer picks up by -0.0002 +- 0.0014 of
the oracle's targets, in 320 validation houses.
"""

from agent.map.cells import Grid
from agent.map.fan import BAND, FINE, bands
from sim.runtime import ti

SPARE = 1.0
"""Cells before the end of the last sweep from which on the floor is noted again, besides the way since."""


@ti.data_oriented
class Sweep:
    """Sweeps on a grid by so many rays of some reach, in parts of a cell. ``starts``, ``passed`` and ``fan``
    are those of ``agent.map.fan``; ``reached`` has how far each environment's rays reached in its last sweep.
    """

    def __init__(self, grid: Grid, rays: int, reach: float) -> None:
        """Sweep this grid."""
        self.grid, self.rays, self.bands = grid, rays, bands(reach / FINE)

    @ti.func
    def due(self, time, new, known, straight):
        """Whether a step is one of a sweep: ``new`` cells were seen in the last one, a target is ``known`` or
        not, and it went ``straight`` on since the last sweep, or not (-1).
        """
        every = ti.select(known, 4, 2)
        return ti.cast((new > 0) | (time % every == 1) | ((straight < 0) & (known == 0)), ti.i32)

    @ti.func
    def floor(
        self,
        cells: ti.template(),
        news: ti.template(),
        starts: ti.template(),
        passed: ti.template(),
        fan: ti.template(),
        reached: ti.template(),
        e,
        corner,
        pose,
        ray,
        far,
        before,
        had,
        straight,
        time,
    ):
        """Note the floor along a ray that reaches so ``far``, and between the ray ``before``, that reaches so
        far and ``had`` in the last sweep, and it, from the eye's ``corner`` and one of the fan's poses: how
        many cells are new, and how far this one had reached.
        """
        base, place = e * self.grid.area, e * self.rays + ray
        row, new, own, between = pose * self.rays + ray, 0, 0, 0
        first, middle, last = starts[2 * row - (ray > 0)], starts[2 * row], starts[2 * row + 1]
        have = reached[place]
        if straight >= 0:
            # On a diagonal the way is longer than along either axis.
            again = ti.static(int(FINE * SPARE)) + ti.static(3 * FINE // 4) * straight
            between = ti.min(have, had)
            own = ti.max(ti.min(between, reached[place + (ray + 1 < self.rays)]) - again, 0)
            between -= again
        if far > own:
            skip = passed[row * self.bands + own // ti.static(BAND * FINE)]
            new += self.note(cells, news, fan, base, corner, middle + skip, last, far, time)
        if ti.min(far, before) > between:
            new += self.note(cells, news, fan, base, corner, first, middle, ti.min(far, before), time)
        reached[place] = far
        return new, have

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
        """Note the cells of a part of one of the fan's lists that rays reach; how many are new."""
        new = 0
        for k in range(first, last):
            if fan[k] >> 16 > reach:
                break
            node = self.grid.beside(corner, fan[k] & 0xFFFF)
            new += self.grid.new(self.grid.see(cells, news, base, node, 0, time))
        return new

    @ti.func
    def wall(self, cells: ti.template(), news: ti.template(), base, eye, end, before, two, time):
        """Note what a ray ends on, and the wall from where the ray ``before`` does, if it does (``two``) and
        both lie on one line: how many cells were not known to be occupied.
        """
        hits, gap = (
            self.grid.hit(cells, news, base, eye[0] + end[0], eye[1] + end[1], time),
            ti.abs(end - before),
        )
        if two & (gap.max() < self.grid.widest) & (gap.min() < 1e-3):
            pieces = ti.cast(ti.ceil(gap.max()), ti.i32)
            for k in range(1, pieces):
                part = eye + before + (end - before) * ti.cast(k, ti.f32) / ti.cast(pieces, ti.f32)
                hits += self.grid.hit(cells, news, base, part[0], part[1], time)
        return hits
