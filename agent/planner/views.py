"""Views on the map: the place and heading to go to, from which a look would show most hiding places for its
way. The searcher (``sim.searcher``) goes by the same rule, but knows the house; a map knows its own cells.

The numbers below and the survey's were chosen on 160 validation houses, by targets in secondary rooms; but
``THOUGHT``, ``GROWTH``, ``SPARE`` and ``BETWEEN`` in 320 others, where they change nothing but the cost. In
those an explorer that goes by them picks up 0.65 of the oracle's targets
(``python -m benchmarks.explorers``; ``docs/agent-notes.md`` has what other numbers and rules are worth).
"""

import numpy as np

from agent.planner.belief import SURE
from agent.planner.cells import OCCUPIED, SOLID, Grid
from agent.planner.counts import COUNTS, HEADING, X, Y
from agent.planner.survey import PITCH, UNTOLD, Survey
from agent.planner.ways import DETOUR
from sim.runtime import ti

RAYS = 5
"""Rays of a look in each octant, at even angles: a look is three octants, 135 degrees, much as the eye's."""

STRIDE, REACH = 2, 54
"""Cells between two places on a ray that are looked at, and the last one: some 7.7 m, the eye's range."""

LOOKED = REACH // STRIDE
"""Places on a ray that are looked at."""

PLENTY = 600
"""Hiding places, of one node in four, beyond which a look is worth no more."""

LEAST = 2.0
"""A look that would show fewer is not worth its way: rather go to the nearest place itself."""

TRIED = 128
"""Bit of a hiding place that a look should have shown by the map's cells, but did not: it counts for none."""

GROWTH, SPARE = 1.2, 50
"""A view is taken to show at most so many times what it did when it was looked at last, and so much more, in
parts of ``SURE``: half a hiding place."""

BETWEEN = 1.3
"""A view between others, at most so many times what the best of these does, and ``SPARE`` more: so it is
looked first from every other place along both axes."""

THOUGHT = 32
"""Steps until it thinks again: what it saw on its way may have made another view better."""


