"""Paths on the map: breadth-first over nodes, from a goal to the body and a little further.

A step along a diagonal goes as far along both axes, so all eight neighbours of a node are one apart. What is
near to what was seen and not known to be solid counts as free: the body finds out on its way.
"""

from agent.planner.config import PlannerConfig
from agent.planner.mapping.occupancy import Occupancy
from sim.runtime import ti

FAR = (1 << 16) - 1
"""The distance of a node that no search has reached."""


@ti.data_oriented
class Paths:
    """Searches on a map: ``distance`` holds nodes' distances, ``queue`` the nodes that were reached."""

    def __init__(self, config: PlannerConfig, occupancy: Occupancy) -> None:
        self.config, self.occupancy = config, occupancy

    @ti.func
    def forget(self, memory: ti.template(), base, tail):
        """Take back the last search, whose queue ends at ``tail``."""
        for k in range(tail):
            memory.distance[base + ti.cast(memory.queue[base + k], ti.i32)] = ti.cast(FAR, ti.u16)

    @ti.func
    def reached(self, memory: ti.template(), base, node):
        """Whether the last search has reached a node."""
        return ti.cast(ti.cast(memory.distance[base + node], ti.i32) < FAR, ti.i32)

    @ti.func
    def push(self, memory: ti.template(), base, node, distance, tail):
        """Reach a node for the first time; the queue's new end."""
        memory.distance[base + node] = ti.cast(distance, ti.u16)
        memory.queue[base + tail] = ti.cast(node, self.occupancy.number)
        return tail + 1

    @ti.func
    def spread(self, memory: ti.template(), base, node, tail):
        """Reach the neighbours of a node, diagonal ones only past two free corners; the queue's new end."""
        x, y = self.occupancy.across(node), self.occupancy.down(node)
        distance = ti.cast(memory.distance[base + node], ti.i32) + 1
        free = ti.Vector([0, 0, 0, 0])
        for k in ti.static(range(4)):
            dx, dy = (1, 0, -1, 0)[k], (0, 1, 0, -1)[k]
            beside = self.occupancy.at(x + dx, y + dy)
            # What was reached is free, but for where the search began: mostly no more need be read.
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
        """Distances from a goal's node, and from what is free less than ``radius`` cells from the goal along
        both axes, where it lies ``off`` its node, to all nodes up to the body's and a little further that may
        lie on a path of ``within`` nodes; the queue's end. Where nothing there is free, from further away.
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
        head, last = 0, FAR
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
        """Turns, of 45 degrees each, on a path from a pose in half cells to the goal that goes straight on as
        long as that leads nearer, and then turns as little as it must.
        """
        x, y, left = px >> 1, py >> 1, FAR
        for k in range(4):
            i, j = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            distance = ti.cast(memory.distance[base + self.occupancy.at(i, j)], ti.i32)
            if distance < left:
                x, y, left = i, j, distance
        turns, going = 0, ti.cast(left < FAR, ti.i32)
        for _ in range(self.config.path_turns):
            if going & (left > 0):
                going = 0
                for k in ti.static(range(8)):
                    # Straight on, or a turn to either side, or two, or three, or back.
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
        """Distance of a pose from the goal, in half cells, by the nodes about it; ``FAR`` if unknown."""
        best = FAR
        for k in range(4):
            x, y = (px + (k & 1)) >> 1, (py + (k >> 1)) >> 1
            distance = ti.cast(memory.distance[base + self.occupancy.at(x, y)], ti.i32)
            if distance < FAR:
                best = ti.min(best, 2 * distance + ti.max(ti.abs(2 * x - px), ti.abs(2 * y - py)))
        return best
