"""Next best view: the viewpoint, a place and a heading, with most information gain for its cost.

The gain is the number of candidates that the view would show. The searcher (``searcher``) uses the same rule,
but knows the house; a planner knows its own map.
"""

import numpy as np

from vitruvius.agent.planner.core.config import CERTAIN, PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import OCCUPIED, SOLID, Occupancy
from vitruvius.agent.planner.viewpoints.candidates import NOT_COMPUTED, Candidates
from vitruvius.sim.runtime import ti

TRIED = 128
"""Bit of a candidate that, by the map, a view should have shown but did not: it no longer counts."""


def views(config: PlannerConfig) -> np.ndarray:
    """Return the places on a view's rays, octant by octant.

    The places are offsets (n,) int32 from a node, in the form that ``Occupancy.beside`` takes.
    """
    rays = config.viewpoint_rays
    aside = (np.arange(rays) - rays // 2) / rays
    angles = (np.pi / 4 * (np.arange(8)[:, None] + aside)).reshape(-1, 1)
    along = config.view_stride * np.arange(1, config.view_range // config.view_stride + 1)
    x, y = (np.rint(along * way).astype(np.int32) for way in (np.cos(angles), -np.sin(angles)))
    return (((y & 0xFF) << 8) | (x & 0xFF)).ravel()


@ti.data_oriented
class Viewpoints:
    """Choice of a viewpoint.

    ``candidates`` holds the weight of each candidate during a choice, and the bit of those tried; ``gains``
    holds the gain of the best view from each viewpoint when it was last computed.

    Between two pick-ups a gain mostly falls. So a choice computes only the gains that may still exceed the
    best for their cost, as in Minoux's "Accelerated greedy algorithms for maximizing submodular set
    functions" (1978). In Minoux's setting gains only fall. Here new ground can raise a gain, so a choice may
    miss, until the next pick-up, what opens up in a view that was worth little. A choice first computes the
    gain of every other viewpoint along both axes. It computes those between only if their neighbours show
    that they may be the best.
    """

    def __init__(
        self, config: PlannerConfig, occupancy: Occupancy, candidates: Candidates, drives: bool = False
    ) -> None:
        """Choose on this map.

        ``drives``: the body looks along an eighth of a turn only if it is ``aligned``.
        """
        self.drives = drives
        self.config, self.occupancy = config, occupancy
        self.candidates, self.pitch = candidates, candidates.pitch
        self.places = config.view_range // config.view_stride
        # Each place on a ray stands for stride by stride cells, and is as wide as the gap between rays there.
        self.weight = config.view_stride**2 * np.pi / 4 / config.viewpoint_rays / 4

    @ti.func
    def forget(self, memory: ti.template(), base):
        """Forget all gains and which candidates were tried.

        This happens in a new episode, after a pick-up, or if no candidate is left.
        """
        for k in range(ti.static(self.candidates.area)):
            memory.candidates[self.candidates.first(base) + k] = ti.cast(0, ti.u8)
        for k in range(ti.static(self.candidates.places)):
            memory.gains[self.candidates.part(base) + k] = ti.cast(NOT_COMPUTED, ti.u16)

    @ti.func
    def choose(self, memory: ti.template(), tables: ti.template(), state, base):
        """Return the viewpoint to go to, a node and a heading, and a bound on the length of the path.

        The viewpoint is the node that was seen with most information gain for its cost, as far as the kept
        gains are right. If no viewpoint shows enough, the result is the nearest candidate and -1; without a
        candidate, -1 for both.
        """
        nearest, within, total, likely, number, listed = self.candidates.collect(memory, state, base)
        total -= self.try_here(memory, tables, state, base)
        most = ti.cast(ti.min(total, ti.static(CERTAIN * self.config.gain_most)), ti.f32)
        least = ti.static(CERTAIN * self.config.gain_least)
        goal, look, best = nearest, -1, 0.0
        for finer in range(2):
            # The likeliest best viewpoint comes first (-1), so that fewer must be computed.
            head, going = ti.select((likely >= 0) & (finer == 0), -1, 0), 1
            while (head < number) & going:
                node, distance = self.candidates.viewpoint(memory, base, ti.select(head < 0, likely, head))
                head += 1
                way = self.candidates.steps(distance)
                # Viewpoints come in order of their distance, to a step or two: none from here on can be
                # better than the best.
                if most <= ti.max(best * way, least):
                    going = 0
                elif self.bound(memory, base, node, most, finer) > best * way:
                    worth, heading = self.best_look(memory, tables, base, state, node, distance, most, best)
                    if heading >= 0:
                        best, goal, look, within = worth, node, heading, distance
        self.candidates.unlist(memory, base, listed, TRIED)
        return goal, look, within + self.config.path_slack

    @ti.func
    def try_here(self, memory: ti.template(), tables: ti.template(), state, base):
        """Mark the candidates that the body sees now as tried; return the weight of those newly tried."""
        here, tried = self.occupancy.at(state.x >> 1, state.y >> 1), 0
        for k in range(3):
            # A body that drives looks along its own octant (k = 1) alone, except if it is aligned.
            shown = 1
            if ti.static(self.drives):
                shown = ti.cast((k == 1) | (state.aligned > 0), ti.i32)
            if shown:
                tried += self.gain(memory, tables, base, here, (state.heading + k + 7) & 7, 1)[1]
        return tried

    @ti.func
    def best_look(
        self, memory: ti.template(), tables: ti.template(), base, state, node, distance, most, best
    ):
        """Keep the gain of a viewpoint; return the worth of its best heading, and that heading.

        A view is three octants, its gain at most ``most``, and its worth the gain per step of the way there,
        turns included. Without a heading of more worth than ``best``, the result is ``best`` and -1.
        """
        x, y = self.occupancy.across(node), self.occupancy.down(node)
        gains = ti.Vector([0.0] * 8)
        for octant in ti.static(range(8)):
            gains[octant] = self.gain(memory, tables, base, node, octant, 0)[0]
        bearing, highest, look, way = state.heading, 0.0, -1, self.candidates.steps(distance)
        if distance > 0:  # the body arrives at about this heading
            bearing = self.bearing(
                2 * self.occupancy.apart(x, state.x >> 1) - (state.x & 1),
                2 * self.occupancy.apart(y, state.y >> 1) - (state.y & 1),
            )
        for h in ti.static(range(8)):
            shows = gains[h] + gains[(h + 1) % 8] + gains[(h + 7) % 8]
            highest, gain = ti.max(highest, shows), ti.min(most, shows)
            turns = self.turns(state.heading, bearing) + self.turns(bearing, h)
            worth = gain / (way + ti.cast(turns, ti.f32))
            there = (distance == 0) & (turns == 0)
            if (gain >= ti.static(CERTAIN * self.config.gain_least)) & (worth > best) & (not there):
                best, look = worth, h
        if (x | y) & (self.pitch - 1) == 0:  # the body's own node may lie between the viewpoints
            memory.gains[self.candidates.part(base) + self.candidates.place(x, y)] = ti.cast(
                ti.min(highest, float(NOT_COMPUTED - 1)), ti.u16
            )
        return best, look

    @ti.func
    def bound(self, memory: ti.template(), base, node, most, finer):
        """Return a bound on what the best view from a node may show, of ``most`` in all.

        The bound is 0 if no gain is to be computed in this pass. Viewpoints between others, without a kept
        gain, are left for the ``finer`` pass.
        """
        part, x, y = self.candidates.part(base), self.occupancy.across(node), self.occupancy.down(node)
        last, bound = ti.cast(memory.gains[part + self.candidates.place(x, y)], ti.f32), most
        if (x | y) & (self.pitch - 1) != 0:
            bound = ti.select(finer, 0.0, most)
        elif last < NOT_COMPUTED:
            bound = ti.select(finer, 0.0, self.config.gain_growth * last + self.config.gain_spare)
        elif (x | y) & (2 * self.pitch - 1) != 0:
            bound = 0.0
            if finer:
                about = -1.0
                for j, i in ti.static(ti.ndrange((-1, 2), (-1, 2))):
                    beside = part + self.candidates.place(
                        (x + i * self.pitch) & self.occupancy.mask, (y + j * self.pitch) & self.occupancy.mask
                    )
                    if memory.gains[beside] < NOT_COMPUTED:
                        about = ti.max(about, ti.cast(memory.gains[beside], ti.f32))
                between = self.config.gain_between * about + self.config.gain_spare
                bound = ti.select(about < 0, most, between)
        return bound

    @ti.func
    def gain(self, memory: ti.template(), tables: ti.template(), base, node, octant, try_: ti.template()):
        """Return the information gain of an octant from a node.

        The gain is the weight of the candidates that the octant's rays meet, each multiplied by the ground
        about it, as far as the next ray. ``try_`` marks these candidates as tried. The second value is the
        weight of those newly tried. With a prior, sight may end wherever there may be a wall: a candidate
        counts by the probability that the ray reaches it.
        """
        prior = ti.static(self.candidates.belief.prior)
        gain, count = ti.static(0.0 if prior else 0), 0
        rays = ti.static(self.config.viewpoint_rays)
        places = ti.static(self.places)
        for ray in range(rays):
            j, k, clear, reaches = places * (rays * octant + ray), 0, 1, 1.0
            if ti.static(prior):  # the viewpoint itself may be on unseen ground
                reaches = self.candidates.belief.sight(memory, base, node)
            while clear & (k < places):
                there = self.occupancy.beside(node, tables.views[j + k])
                k += 1
                stops = ti.cast(memory.cells[base + there], ti.i32) & (OCCUPIED | SOLID)
                share = reaches
                if ti.static(prior):
                    reaches *= self.candidates.belief.sight(memory, base, there)
                if (stops != 0) | (reaches < self.config.view_least):
                    clear = 0
                else:
                    i = self.candidates.first(base) + self.candidates.at(there)
                    here = ti.cast(memory.candidates[i], ti.i32) & (TRIED - 1)
                    if ti.static(prior):
                        gain += share * ti.cast(k * here, ti.f32)
                    else:
                        gain += k * here
                    if ti.static(try_) and here > 0:
                        count += here
                        memory.candidates[i] = ti.cast(TRIED, ti.u8)
        return ti.cast(gain, ti.f32) * ti.static(self.weight), count

    @ti.func
    def bearing(self, dx, dy):
        """Return the heading nearest to a direction east and south."""
        across, down = ti.abs(dx), ti.abs(dy)
        heading = 0
        # The tangent of 22.5 degrees is 0.4142.
        if 10000 * down > 4142 * across:
            heading = ti.select(10000 * across > 4142 * down, 1, 2)
        if dx < 0:
            heading = 4 - heading
        if dy > 0:
            heading = -heading & 7
        return heading

    @ti.func
    def turns(self, one, other):
        """Return the number of turns from one heading to another."""
        away = (one - other) & 7
        return ti.min(away, 8 - away)
