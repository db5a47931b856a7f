# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false
# pyright: reportOptionalCall=false, reportIndexIssue=false, reportArgumentType=false
"""Views on the map: the place and heading to go to, from which a look would show most hiding places for its
way. The searcher (``sim.searcher``) goes by the same rule, but knows the house; a map knows its own cells.

The numbers below were chosen on 160 validation houses, by targets in secondary rooms, but for ``THOUGHT``,
``GROWTH`` and ``SPARE``: these in 320 others, where they change nothing but the cost. In those an
explorer that goes by them picks up 0.65 of the oracle's targets (``python -m benchmarks.explorers``;
``docs/agent-notes.md`` has what other numbers and rules are worth).
"""

import numpy as np

from agent.map.belief import ABOUT, SURE, Belief
from agent.map.cells import DEPTH, FLAGS, OCCUPIED, SOLID, Grid
from agent.map.counts import COUNTS, FOUND, HEADING, HERE, SINCE, X, Y
from agent.map.flood import NODES, OPEN, UNASKED, Flood
from agent.map.ways import DETOUR
from sim.runtime import ti

PITCH = 4
"""Nodes between the places that it may go to for a look: all that are multiples of this power of two."""

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

HASTE = 4.0
"""Steps added to a way's length when looks are compared: what a few steps cost is not all that they cost."""

TRIED = 128
"""Bit of a hiding place that a look should have shown by the map's cells, but did not: it counts for none."""

GROWTH, SPARE = 1.2, 50
"""A view is taken to show at most so many times what it did when it was looked at last, and so much more, in
parts of ``SURE``: half a hiding place."""

BETWEEN = 1.3
"""A view between others, at most so many times what the best of these does, and ``SPARE`` more: so it is
looked first from every other place along both axes."""

