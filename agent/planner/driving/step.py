"""Step of the planners of bodies that drive: move, see, remember, choose, advise a course."""

import math
from functools import cache
from typing import Any, NamedTuple

from vitruvius.agent.planner.core.arrays import PlannerArrays
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import SEARCH, loaded, store
from vitruvius.agent.planner.driving.course import Course
from vitruvius.agent.planner.driving.sweep import Sweep, turned
from vitruvius.agent.planner.goal import ARRIVED_HALF_CELLS
from vitruvius.agent.planner.mapping.scan import WALL
from vitruvius.agent.planner.mapping.visibility import FINE
from vitruvius.agent.planner.step import SKIPPED, Step
from vitruvius.sim.backends.free.body import TURN, cosine_sine
from vitruvius.sim.runtime import Bytes, Floats, Ints, kernel, ti

ALIGNED_RAD = 0.1
"""Largest angle, in radians, between the heading and an eighth of a turn at which a look counts as along
it."""

STUCK_STEP_FRACTION = 0.2
"""Fraction of a step: a blocked body that moves less is stuck and does not slide along an obstacle."""

BLOCKED_AHEAD_CELLS = 1.2
"""Cells from the middle of a stuck body to the place ahead that is then marked as blocked."""


class DrivingTables(NamedTuple):
    """Tables that follow from the rays, the same for all environments."""

    rays: Floats
    """(R, 2) float32: directions of the rays, forward and left."""

    views: Ints
    """Places on a view's rays: see ``PlannerTables``."""


class Driven(NamedTuple):
    """Poses of bodies, and the courses that the planners advise."""

    pose: Floats
    """(E, 3): x, y, metres, and heading, radians."""

    start: Floats
    """(E, 2): start of each episode, metres."""

    place: Floats
    """(E, 2): place of each body before the last step, cells from the start."""

    advice: Floats
    """(E, 2): courses: the radians to turn to the left, and the metres after which the body should stand,
    negative if it should not stop."""


