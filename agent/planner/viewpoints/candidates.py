"""Candidates: the places where a target may lie, and the viewpoints from which they may be seen, each with
its distance from the body, as far as the body can reach."""

from agent.planner.config import PlannerConfig
from agent.planner.mapping.occupancy import Occupancy
from agent.planner.viewpoints.belief import Belief
from agent.planner.viewpoints.reachability import OPEN, UNKNOWN, DistanceField
from sim.runtime import ti

NOT_COMPUTED = (1 << 16) - 1
"""The gain of a viewpoint from which none was computed since ``Viewpoints.forget``."""


@ti.data_oriented
class Candidates:
    """Lists of what can be reached on a map. Of ``queue`` the first part has the viewpoints and their
    distances; from ``listed`` on there are candidates, from ``front`` on the distance field's tiles.
    """

    def __init__(self, config: PlannerConfig, occupancy: Occupancy, belief: Belief) -> None:
        self.config, self.occupancy, self.belief = config, occupancy, belief
        self.field, self.pitch = DistanceField(occupancy), config.viewpoint_pitch
        self.area, self.places = occupancy.area >> 2, occupancy.area // self.pitch**2
        self.listed, self.front = occupancy.area >> 2, occupancy.area >> 1

    @ti.func
    def at(self, node):
        """The place in its environment's part of ``candidates`` of the block that a node is in."""
        x, y = self.occupancy.across(node) >> 1, self.occupancy.down(node) >> 1
        return (y << ti.static(self.occupancy.bits - 1)) | x

    @ti.func
    def steps(self, distance):
        """The cost in steps of a path of ``distance`` nodes, but for the turns."""
        return ti.static(2.0 / self.occupancy.step) * ti.cast(distance, ti.f32) + self.config.viewpoint_cost

    @ti.func
    def place(self, x, y):
        """The place in its environment's part of ``gains`` of a viewpoint's node."""
        return (y // self.pitch) * ti.static(self.occupancy.side // self.pitch) + x // self.pitch

    @ti.func
    def first(self, base):
        """Where an environment's part of ``candidates`` begins."""
        return base >> 2

    @ti.func
    def part(self, base):
        """Where an environment's part of ``gains`` begins."""
        return base >> ti.static(2 * (self.pitch.bit_length() - 1))

    @ti.func
    def collect(self, memory: ti.template(), state, base):
        """Compute the distances of all blocks from the body, and list what can be reached: candidates and
        viewpoints. Returns the nearest candidate, -1 for none, and its distance; what the candidates count
        that were not tried; the viewpoint whose gain for its cost was the greatest when it was computed last,
        -1 for none; how many viewpoints there are; and how many candidates.
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
        memory.queue[base] = ti.cast(body, self.occupancy.number)
        memory.queue[base + 1] = ti.cast(0, self.occupancy.number)
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
                        memory.queue[base + 2 * number] = ti.cast(node, self.occupancy.number)
                        memory.queue[base + 2 * number + 1] = ti.cast(distance, self.occupancy.number)
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
        """What a block's first node counts as a candidate, -1 if it is none. Where next to nothing of it was
        ever seen that is kept, as it stays so while its tile is not dirty.
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
