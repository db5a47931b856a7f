"""A survey of the map, before a view is chosen: how far away all places are, and what may hide at each."""

from agent.planner.belief import ABOUT, Belief
from agent.planner.cells import DEPTH, FLAGS, Grid
from agent.planner.counts import COUNTS, FOUND, HERE, SINCE, X, Y
from agent.planner.flood import NODES, OPEN, UNASKED, Flood
from sim.runtime import ti

PITCH = 4
"""Nodes between the places that it may go to for a look: all that are multiples of this power of two."""

HASTE = 4.0
"""Steps added to a way's length when looks are compared: what a few steps cost is not all that they cost."""

UNTOLD = (1 << 16) - 1
"""What is kept of a view that was not looked at since ``retry``."""


@ti.data_oriented
class Survey:
    """Surveys on a grid. Of ``queue`` the first part has the places that it may go to for a look and how far
    away they are; from ``hiding`` on there are hiding places, from ``agenda`` on the flood's tiles.
    """

    def __init__(self, grid: Grid) -> None:
        """Survey this grid."""
        if PITCH < 4 or PITCH & (PITCH - 1):
            raise ValueError(f"PITCH must be a power of two, 4 or more, not {PITCH}")
        if max(DEPTH, ABOUT) > NODES - 2:
            raise ValueError(
                f"DEPTH and ABOUT must be {NODES - 2} at most: news are told to tiles side by side"
            )
        self.grid, self.flood, self.belief = grid, Flood(grid), Belief(grid)
        self.area, self.places = grid.area >> 2, grid.area // PITCH**2
        self.hiding, self.agenda = grid.area >> 2, grid.area >> 1

    @ti.func
    def at(self, node):
        """The place in its environment's part of ``hidden`` of the block that a node is in."""
        x, y = self.grid.across(node) >> 1, self.grid.down(node) >> 1
        return (y << ti.static(self.grid.bits - 1)) | x

    @ti.func
    def steps(self, distance):
        """What it costs to go so many nodes, but for the turns."""
        return ti.static(2.0 / self.grid.step) * ti.cast(distance, ti.f32) + HASTE

    @ti.func
    def place(self, x, y):
        """The place in its environment's part of ``shown`` of a node that it may go to for a look."""
        return (y // PITCH) * ti.static(self.grid.side // PITCH) + x // PITCH

    @ti.func
    def take(
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
        tail, body = self.flood.source(cells, tiles, queue, base, flooded, these, px, py)
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
