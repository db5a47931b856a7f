"""Paths on the map: breadth-first search over nodes, from a goal to the body and a little further.

A diagonal step goes equally far along both axes, so all eight neighbours of a node are at distance one. Nodes
near to seen cells that are not known to be solid count as free: the body finds out on its way.
"""

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.sim.runtime import ti

UNREACHED = (1 << 16) - 1
"""Distance of a node that no search has reached."""


@ti.data_oriented
class Paths:
    """Searches on a map: ``distance`` holds the distances of nodes, ``queue`` the nodes that were reached."""

    def __init__(self, config: PlannerConfig, occupancy: Occupancy) -> None:
        self.config, self.occupancy = config, occupancy

    @ti.func
    def forget(self, memory: ti.template(), base, tail):
        """Clear the distances of the last search, whose queue ends at ``tail``."""
        for k in range(tail):
            memory.distance[base + ti.cast(memory.queue[base + k], ti.i32)] = ti.cast(UNREACHED, ti.u16)

    @ti.func
    def reached(self, memory: ti.template(), base, node):
        """Return 1 if the last search has reached a node."""
        return ti.cast(ti.cast(memory.distance[base + node], ti.i32) < UNREACHED, ti.i32)

    @ti.func
    def push(self, memory: ti.template(), base, node, distance, tail):
        """Reach a node for the first time; return the queue's new end."""
        memory.distance[base + node] = ti.cast(distance, ti.u16)
        memory.queue[base + tail] = ti.cast(node, self.occupancy.number)
        return tail + 1

    @ti.func
    def spread(self, memory: ti.template(), base, node, tail):
        """Reach the neighbours of a node, diagonal ones only past two free corners; return the new end."""
        x, y = self.occupancy.across(node), self.occupancy.down(node)
        distance = ti.cast(memory.distance[base + node], ti.i32) + 1
        free = ti.Vector([0, 0, 0, 0])
        for k in ti.static(range(4)):
            dx, dy = (1, 0, -1, 0)[k], (0, 1, 0, -1)[k]
            beside = self.occupancy.at(x + dx, y + dy)
            # Reached nodes are free, except where the search began: usually nothing else must be read.
            free[k] = self.reached(memory, base, beside)
            if free[k] == 0 and self.occupancy.open(memory, base, beside):
                free[k] = 1
                tail = self.push(memory, base, beside, distance, tail)
        for k in ti.static(range(4)):
            dx, dy = (1, -1, -1, 1)[k], (1, 1, -1, -1)[k]
            if free[k] & free[(k + 1) % 4]:
                beside = self.occupancy.at(x + dx, y + dy)
                if not self.reached(memory, base, beside) and self.occupancy.open(memory, base, beside):
                    tail = self.push(memory, base, beside, distance, tail)
        return tail

    @ti.func
    def measure(self, memory: ti.template(), base, goal, off, radius, within, px, py):
        """Write the distances of nodes from a goal; return the queue's end.

        The search begins at the free nodes that are less than ``radius`` cells from the goal along both axes;
        the goal lies ``off`` its node. If none is free, the radius grows. The search ends a little beyond the
        body, and visits only nodes that may lie on a path of ``within`` nodes.
        """
        tail, x, y = 0, self.occupancy.across(goal), self.occupancy.down(goal)
        for wider in range(4):
            if tail == 0:
                span = radius + ti.cast(wider, ti.f32)
                wide = ti.cast(ti.ceil(span), ti.i32)
                for j in range(-wide, wide + 1):
                    for i in range(-wide, wide + 1):
                        away = ti.abs(ti.Vector([ti.cast(i, ti.f32), ti.cast(j, ti.f32)]) - off).max()
                        if (away < span) and not self.occupancy.solid(memory, base, x + i, y + j):
                            tail = self.push(memory, base, self.occupancy.at(x + i, y + j), 0, tail)
        head, last = 0, UNREACHED
        while head < tail:
            node = ti.cast(memory.queue[base + head], ti.i32)
            distance = ti.cast(memory.distance[base + node], ti.i32)
            if distance > last:
                break
            head += 1
            away_x = ti.abs(self.occupancy.apart(self.occupancy.across(node), px >> 1))
            away_y = ti.abs(self.occupancy.apart(self.occupancy.down(node), py >> 1))
            away = ti.max(away_x, away_y)
            if away <= 1:
                last = ti.min(last, distance + self.config.path_beyond)
            if distance + away <= within:
                tail = self.spread(memory, base, node, tail)
        return tail

    @ti.func
    def turns(self, memory: ti.template(), base, px, py, heading):
        """Return the number of 45-degree turns on a path from a pose in half cells to the goal.

        The path goes straight on while that leads nearer, and then turns as little as possible.
        """
        x, y, left = px >> 1, py >> 1, UNREACHED
        for k in range(4):
            i, j = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            distance = ti.cast(memory.distance[base + self.occupancy.at(i, j)], ti.i32)
            if distance < left:
                x, y, left = i, j, distance
        turns, going = 0, ti.cast(left < UNREACHED, ti.i32)
        for _ in range(self.config.path_turns):
            if going & (left > 0):
                going = 0
                for k in ti.static(range(8)):
                    # Straight on first, then turns of 1, 2 and 3 eighths to either side, then back.
                    if going == 0:
                        side = (heading + (0, 1, 7, 2, 6, 3, 5, 4)[k]) & 7
                        way = self.occupancy.ahead(side)
                        dx, dy = way[0], way[1]
                        there = self.occupancy.at(x + dx, y + dy)
                        open_ = ti.cast(memory.distance[base + there], ti.i32) == left - 1
                        if open_ and dx * dy != 0:
                            open_ = not (
                                self.occupancy.solid(memory, base, x + dx, y)
                                | self.occupancy.solid(memory, base, x, y + dy)
                            )
                        if open_:
                            x, y, left, heading, going = x + dx, y + dy, left - 1, side, 1
                            turns += (k + 1) // 2
        return turns

    @ti.func
    def far(self, memory: ti.template(), base, px, py):
        """Return the distance of a pose from the goal, in half cells, or ``UNREACHED``."""
        best = UNREACHED
        for k in range(4):
            x, y = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            distance = ti.cast(memory.distance[base + self.occupancy.at(x, y)], ti.i32)
            if distance < UNREACHED:
                best = ti.min(best, 2 * distance + ti.max(ti.abs(2 * x - px), ti.abs(2 * y - py)))
        return best
