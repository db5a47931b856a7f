"""What a planner advises: the turn to the heading from which a step brings the goal nearest."""

from agent.planner.mapping.occupancy import Occupancy
from agent.planner.paths import FAR, Paths
from sim.actions import FORWARD, LEFT, RIGHT
from sim.runtime import ti


@ti.data_oriented
class Advice:
    """Advice to a body on a map, by the paths to its goal."""

    def __init__(self, occupancy: Occupancy, paths: Paths) -> None:
        self.occupancy, self.paths, self.step = occupancy, paths, occupancy.step

    @ti.func
    def span(self, px, py):
        """Half cells to look ahead at a pose: a step, or from node to node where that is more."""
        return ti.select((px | py) & 1 == 0, ti.max(2, self.step), self.step)

    @ti.func
    def gains(self, memory: ti.template(), base, px, py, heading, forward):
        """Of a step at each of the eight headings, counter-clockwise from the body's own: how much nearer
        each half cell of it brings the goal, -1 where that is not known or the step is not free. The first
        is not free where the rays say that the body cannot go ``forward``.
        """
        span, far = self.span(px, py), self.paths.far(memory, base, px, py)
        gains = ti.Vector([-1.0] * 8)
        for k in range(8):
            way = self.occupancy.ahead((heading + k) & 7)
            qx, qy = px + span * way[0], py + span * way[1]
            free = self.occupancy.room(memory, base, qx, qy)
            free &= self.occupancy.passes(memory, base, px, py, way[0], way[1], ti.static(self.step))
            if way[0] * way[1] != 0:
                free &= self.occupancy.room(memory, base, qx, py) & self.occupancy.room(memory, base, px, qy)
                if ti.static(self.occupancy.touching):
                    # Nor may a wall lie on any side of the square about the way.
                    for corner in ti.static(range(2)):
                        cx, cy = ti.select(corner, qx, px), ti.select(corner, qy, py)
                        to = 1 - 2 * corner
                        step = ti.static(self.step)
                        free &= self.occupancy.passes(memory, base, cx, cy, to * way[0], 0, step)
                        free &= self.occupancy.passes(memory, base, cx, cy, 0, to * way[1], step)
            if k == 0:
                free &= forward
            there = self.paths.far(memory, base, qx, qy)
            if (free > 0) & (there < FAR) & (far < FAR):
                gains[k] = ti.cast(far - there, ti.f32) / ti.cast(span, ti.f32)
        return gains

    @ti.func
    def turn(self, memory: ti.template(), base, px, py, heading, gains):
        """How far to turn, in eighths counter-clockwise: of the steps that lead nearest to the one with the
        fewest turns before and after it. One where none is known to lead anywhere.
        """
        span, nearest, turn, fewest = self.span(px, py), gains.max(), 1, 1 << 10
        for k in range(8):
            if (nearest > -1.0) & (gains[k] == nearest):
                way = self.occupancy.ahead((heading + k) & 7)
                qx, qy = px + span * way[0], py + span * way[1]
                turns = ti.min(k, 8 - k) + self.paths.turns(memory, base, qx, qy, (heading + k) & 7)
                if turns < fewest:
                    turn, fewest = k, turns
        return turn

    @ti.func
    def action(self, turn):
        """Left, right or forward, to make such a turn."""
        return ti.select(turn == 0, FORWARD, ti.select(turn > 4, RIGHT, LEFT))