def looks() -> np.ndarray:
    """Of a look's rays, octant by octant: ways (8 RAYS LOOKED,) int32 from a node to those it looks at, as
    ``Grid.beside`` takes them.
    """
    aside = (np.arange(RAYS) - RAYS // 2) / RAYS
    angles = (np.pi / 4 * (np.arange(8)[:, None] + aside)).reshape(-1, 1)
    along = STRIDE * np.arange(1, LOOKED + 1)
    x, y = (np.rint(along * way).astype(np.int32) for way in (np.cos(angles), -np.sin(angles)))
    return (((y & 0xFF) << 8) | (x & 0xFF)).ravel()


@ti.data_oriented
class Views:
    """The choice of a view. ``hidden`` has a byte for each even node: what a hiding place there counts while
    a choice is made, nothing otherwise, and whether it was tried; ``rays`` are ``looks()``. ``shown`` has for
    each place that it may go to what the best look from there showed, when it was looked at on the map last.

    Between two pick-ups a view mostly comes to show less. So a choice looks only from where it may still show
    more for its way than the best, as in Minoux's "Accelerated greedy algorithms for maximizing submodular
    set functions" (1978). There gains only fall; here new ground can raise one, and what opens in sight of a
    view of little worth may be missed until the next pick-up. And it looks first from every other place along
    both axes, and between them only where those tell that it may be worth it. In 320 validation houses the
    first costs nothing (+0.001 +- 0.001 of the oracle's targets), nor does the second (+0.001 +- 0.002).
    """

    def __init__(self, grid: Grid) -> None:
        """Choose on this grid."""
        self.grid, self.survey = grid, Survey(grid)
        self.area, self.places = self.survey.area, self.survey.places

    @ti.func
    def retry(self, hidden: ti.template(), shown: ti.template(), e):
        """Forget what was tried, and what views showed: in a new episode, after a pick-up, or where nothing
        is left to look for.
        """
        for k in range(ti.static(self.area)):
            hidden[e * ti.static(self.area) + k] = ti.cast(0, ti.u8)
        for k in range(ti.static(self.places)):
            shown[e * ti.static(self.places) + k] = ti.cast(UNTOLD, ti.u16)

    @ti.func
    def choose(
        self,
        cells: ti.template(),
        queue: ti.template(),
        news: ti.template(),
        tiles: ti.template(),
        guesses: ti.template(),
        hidden: ti.template(),
        shown: ti.template(),
        rays: ti.template(),
        counts: ti.template(),
        e,
    ):
        """The view to go to, a node and a heading: of those on nodes that were seen the one that would show
        most hiding places for its way, as far as what is kept of them tells. Where none would show enough,
        the nearest hiding place and -1; where there is none, -1 for both. Then how long ways there may be.
        """
        # Where this environment's part of counts, cells, hidden and shown begins.
        w, base, first, part = e * COUNTS, e * self.grid.area, e * self.area, e * self.places
        px, py, heading = counts[w + X], counts[w + Y], counts[w + HEADING]
        nearest, within, total, likely, number, hiding = self.survey.take(
            cells, queue, news, tiles, guesses, hidden, shown, counts, e
        )
        for k in range(3):
            here = self.grid.at(px >> 1, py >> 1)
            total -= self.gain(cells, base, hidden, rays, first, here, (heading + k + 7) & 7, 1)[1]
        most = ti.cast(ti.min(total, SURE * PLENTY), ti.f32)
        goal, look, best = nearest, -1, 0.0
        for finer in range(2):
            # First (-1) from where it is most likely to be best, so that there is less to look at.
            head, going = ti.select((likely >= 0) & (finer == 0), -1, 0), 1
            while (head < number) & going:
                k = ti.select(head < 0, likely, head)
                head += 1
                node, distance = (
                    ti.cast(queue[base + 2 * k], ti.i32),
                    ti.cast(queue[base + 2 * k + 1], ti.i32),
                )
                x, y = self.grid.across(node), self.grid.down(node)
                way = self.survey.steps(distance)
                # So far away, no view can be worth more than the best one, but for a step or two: that is how
                # exactly places are in turn.
                if most <= ti.max(best * way, SURE * LEAST):
                    going = 0
                elif self.bound(shown, part, x, y, most, finer) > best * way:
                    gains = ti.Vector([0.0] * 8)
                    for octant in ti.static(range(8)):
                        gains[octant] = self.gain(cells, base, hidden, rays, first, node, octant, 0)[0]
                    bearing, highest = heading, 0.0
                    if distance > 0:
                        bearing = self.bearing(
                            2 * self.grid.apart(x, px >> 1) - (px & 1),
                            2 * self.grid.apart(y, py >> 1) - (py & 1),
                        )
                    for h in ti.static(range(8)):
                        shows = gains[h] + gains[(h + 1) % 8] + gains[(h + 7) % 8]
                        highest, gain = ti.max(highest, shows), ti.min(most, shows)
                        turns = self.turns(heading, bearing) + self.turns(bearing, h)
                        worth = gain / (way + ti.cast(turns, ti.f32))
                        there = (distance == 0) & (turns == 0)
                        if (gain >= SURE * LEAST) & (worth > best) & (not there):
                            best, goal, look, within = worth, node, h, distance
                    if (x | y) & (PITCH - 1) == 0:
                        shown[part + self.survey.place(x, y)] = ti.cast(
                            ti.min(highest, float(UNTOLD - 1)), ti.u16
                        )
        for k in range(hiding):
            i = first + ti.cast(queue[base + self.survey.hiding + k], ti.i32)
            hidden[i] = hidden[i] & ti.cast(TRIED, ti.u8)
        return goal, look, within + DETOUR

    @ti.func
    def bound(self, shown: ti.template(), part, x, y, most, finer):
        """What the best look from a node may show, of what there is at ``most``; 0 where it is not to be
        looked from in this turn. Nodes between others, if it was not looked from there yet, are left for the
        ``finer`` one.
        """
        last, bound = ti.cast(shown[part + self.survey.place(x, y)], ti.f32), most
        if (x | y) & (PITCH - 1) != 0:
            bound = ti.select(finer, 0.0, most)
        elif last < UNTOLD:
            bound = ti.select(finer, 0.0, GROWTH * last + SPARE)
        elif (x | y) & (2 * PITCH - 1) != 0:
            bound = 0.0
            if finer:
                about = -1.0
                for j, i in ti.static(ti.ndrange((-1, 2), (-1, 2))):
                    beside = part + self.survey.place(
                        (x + i * PITCH) & self.grid.mask, (y + j * PITCH) & self.grid.mask
                    )
                    if shown[beside] < UNTOLD:
                        about = ti.max(about, ti.cast(shown[beside], ti.f32))
                bound = ti.select(about < 0, most, BETWEEN * about + SPARE)
        return bound

    @ti.func
    def gain(
        self,
        cells: ti.template(),
        base,
        hidden: ti.template(),
        rays: ti.template(),
        first,
        node,
        octant,
        try_: ti.template(),
    ):
        """What hiding places count that the rays of an octant meet from a node: each stands for the ground
        about it, as far as the next. With ``try_`` these are tried now: what they counted.
        """
        gain, count = 0, 0
        for ray in range(RAYS):
            j, k, clear = LOOKED * (RAYS * octant + ray), 0, 1
            while clear & (k < LOOKED):
                there = self.grid.beside(node, rays[j + k])
                k += 1
                if ti.cast(cells[base + there], ti.i32) & (OCCUPIED | SOLID):
                    clear = 0
                else:
                    i = first + self.survey.at(there)
                    here = ti.cast(hidden[i], ti.i32) & (TRIED - 1)
                    gain += k * here
                    if ti.static(try_ == 1) and here > 0:
                        count += here
                        hidden[i] = ti.cast(TRIED, ti.u8)
        # A place stands for 2 by 2 cells, as wide as rays are apart there.
        return ti.cast(gain, ti.f32) * ti.static(STRIDE * STRIDE * np.pi / 4 / RAYS / 4), count

    @ti.func
    def bearing(self, dx, dy):
        """The heading that is nearest to a way east and south."""
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
        """Turns from one heading to another."""
        away = (one - other) & 7
        return ti.min(away, 8 - away)
