"""Advice of a planner: the turn to the heading from which a step brings the goal nearest."""

from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.paths import UNREACHED, Paths
from vitruvius.sim.actions import FORWARD, LEFT, RIGHT
from vitruvius.sim.runtime import ti


@ti.data_oriented
class Advice:
    """Actions for a body on a map, from the paths to its goal."""

    def __init__(self, occupancy: Occupancy, paths: Paths) -> None:
        self.occupancy, self.paths, self.step = occupancy, paths, occupancy.step

    @ti.func
    def span(self, px, py):
        """Return the half cells to look ahead at a pose: a step, or from node to node if that is more."""
        return ti.select((px | py) & 1 == 0, ti.max(2, self.step), self.step)

    @ti.func
    def gains(self, memory: ti.template(), base, px, py, heading, forward):
        """Return how much nearer each half cell of a step brings the goal, for the eight headings.

        Headings count counter-clockwise from the body's own. A gain is -1 if it is unknown or the step is not
        free. The step at the body's own heading is not free if the rays show that the body cannot go
        ``forward``.
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
                    # On each side of the square about the way, too, no wall may lie.
                    for corner in ti.static(range(2)):
                        cx, cy = ti.select(corner, qx, px), ti.select(corner, qy, py)
                        to = 1 - 2 * corner
                        step = ti.static(self.step)
                        free &= self.occupancy.passes(memory, base, cx, cy, to * way[0], 0, step)
                        free &= self.occupancy.passes(memory, base, cx, cy, 0, to * way[1], step)
            if k == 0:
                free &= forward
            there = self.paths.far(memory, base, qx, qy)
            if (free > 0) & (there < UNREACHED) & (far < UNREACHED):
                gains[k] = ti.cast(far - there, ti.f32) / ti.cast(span, ti.f32)
        return gains

    @ti.func
    def turn(self, memory: ti.template(), base, px, py, heading, gains):
        """Return the turn to the best step, in eighths counter-clockwise.

        The best step brings the goal nearest. Among equals it is the one with the fewest turns before and
        after it. The turn is 1 if no step is known to lead anywhere.
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
        """Return the action that begins such a turn, left or right, or forward for no turn."""
        return ti.select(turn == 0, FORWARD, ti.select(turn > 4, RIGHT, LEFT))
