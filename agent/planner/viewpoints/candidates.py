"""Candidates and viewpoints: places where a target may lie, and places from which to see them.

Each has its distance from the body, as far as the body can reach.
"""

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.viewpoints.belief import Belief
from vitruvius.agent.planner.viewpoints.reachability import OPEN, UNKNOWN, DistanceField
from vitruvius.sim.runtime import ti

NOT_COMPUTED = (1 << 16) - 1
"""Value of a gain that was not computed since ``Viewpoints.forget``."""


@ti.data_oriented
class Candidates:
    """Lists of the places within reach on a map.

    Three lists share an environment's part of ``queue``, which is free while no path is searched:

    - from 0 on, two numbers for each viewpoint: its node and its distance;
    - from ``listed`` on, the blocks of candidates;
    - from ``front`` on, the tiles that the front of the distance field reaches now, and after as many numbers
      as there are tiles, those that it reaches next.
    """

    def __init__(self, config: PlannerConfig, occupancy: Occupancy, belief: Belief) -> None:
        self.config, self.occupancy, self.belief = config, occupancy, belief
        self.field, self.pitch = DistanceField(occupancy), config.viewpoint_pitch
        self.area, self.places = occupancy.area >> 2, occupancy.area // self.pitch**2
        self.listed, self.front = occupancy.area >> 2, occupancy.area >> 1

    @ti.func
    def at(self, node):
        """Return the index of a node's block in its environment's part of ``candidates``."""
        x, y = self.occupancy.across(node) >> 1, self.occupancy.down(node) >> 1
        return (y << ti.static(self.occupancy.bits - 1)) | x

    @ti.func
    def steps(self, distance):
        """Return the cost in steps of a path of ``distance`` nodes, without the turns."""
        return ti.static(2.0 / self.occupancy.step) * ti.cast(distance, ti.f32) + self.config.viewpoint_cost

    @ti.func
    def place(self, x, y):
        """Return the index of a viewpoint's node in its environment's part of ``gains``."""
        return (y // self.pitch) * ti.static(self.occupancy.side // self.pitch) + x // self.pitch

    @ti.func
    def first(self, base):
        """Return the first index of an environment's part of ``candidates``."""
        return base >> 2

    @ti.func
    def part(self, base):
        """Return the first index of an environment's part of ``gains``."""
        return base >> ti.static(2 * (self.pitch.bit_length() - 1))

    @ti.func
    def viewpoint(self, memory: ti.template(), base, k):
        """Return the node of the k-th viewpoint of the list, and its distance."""
        at = base + 2 * k
        return ti.cast(memory.queue[at], ti.i32), ti.cast(memory.queue[at + 1], ti.i32)

    @ti.func
    def list_viewpoint(self, memory: ti.template(), base, k, node, distance):
        """Make a node the k-th viewpoint of the list."""
        memory.queue[base + 2 * k] = ti.cast(node, self.occupancy.number)
        memory.queue[base + 2 * k + 1] = ti.cast(distance, self.occupancy.number)

    @ti.func
    def unlist(self, memory: ti.template(), base, listed, kept: ti.template()):
        """Clear the weights of the ``listed`` candidates, except for the bit ``kept``."""
        for k in range(listed):
            i = self.first(base) + ti.cast(memory.queue[base + self.listed + k], ti.i32)
            memory.candidates[i] = memory.candidates[i] & ti.cast(kept, ti.u8)

    @ti.func
    def collect(self, memory: ti.template(), state, base):
        """Compute the distances of all blocks from the body; list the candidates and viewpoints within reach.

        Returns six numbers:

        - the nearest candidate, -1 for none, and its distance;
        - the sum of the weights of candidates that were not tried;
        - the viewpoint with the greatest last gain for its cost, -1 for none;
        - the number of viewpoints, and the number of candidates.
        """
        first, part, px, py = self.first(base), self.part(base), state.x, state.y
        nearest, within, total, likely, hoped, listed_count = -1, 0, 0, -1, 0.0, 0
        room, shares = (
            self.belief.start_room(memory, base),
            self.belief.shares(state.found_here, state.found),
        )
        these, those = base + self.front, base + self.front + self.field.number
        self.field.begin(memory, base)
        tail, body = self.field.source(memory, base, these, px, py)
        self.list_viewpoint(memory, base, 0, body, 0)
        number, level = 1, 0
        while tail > 0:
            moved = 0
            for k in range(tail):
                tile = ti.cast(memory.queue[these + k], ti.i32)
                latest = self.field.settle(memory, base, tile)
                if latest != 0:
                    memory.queue[these + moved] = ti.cast(tile, self.occupancy.number)
                    moved += 1
                    self.field.connect(memory, base, tile)
                    latest &= memory.tiles[self.field.at(base, OPEN, tile)]
                while latest != 0:
                    # The lowest bit that is set: the ones below it count its place, then it is cleared.
                    block = ti.cast(ti.math.popcnt((latest & -latest) - ti.u64(1)), ti.i32)
                    latest &= latest - ti.u64(1)
                    node = self.field.node(tile, block)
                    x, y = self.occupancy.across(node), self.occupancy.down(node)
                    odds = self.odds(memory, base, tile, block, state.since)
                    if odds >= 0:
                        share = ti.select(self.belief.within(room, x, y), shares[0], shares[1])
                        count, i = ti.cast(ti.ceil(share * odds), ti.i32), self.at(node)
                        if (nearest < 0) & (count > 0):
                            nearest, within = node, 2 * level
                        if memory.candidates[first + i] == 0:
                            memory.candidates[first + i] = ti.cast(count, ti.u8)
                            memory.queue[base + self.listed + listed_count] = ti.cast(
                                i, self.occupancy.number
                            )
                            total += count
                            listed_count += 1
                    pitched = (x | y) & (self.pitch - 1) == 0
                    if pitched and level > 0 and self.belief.stands(memory, base, node):
                        away = ti.max(
                            ti.abs(self.occupancy.apart(x, px >> 1)), ti.abs(self.occupancy.apart(y, py >> 1))
                        )
                        distance = ti.max(2 * level - 1, away)
                        last = ti.cast(memory.gains[part + self.place(x, y)], ti.f32)
                        worth = last / self.steps(distance)
                        if (last < NOT_COMPUTED) & (worth > hoped):
                            likely, hoped = number, worth
                        self.list_viewpoint(memory, base, number, node, distance)
                        number += 1
            tail = 0
            for k in range(moved):
                tile = ti.cast(memory.queue[these + k], ti.i32)
                tail = self.field.spread(memory, base, those, tile, tail)
            these, those = those, these
            level += 1
        return nearest, within, total, likely, number, listed_count

    @ti.func
    def odds(self, memory: ti.template(), base, tile, block, since):
        """Return the weight of a block's first node as a candidate, -1 if it is none.

        The weight of a block that is almost wholly unseen is kept: it stays the same while its tile is not
        dirty.
        """
        k = self.field.of_tile(base, tile) + block
        odds = ti.cast(memory.odds[k], ti.i32)
        if odds == UNKNOWN:
            odds = -1
            node = self.field.node(tile, block)
            x, y = self.occupancy.across(node), self.occupancy.down(node)
            if self.occupancy.hides(memory, base, x, y, since):
                odds = self.belief.odds(memory, base, x, y)
                if self.occupancy.hides(memory, base, x, y, 1):
                    memory.odds[k] = ti.cast(odds, ti.u8)
        return odds
