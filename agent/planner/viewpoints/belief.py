"""Where targets are likely to lie: how much each candidate place counts, before it was looked at.

Two things are estimated while an episode goes on. Ground that was never seen may be no floor at all: the
inside of furniture, of a wall, or of the garden. And targets may lie in the room that the episode began in,
or outside it: each pick-up is evidence for one of the two, by Bayes's rule.
"""

from agent.planner.config import CERTAIN, PlannerConfig
from agent.planner.mapping.occupancy import FLAGS, OCCUPIED, Occupancy
from sim.actions import HEADINGS
from sim.runtime import ti

COUNT = 127
"""Bits of ``prior``: what a block counts, 0 to ``CERTAIN``."""

PATH = 128
"""Bit of ``prior``: a body is believed to be able to stand there, so that it may be a viewpoint."""

WALL, BLOCKED = 8, 255
"""Of ``prior``: from this bit on, the probability that sight which reaches a block ends there, from 0 to
``BLOCKED``, which is 1."""


@ti.data_oriented
class Belief:
    """What is believed of places on a map."""

    def __init__(self, config: PlannerConfig, occupancy: Occupancy, prior: bool = False) -> None:
        """``prior``: what places count is given, by a network or by a study that knows the house."""
        self.config, self.occupancy, self.prior = config, occupancy, prior

    @ti.func
    def odds(self, memory: ti.template(), base, x, y):
        """What a node counts as a candidate, if it is one: 0 to ``CERTAIN``."""
        odds = CERTAIN
        if ti.static(self.prior):
            odds = ti.cast(memory.prior[self.block(base, self.occupancy.at(x, y))], ti.i32) & COUNT
        elif ti.cast(memory.cells[base + self.occupancy.at(x, y)], ti.i32) < 1 << FLAGS:
            floor = self.floor(memory, base, x, y)
            for k in ti.static(range(17)):
                if floor == k - 8:
                    odds = self.config.floor_odds[k]
        return odds

    @ti.func
    def block(self, base, node):
        """The place in ``prior`` of the block that a node is in."""
        x, y = self.occupancy.across(node) >> 1, self.occupancy.down(node) >> 1
        return (base >> 2) + ((y << ti.static(self.occupancy.bits - 1)) | x)

    @ti.func
    def sight(self, memory: ti.template(), base, node):
        """The probability that sight which reaches a node passes it, where the node was never seen: 0 to 1
        (f32).
        """
        wall = ti.cast(memory.prior[self.block(base, node)], ti.i32) >> WALL
        unseen = ti.cast(memory.cells[base + node], ti.i32) < 1 << FLAGS
        return 1.0 - ti.select(unseen, ti.cast(wall, ti.f32), 0.0) / BLOCKED

    @ti.func
    def stands(self, memory: ti.template(), base, node):
        """Whether a body is known, or believed, to be able to stand at a node (i32)."""
        stands = ti.cast(ti.cast(memory.cells[base + node], ti.i32) >= 1 << FLAGS, ti.i32)
        if ti.static(self.prior):
            stands |= ti.cast(memory.prior[self.block(base, node)] & ti.u16(PATH) != 0, ti.i32)
        return stands

    @ti.func
    def floor(self, memory: ti.template(), base, x, y):
        """In how many of the eight directions the first known cell is floor, less those in which it is
        occupied.
        """
        floor = 0
        for k in ti.static(range(8)):
            dx, dy = HEADINGS[k][0], HEADINGS[k][1]
            # A node is the corner of four cells: the first one in a direction begins there.
            i, j, known, t = x - (dx < 0), y - (dy < 0), 0, 1
            while (known >> FLAGS == 0) & (t <= self.config.odds_range):
                known = ti.cast(memory.cells[base + self.occupancy.at(i + t * dx, j + t * dy)], ti.i32)
                t += 1
            if known & OCCUPIED:
                floor -= 1
            elif known >> FLAGS:
                floor += 1
        return floor

    @ti.func
    def start_room(self, memory: ti.template(), base):
        """The room that the episode began in, as far as it was seen: the rectangle about the start that
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
                            cell = ti.cast(memory.cells[base + self.occupancy.at(at, k)], ti.i32)
                        else:
                            cell = ti.cast(memory.cells[base + self.occupancy.at(k, at)], ti.i32)
                        taken |= cell & OCCUPIED
                        seen |= cell >> FLAGS
                    if (taken == 0) & (seen > 0) & (ti.abs(at) < ti.static(self.config.start_room)):
                        box[side] = at
                    else:
                        grows[side] = 0
        return box

    @ti.func
    def within(self, box, x, y):
        """Whether a node lies in a box of cells (i32)."""
        i, j = self.occupancy.apart(x, 0), self.occupancy.apart(y, 0)
        return ti.cast((i > box[0]) & (i <= box[1]) & (j > box[2]) & (j <= box[3]), ti.i32)

    @ti.func
    def shares(self, here, found):
        """What is left of the odds of places in the start room, and of those elsewhere, after ``here`` of
        ``found`` pick-ups were in it: the greater is 1. Targets lie here, elsewhere, or in both, each as
        likely at first, and then in all places there alike.
        """
        if ti.static(self.prior):  # what places count says so
            here, found = 0, 0
        there = found - here
        slip = ti.static(self.config.pick_up_error)
        small, large = ti.static(self.config.floor_elsewhere), ti.static(1 - self.config.floor_elsewhere)
        only_here = ti.pow((1 - slip) / large, ti.cast(here, ti.f32)) * ti.pow(
            slip / small, ti.cast(there, ti.f32)
        )
        only_there = ti.pow(slip / large, ti.cast(here, ti.f32)) * ti.pow(
            (1 - slip) / small, ti.cast(there, ti.f32)
        )
        one, other = only_here / large + 1.0, only_there / small + 1.0
        most = ti.max(one, other)
        return ti.Vector([one / most, other / most])
