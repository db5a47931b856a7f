"""What is believed of where targets lie: how likely a place is to hide one, before it was looked at.

Two things are learnt while an episode goes on. Ground that was never seen may be no floor at all: the inside
of furniture, of a wall, or of the garden. And targets may keep to the space that the episode began in, or out
of it: each pick-up tells which, by Bayes's rule. In 320 validation houses the second is worth 0.028 +- 0.005
of the oracle's targets in secondary rooms, and costs 0.011 +- 0.004 where targets lie in all rooms.
"""

from agent.planner.cells import FLAGS, OCCUPIED, WAYS, Grid
from sim.runtime import ti

SURE = 100
"""What a place counts that was seen to be free floor, unseen since the last pick-up."""

ODDS = (0, 0, 0, 0, 0, 0, 0, 7, 23, 38, 57, 63, 76, 87, 87, 87, 87)
"""What one counts that was never seen, by the number of the eight directions in which the first cell known is
floor, less those in which it is occupied, -8 to 8. Of 16,107 such places, in 100 training houses with an
explorer in them, this part of ``SURE`` could hide a target, as against those that had been seen before
(``python -m benchmarks.odds``).
"""

ABOUT = 9
"""Cells that are looked at in each direction."""

SLIP = 0.05
"""How often a pick-up is taken for one in another space than it was in."""

ELSEWHERE = 0.5
"""Share of all floor that lies beyond the space of the start."""

WIDE = 120
"""Cells that the space of the start may reach from it."""


@ti.data_oriented
class Belief:
    """The belief of a map on this grid."""

    def __init__(self, grid: Grid) -> None:
        """Believe on this grid."""
        self.grid = grid

    @ti.func
    def odds(self, cells: ti.template(), base, x, y):
        """What a node counts as a hiding place, if it is one: 0 to ``SURE``."""
        odds = SURE
        if ti.cast(cells[base + self.grid.at(x, y)], ti.i32) < 1 << FLAGS:
            floor = 0
            for k in ti.static(range(8)):
                dx, dy = WAYS[k][0], WAYS[k][1]
                # A node is the corner of four cells: the first one in a direction begins there.
                i, j, known, t = x - (dx < 0), y - (dy < 0), 0, 1
                while (known >> FLAGS == 0) & (t <= ABOUT):
                    known = ti.cast(cells[base + self.grid.at(i + t * dx, j + t * dy)], ti.i32)
                    t += 1
                if known & OCCUPIED:
                    floor -= 1
                elif known >> FLAGS:
                    floor += 1
            for k in ti.static(range(17)):
                if floor == k - 8:
                    odds = ODDS[k]
        return odds

    @ti.func
    def home(self, cells: ti.template(), base):
        """The space that the episode began in, as far as it was seen: the rectangle about the start that
        grows to all sides until a cell is occupied or all are unknown. West, east, north, south, inclusive.
        """
        box, grows = ti.Vector([-1, 0, -1, 0]), ti.Vector([1, 1, 1, 1])
        while grows.max() > 0:
            for side in ti.static(range(4)):
                if grows[side]:
                    at = box[side] + ti.static((-1, 1, -1, 1)[side])
                    seen, taken = 0, 0
                    along = ti.static(2 * (1 - side // 2))
                    for k in range(box[along], box[along + 1] + 1):
                        cell = 0
                        if ti.static(side < 2):
                            cell = ti.cast(cells[base + self.grid.at(at, k)], ti.i32)
                        else:
                            cell = ti.cast(cells[base + self.grid.at(k, at)], ti.i32)
                        taken |= cell & OCCUPIED
                        seen |= cell >> FLAGS
                    if (taken == 0) & (seen > 0) & (ti.abs(at) < WIDE):
                        box[side] = at
                    else:
                        grows[side] = 0
        return box

    @ti.func
    def within(self, box, x, y):
        """Whether a node lies in a box of cells (i32)."""
        i, j = self.grid.apart(x, 0), self.grid.apart(y, 0)
        return ti.cast((i > box[0]) & (i <= box[1]) & (j > box[2]) & (j <= box[3]), ti.i32)

    @ti.func
    def shares(self, here, found):
        """What is left of the odds of places in the space of the start, and of those elsewhere, after so many
        pick-ups ``here`` of all ``found``: the greater is 1. Targets lie here, elsewhere, or in both, each as
        likely at first, and then in all places there alike.
        """
        there = found - here
        small, large = ti.static(ELSEWHERE), ti.static(1 - ELSEWHERE)
        only_here = ti.pow((1 - SLIP) / large, ti.cast(here, ti.f32)) * ti.pow(
            SLIP / small, ti.cast(there, ti.f32)
        )
        only_there = ti.pow(SLIP / large, ti.cast(here, ti.f32)) * ti.pow(
            (1 - SLIP) / small, ti.cast(there, ti.f32)
        )
        one, other = only_here / large + 1.0, only_there / small + 1.0
        most = ti.max(one, other)
        return ti.Vector([one / most, other / most])