UNTOLD = (1 << 16) - 1
"""What is kept of a view that was not looked at since ``retry``."""

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
        if PITCH < 4 or PITCH & (PITCH - 1):
            raise ValueError(f"PITCH must be a power of two, 4 or more, not {PITCH}")
        if max(DEPTH, ABOUT) > NODES - 2:
            raise ValueError(
                f"DEPTH and ABOUT must be {NODES - 2} at most: news are told to tiles side by side"
            )
        self.grid, self.flood, self.belief = grid, Flood(grid), Belief(grid)
        self.area, self.places = grid.area >> 2, grid.area // PITCH**2
        # Of the queue the first part has places that it may go to and how far away they are, then there are
        # hiding places, and then the tiles that the flood comes to.
        self.hiding, self.agenda = grid.area >> 2, grid.area >> 1

    @ti.func
    def at(self, node):
        """The place in its environment's part of ``hidden`` of the block that a node is in."""
        x, y = self.grid.across(node) >> 1, self.grid.down(node) >> 1
        return (y << ti.static(self.grid.bits - 1)) | x

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
        nearest, within, total, likely, number, hiding = self.survey(
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
                way = self.steps(distance)
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
                        shown[part + self.place(x, y)] = ti.cast(ti.min(highest, float(UNTOLD - 1)), ti.u16)
        for k in range(hiding):
            i = first + ti.cast(queue[base + self.hiding + k], ti.i32)
            hidden[i] = hidden[i] & ti.cast(TRIED, ti.u8)
        return goal, look, within + DETOUR

    @ti.func
    def bound(self, shown: ti.template(), part, x, y, most, finer):
        """What the best look from a node may show, of what there is at ``most``; 0 where it is not to be
        looked from in this turn. Nodes between others, if it was not looked from there yet, are left for the
        ``finer`` one.
        """
        last, bound = ti.cast(shown[part + self.place(x, y)], ti.f32), most
        if (x | y) & (PITCH - 1) != 0:
            bound = ti.select(finer, 0.0, most)
        elif last < UNTOLD:
            bound = ti.select(finer, 0.0, GROWTH * last + SPARE)
        elif (x | y) & (2 * PITCH - 1) != 0:
            bound = 0.0
            if finer:
                about = -1.0
                for j, i in ti.static(ti.ndrange((-1, 2), (-1, 2))):
                    beside = part + self.place(
                        (x + i * PITCH) & self.grid.mask, (y + j * PITCH) & self.grid.mask
                    )
                    if shown[beside] < UNTOLD:
                        about = ti.max(about, ti.cast(shown[beside], ti.f32))
                bound = ti.select(about < 0, most, BETWEEN * about + SPARE)
        return bound

    @ti.func
    def survey(
        self,
        cells: ti.template(),
        queue: ti.template(),
        news: ti.template(),
        tiles: ti.template(),
        guesses: ti.template(),
        hidden: ti.template(),
        shown: ti.template(),
        counts: ti.template(),
        e,
    ):
        """Find how far away all places are and what may hide there, by blocks: the nearest hiding place, -1
        for none, and how far that is; what those count that were not tried; which of the places that it may
        go to for a look is the one from which most for its way was shown last, -1 for none; and how many of
        these and of hiding places were noted in the queue.
        """
        w, base, first, part = e * COUNTS, e * self.grid.area, e * self.area, e * self.places
        px, py = counts[w + X], counts[w + Y]
        nearest, within, total, likely, hoped, hiding = -1, 0, 0, -1, 0.0, 0
        home, shares = self.belief.home(cells, base), self.belief.shares(counts[w + HERE], counts[w + FOUND])
        flooded, these, those = (
            e * self.flood.words,
            base + self.agenda,
            base + self.agenda + self.flood.number,
        )
        self.flood.begin(tiles, news, guesses, base, flooded)
        tail, body = self.source(cells, queue, tiles, base, flooded, px, py)
        queue[base], queue[base + 1] = ti.cast(body, ti.u16), ti.cast(0, ti.u16)
        number, level = 1, 0
        while tail > 0:
            risen = 0
            for k in range(tail):
                tile = ti.cast(queue[these + k], ti.i32)
                rising = self.flood.settle(tiles, flooded, tile)
                if rising != 0:
                    queue[these + risen] = ti.cast(tile, ti.u16)
                    risen += 1
                    self.flood.know(cells, tiles, base, flooded, tile)
                    rising &= tiles[self.flood.at(flooded, OPEN, tile)]
                while rising != 0:
                    block = ti.cast(ti.math.popcnt((rising & -rising) - ti.u64(1)), ti.i32)
                    rising &= rising - ti.u64(1)
                    node = self.flood.node(tile, block)
                    x, y = self.grid.across(node), self.grid.down(node)
                    odds = self.odds(cells, guesses, base, tile, block, counts[w + SINCE])
                    if odds >= 0:
                        share = ti.select(self.belief.within(home, x, y), shares[0], shares[1])
                        count, i = ti.cast(ti.ceil(share * odds), ti.i32), self.at(node)
                        if (nearest < 0) & (count > 0):
                            nearest, within = node, 2 * level
                        if hidden[first + i] == 0:
                            hidden[first + i] = ti.cast(count, ti.u8)
                            queue[base + self.hiding + hiding] = ti.cast(i, ti.u16)
                            total += count
                            hiding += 1
                    if (x | y) & (PITCH - 1) == 0 and level > 0 and cells[base + node] >> FLAGS != 0:
                        away = ti.max(
                            ti.abs(self.grid.apart(x, px >> 1)), ti.abs(self.grid.apart(y, py >> 1))
                        )
                        distance = ti.max(2 * level - 1, away)
                        last = ti.cast(shown[part + self.place(x, y)], ti.f32)
                        worth = last / self.steps(distance)
                        if (last < UNTOLD) & (worth > hoped):
                            likely, hoped = number, worth
                        queue[base + 2 * number] = ti.cast(node, ti.u16)
                        queue[base + 2 * number + 1] = ti.cast(distance, ti.u16)
                        number += 1
            tail = 0
            for k in range(risen):
                tile = ti.cast(queue[these + k], ti.i32)
                tail = self.flood.rise(cells, tiles, queue, base, flooded, those, tile, tail)
            these, those = those, these
            level += 1
        return nearest, within, total, likely, number, hiding

    @ti.func
    def odds(self, cells: ti.template(), guesses: ti.template(), base, tile, block, since):
        """What a block's first node counts as a hiding place, -1 if it is none. Where next to nothing of it
        was ever seen that is kept, as it stays so while there are no news.
        """
        k = self.flood.guess(base, tile) + block
        odds = ti.cast(guesses[k], ti.i32)
        if odds == UNASKED:
            odds = -1
            node = self.flood.node(tile, block)
            x, y = self.grid.across(node), self.grid.down(node)
            if self.grid.hides(cells, base, x, y, since):
                odds = self.belief.odds(cells, base, x, y)
                if self.grid.hides(cells, base, x, y, 1):
                    guesses[k] = ti.cast(odds, ti.u8)
        return odds

    @ti.func
    def source(self, cells: ti.template(), queue: ti.template(), tiles: ti.template(), base, flooded, px, py):
        """Let the flood begin at the body: on the nodes within half a cell and those beside them, as far as
        they are open. How many tiles there are in the agenda, and one of the body's nodes.
        """
        tail, here = 0, self.grid.at(px >> 1, py >> 1)
        for k in range(4):
            x, y = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            if not self.grid.solid(cells, base, x, y):
                here = self.grid.at(x, y)
            for h in range(5):
                i = x + ti.select(h == 1, 1, 0) - ti.select(h == 2, 1, 0)
                j = y + ti.select(h == 3, 1, 0) - ti.select(h == 4, 1, 0)
                node = self.grid.at(i, j)
                if h == 0 or self.grid.open(cells, base, node):
                    tile, bit = self.grid.tile(node), self.flood.bit(node)
                    tail = self.flood.pour(tiles, queue, flooded, base + self.agenda, tile, bit, tail)
        return tail, here

    @ti.func
    def steps(self, distance):
        """What it costs to go so many nodes, but for the turns."""
        return ti.static(2.0 / self.grid.step) * ti.cast(distance, ti.f32) + HASTE

    @ti.func
    def place(self, x, y):
        """The place in its environment's part of ``shown`` of a node that it may go to for a look."""
        return (y // PITCH) * ti.static(self.grid.side // PITCH) + x // PITCH

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
                    i = first + self.at(there)
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
