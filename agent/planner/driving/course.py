"""Course of a body along a path on its map: as far ahead as the straight line is free."""

from vitruvius.agent.planner.core.state import NONE, TARGET
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.paths import UNREACHED
from vitruvius.sim.runtime import ti

MAX_AHEAD_NODES = 28
"""Nodes of a path to look ahead: about 4 m."""

MIN_AHEAD_NODES = 2
"""Nodes ahead to which a body always goes, so that it leaves a place that its map shows as blocked."""

COVERED_CELLS = 1.0
"""Distance from the body's middle, in cells, that the body covers; room is checked beyond it."""


@ti.data_oriented
class Course:
    """Straight parts of paths on a map."""

    def __init__(self, occupancy: Occupancy, half: float) -> None:
        """Aim at targets of half the side ``half``, cells."""
        self.occupancy, self.half = occupancy, half

    @ti.func
    def room(self, memory: ti.template(), base, point):
        """Return 1 if a body has room about any place."""
        x, y, free = ti.cast(ti.floor(point[0]), ti.i32), ti.cast(ti.floor(point[1]), ti.i32), 1
        for k in range(4):
            free &= 1 - self.occupancy.solid(memory, base, x + (k & 1), y + (k >> 1))
        return free

    @ti.func
    def straight(self, memory: ti.template(), base, eye, point, short):
        """Return 1 if a body has room on the straight way to a place, except for the last ``short`` cells."""
        way, at, free = point - eye, COVERED_CELLS, 1
        length = way.norm()
        while (at < length - short) & free:
            free = self.room(memory, base, eye + way * (at / length))
            at += 0.5
        if free & (length - short > COVERED_CELLS):
            free = self.room(memory, base, eye + way * ((length - short) / length))
        return free

    @ti.func
    def aim(self, memory: ti.template(), base, state, eye):
        """Return the way (east and south, cells) to where the body should drive; zero without a path."""
        x, y, aim = state.x >> 1, state.y >> 1, ti.Vector([0.0, 0.0])
        left = ti.cast(memory.distance[base + self.occupancy.at(x, y)], ti.i32)
        side, k, going = -1, 0, ti.cast((left < UNREACHED) & (state.kind != NONE), ti.i32)
        while (going > 0) & (left > 0) & (k < MAX_AHEAD_NODES):
            going, k = 0, k + 1
            at = ti.Vector([x, y])
            for turn in range(8):
                if going == 0:  # straight on if that leads nearer
                    way = self.occupancy.ahead((ti.max(side, 0) + turn) & 7)
                    there = at + way
                    nearer = (
                        ti.cast(memory.distance[base + self.occupancy.at(there[0], there[1])], ti.i32)
                        == left - 1
                    )
                    if nearer and way[0] * way[1] != 0:
                        nearer = not (
                            self.occupancy.solid(memory, base, there[0], at[1])
                            | self.occupancy.solid(memory, base, at[0], there[1])
                        )
                    if nearer:
                        x, y, going, side = there[0], there[1], 1, (ti.max(side, 0) + turn) & 7
            if going:
                left -= 1
                point = ti.cast(ti.Vector([x, y]), ti.f32)
                if (k <= MIN_AHEAD_NODES) | self.straight(memory, base, eye, point, 0.0):
                    aim = point - eye
                else:
                    going = 0
        if (state.kind == TARGET) & (left < UNREACHED):
            touch = 1.0 + self.half
            near = ti.cast((left == 0) & (k <= MIN_AHEAD_NODES), ti.i32)
            if near | self.straight(memory, base, eye, state.target, touch):
                aim = state.target - eye
        return aim
