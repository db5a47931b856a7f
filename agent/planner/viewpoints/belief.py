"""Belief about targets: the weight of each candidate place before it is looked at.

A planner estimates two things during an episode. First, ground that was never seen may not be floor: it may
be inside furniture, a wall or the garden. Second, targets may lie in the room where the episode began, or
outside it. Each pick-up is evidence for one of the two, by Bayes' rule.
"""

from vitruvius.agent.planner.core.config import CERTAIN, PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import FLAGS, OCCUPIED, Occupancy
from vitruvius.sim.actions import HEADINGS
from vitruvius.sim.runtime import ti

COUNT = 127
"""Bits of ``prior`` with a block's weight, 0 to ``CERTAIN``."""

PATH = 128
"""Bit of ``prior``, set if a body is believed to be able to stand in the block, so that it may be a
viewpoint."""

WALL, BLOCKED = 8, 255
"""First bit of ``prior`` with the probability that sight which reaches a block ends there, and its value for
probability 1."""


@ti.data_oriented
class Belief:
    """Beliefs about places on a map."""

    def __init__(self, config: PlannerConfig, occupancy: Occupancy, prior: bool = False) -> None:
        """Use the array ``prior`` for weights, if true: a network or a study fills it."""
        self.config, self.occupancy, self.prior = config, occupancy, prior

    @ti.func
    def odds(self, memory: ti.template(), base, x, y):
        """Return the weight of a node as a candidate, if it is one: 0 to ``CERTAIN``."""
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
        """Return the index in ``prior`` of the block of a node."""
        x, y = self.occupancy.across(node) >> 1, self.occupancy.down(node) >> 1
        return (base >> 2) + ((y << ti.static(self.occupancy.bits - 1)) | x)

    @ti.func
    def sight(self, memory: ti.template(), base, node):
        """Return the probability (f32) that sight which reaches a node passes it: 1 if the node was seen."""
        wall = ti.cast(memory.prior[self.block(base, node)], ti.i32) >> WALL
        unseen = ti.cast(memory.cells[base + node], ti.i32) < 1 << FLAGS
        return 1.0 - ti.select(unseen, ti.cast(wall, ti.f32), 0.0) / BLOCKED

    @ti.func
    def stands(self, memory: ti.template(), base, node):
        """Return 1 (i32) if a body is known, or believed, to be able to stand at a node."""
        stands = ti.cast(ti.cast(memory.cells[base + node], ti.i32) >= 1 << FLAGS, ti.i32)
        if ti.static(self.prior):
            stands |= ti.cast(memory.prior[self.block(base, node)] & ti.u16(PATH) != 0, ti.i32)
        return stands

    @ti.func
    def floor(self, memory: ti.template(), base, x, y):
        """Return how many directions first meet known floor, minus how many first meet an occupied cell."""
        floor = 0
        for k in ti.static(range(8)):
            dx, dy = HEADINGS[k][0], HEADINGS[k][1]
            # A node is the corner of four cells; the first cell in a direction begins there.
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
        """Return the box of the room in which the episode began, as far as it was seen.

        The box grows from the start to all sides until a cell is occupied or all are unknown. Returns its
        cells west, east, north and south, inclusive.
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
        """Return 1 (i32) if a node lies in a box of cells."""
        i, j = self.occupancy.apart(x, 0), self.occupancy.apart(y, 0)
        return ti.cast((i > box[0]) & (i <= box[1]) & (j > box[2]) & (j <= box[3]), ti.i32)

    @ti.func
    def shares(self, here, found):
        """Return the factors on the weights of places in the start room and elsewhere.

        ``here`` of ``found`` pick-ups were in the start room. A priori, targets lie in the start room,
        elsewhere or in both with equal probability, and uniformly over the places there. The larger factor is
        1.
        """
        if ti.static(self.prior):  # the prior's weights include this
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