@ti.data_oriented
class DrivingStep(Step):
    """Parts of a step of a body that goes ``travel`` cells in each step.

    Cells have sides of ``cell`` metres; rays are ``spacing`` radians apart.
    """

    def __init__(
        self, config: PlannerConfig, body: BodyModel, cell: float, travel: float, spacing: float
    ) -> None:
        super().__init__(config, body)
        self.cell, self.travel = cell, travel
        self.sweep = Sweep(config, self.occupancy, body.rays, spacing, self.scan.tolerance)
        self.course = Course(self.occupancy, body.target)

    @ti.func
    def drive(self, memory: ti.template(), driven: ti.template(), state, base, e, fresh):
        """Return the state at a pose, and the eye's place in cells from the start of the episode."""
        here = ti.Vector([driven.pose[3 * e], driven.pose[3 * e + 1]])
        if fresh:
            state = self.begin(memory, state, base, 0)
            for k in ti.static(range(2)):
                driven.start[2 * e + k], driven.place[2 * e + k] = here[k], 0.0
        eye = (here - ti.Vector([driven.start[2 * e], driven.start[2 * e + 1]])) / ti.static(self.cell)
        # The body counts as standing on the nearest node.
        state.x, state.y = (
            2 * ti.cast(ti.floor(eye[0] + 0.5), ti.i32),
            2 * ti.cast(ti.floor(eye[1] + 0.5), ti.i32),
        )
        eighths = driven.pose[3 * e + 2] * ti.static(8 / TURN)
        nearest = ti.floor(eighths + 0.5)
        state.heading = ti.cast(nearest, ti.i32) & 7
        state.aligned = ti.cast(ti.abs(eighths - nearest) < ti.static(ALIGNED_RAD * 8 / TURN), ti.i32)
        state.time += 1
        return state, eye

    @ti.func
    def look(self, memory: ti.template(), tables: ti.template(), observation: ti.template(), state, base, e,
             eye, cosine, sine):  # fmt: skip
        """Mark what the body covers and the rays show on the map; return the state and the sighting."""
        sight, offset = self.unsighted(state, 0), state.target - eye
        new, furthest = self.occupancy.see_body(memory, base, state.x, state.y, state.time), 0
        # The two rays before this one, and how many of them ended on a wall.
        before, earlier, ends = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0]), 0
        for r in range(self.body.rays):
            d, kind = self.scan.reach(observation, e, r)
            way = turned(ti.Vector([tables.rays[2 * r], tables.rays[2 * r + 1]]), cosine, sine)
            ray = way * ti.static(self.body.ray_range / FINE)
            end, far = d * ray, ti.cast(d * self.body.ray_range, ti.i32)
            memory.reached[e * self.body.rays + r] = far
            furthest = ti.max(furthest, far)
            if sight.due:
                if kind == WALL:
                    hits = self.sweep.wall(memory, base, eye, end, before, earlier, ends, state.time)
                    sight.hits += hits
                    ends, earlier, before = ti.min(ends + 1, 2), before, end
                else:
                    ends = 0
            sight = self.notice(sight, state.known, offset, kind, d, ray, way)
        if sight.due:
            new += self.sweep.floor(memory, tables, base, e, eye, cosine, sine, furthest, state.time)
        state.new = new
        state.seen += new
        return state, sight

    @ti.func
    def note(
        self, memory: ti.template(), driven: ti.template(), state, sight, base, e, eye, cosine, sine, blocked
    ):
        """Mark room where the body stands, and none ahead of a body that is stuck; return the sighting."""
        moved = (eye - ti.Vector([driven.place[2 * e], driven.place[2 * e + 1]])).norm()
        for k in ti.static(range(2)):
            driven.place[2 * e + k] = eye[k]
        x, y = state.x >> 1, state.y >> 1
        self.occupancy.clear(memory, base, x, y)
        if blocked and moved < ti.static(STUCK_STEP_FRACTION * self.travel):
            there = ti.cast(
                ti.floor(eye + BLOCKED_AHEAD_CELLS * turned(ti.Vector([1.0, 0.0]), cosine, sine) + 0.5),
                ti.i32,
            )
            if there[0] != x or there[1] != y:
                sight.hits += self.occupancy.close(memory, base, there[0], there[1])
        return sight

    @ti.func
    def steer(self, memory: ti.template(), driven: ti.template(), state, base, e, eye):
        """Write the course to the goal, or the turn to look from the goal; without a course, turn left."""
        way, heading = self.course.aim(memory, base, state, eye), driven.pose[3 * e + 2]
        off, room = ti.f32(math.pi / 2), ti.f32(0.0)
        if (state.kind == SEARCH) & (state.look >= 0) & (state.path <= ARRIVED_HALF_CELLS):
            off = ti.cast(state.look, ti.f32) * ti.static(TURN / 8) - heading
        elif way.norm() > 0.0:
            off, room = ti.atan2(-way[1], way[0]) - heading, -1.0
            if (state.kind == SEARCH) & (state.look >= 0):
                room = 0.5 * ti.cast(state.path, ti.f32) * ti.static(self.cell)
        driven.advice[2 * e], driven.advice[2 * e + 1] = off, room


@cache
def driving_kernel(
    program: Any, config: PlannerConfig, body: BodyModel, cell: float, travel: float, spacing: float
) -> Any:
    """Return the kernel for a running Taichi.

    The kernel's arguments have the names of the planner's arrays.
    """
    parts = DrivingStep(config, body, cell, travel, spacing)

    @kernel
    def step(
        observation: Floats,
        blocked: Bytes,
        begun: Bytes,
        tables: DrivingTables,
        memory: PlannerArrays,
        driven: Driven,
        states: Ints,
    ):
        ti.loop_config(block_dim=8)
        for e in range(blocked.shape[0]):
            if begun[e] != SKIPPED:
                base, state, fresh = e * parts.occupancy.area, loaded(states, e), ti.cast(begun[e], ti.i32)
                cosine, sine = cosine_sine(driven.pose[3 * e + 2])
                state, eye = parts.drive(memory, driven, state, base, e, fresh)
                state, sight = parts.look(memory, tables, observation, state, base, e, eye, cosine, sine)
                state = parts.remember_target(memory, state, sight, base, eye)
                hit = ti.cast(blocked[e], ti.i32) * (1 - fresh)
                sight = parts.note(memory, driven, state, sight, base, e, eye, cosine, sine, hit)
                state = parts.goal.choose(memory, tables, state, base, sight.hits)
                parts.steer(memory, driven, state, base, e, eye)
                store(states, e, state)

    return step
