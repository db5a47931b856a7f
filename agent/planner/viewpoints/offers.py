"""Offers: the viewpoints of a choice, apart from each other, for a chooser that weighs them otherwise.

The first is the one that the planner chose. The others are those with most gain for their cost, as far as the
kept gains are right, none near to another; of these the gain is computed again.
"""

from agent.planner.config import CERTAIN, PlannerConfig
from agent.planner.mapping.occupancy import Occupancy
from agent.planner.viewpoints.candidates import NOT_COMPUTED
from sim.runtime import ti

NAMES = (
    "node",  # where it is
    "look",  # its heading
    "distance",  # nodes of the path there
    "cost",  # steps, the turns and a constant among them: what the gain is divided by
    "gain",  # candidates that it shows
)
OFFER = len(NAMES)
OF = {name: k for k, name in enumerate(NAMES)}
"""The numbers of an offer, and where each is."""

CHOICE = 2
"""Numbers of a choice: how many offers, and whether the body can go forward."""


@ti.data_oriented
class Offers:
    """At most so many, ``most``."""

    def __init__(self, config: PlannerConfig, occupancy: Occupancy, most: int) -> None:
        self.config, self.occupancy, self.most = config, occupancy, most

    @ti.func
    def begin(self, memory: ti.template(), e, forward):
        """No choice was made as yet."""
        memory.offered[CHOICE * e] = 0.0
        memory.offered[CHOICE * e + 1] = ti.cast(forward, ti.f32)

    @ti.func
    def number(self, memory: ti.template(), e):
        """How many there are."""
        return ti.cast(memory.offered[CHOICE * e], ti.i32)

    @ti.func
    def forward(self, memory: ti.template(), e):
        """Whether the rays leave the body room to go forward."""
        return ti.cast(memory.offered[CHOICE * e + 1], ti.i32)

    @ti.func
    def at(self, e, slot):
        """Where an offer begins."""
        return (e * self.most + slot) * OFFER

    @ti.func
    def taken(self, memory: ti.template(), e, slot):
        """The node, the heading and the distance of an offer."""
        at = self.at(e, slot)
        return (
            ti.cast(memory.offers[at], ti.i32),
            ti.cast(memory.offers[at + 1], ti.i32),
            ti.cast(memory.offers[at + 2], ti.i32),
        )

    @ti.func
    def note(self, viewpoints: ti.template(), memory: ti.template(), tables: ti.template(), state, base,
             listed, best, goal, look, within):  # fmt: skip
        """Note the choice of ``goal``, whose gain for its cost is ``best``, and others of the viewpoints that
        are ``listed``; none where no view was chosen.
        """
        e, number = base // self.occupancy.area, 0
        if look >= 0:
            self.describe(viewpoints, memory, tables, state, base, self.at(e, 0), goal, look, within)
            number = 1
            found = 1
            while found & (number < self.most):
                found = 0
                worth, node, far = best * self.config.offer_share, 0, 0
                for k in range(1, listed):
                    there = ti.cast(memory.queue[base + 2 * k], ti.i32)
                    distance = ti.cast(memory.queue[base + 2 * k + 1], ti.i32)
                    place = viewpoints.candidates.place(
                        self.occupancy.across(there), self.occupancy.down(there)
                    )
                    gain = memory.gains[viewpoints.candidates.part(base) + place]
                    if gain < NOT_COMPUTED:
                        shown = ti.min(ti.cast(gain, ti.f32), ti.static(CERTAIN * self.config.gain_most))
                        hoped = shown / viewpoints.candidates.steps(distance)
                        if hoped > worth:  # noqa: SIM102 - ``and`` would compute both sides
                            if self.apart(memory, e, number, there):
                                worth, node, far, found = hoped, there, distance, 1
                if found:
                    self.describe(viewpoints, memory, tables, state, base, self.at(e, number), node, -1, far)
                    number += 1
        memory.offered[CHOICE * e] = ti.cast(number, ti.f32)

    @ti.func
    def apart(self, memory: ti.template(), e, number, node):
        """Whether a node is far enough from those that were noted, along an axis at least (i32)."""
        clear, x, y = 1, self.occupancy.across(node), self.occupancy.down(node)
        for slot in range(number):
            other = ti.cast(memory.offers[self.at(e, slot)], ti.i32)
            far = ti.max(
                ti.abs(self.occupancy.apart(x, self.occupancy.across(other))),
                ti.abs(self.occupancy.apart(y, self.occupancy.down(other))),
            )
            clear &= ti.cast(far >= self.config.offer_apart, ti.i32)
        return clear

    @ti.func
    def describe(self, viewpoints: ti.template(), memory: ti.template(), tables: ti.template(), state, base,
                 at, node, look, distance):  # fmt: skip
        """Write the numbers of a viewpoint, with the heading ``look``, or at -1 with the best one."""
        gains = ti.Vector([0.0] * 8)
        for octant in ti.static(range(8)):
            gains[octant] = viewpoints.gain(memory, tables, base, node, octant, 0)[0] / CERTAIN
        bearing = state.heading
        if distance > 0:
            bearing = viewpoints.bearing(
                2 * self.occupancy.apart(self.occupancy.across(node), state.x >> 1) - (state.x & 1),
                2 * self.occupancy.apart(self.occupancy.down(node), state.y >> 1) - (state.y & 1),
            )
        way, best, most = viewpoints.candidates.steps(distance), -1.0, ti.static(float(self.config.gain_most))
        for h in ti.static(range(8)):
            gain = ti.min(most, gains[h] + gains[(h + 1) % 8] + gains[(h + 7) % 8])
            turns = viewpoints.turns(state.heading, bearing) + viewpoints.turns(bearing, h)
            cost = way + ti.cast(turns, ti.f32)
            if ((look < 0) & (gain / cost > best)) | (look == h):
                best = gain / cost
                memory.offers[at + 1] = h
                memory.offers[at + 3] = cost
                memory.offers[at + 4] = gain
        memory.offers[at] = ti.cast(node, ti.f32)
        memory.offers[at + 2] = ti.cast(distance, ti.f32)
