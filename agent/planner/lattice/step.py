"""Step of planners whose bodies move on a lattice: move, see, remember, choose, advise."""

from functools import cache
from typing import Any

from vitruvius.agent.planner.core.arrays import PlannerArrays, PlannerTables
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import SEARCH, loaded, store
from vitruvius.agent.planner.lattice.advice import Advice
from vitruvius.agent.planner.mapping.scan import DOOR, WALL
from vitruvius.agent.planner.step import SKIPPED, Step
from vitruvius.sim.runtime import Bytes, Floats, Ints, Longs, kernel, ti

DOOR_WITHIN_STEPS = 1.5
"""Distance to a closed door, in free steps, within which the body counts as standing at the door. A body that
pushes a door stands within one step of it, but rays that meet the door at an angle are longer."""

SweptRay = ti.types.struct(
    kind=ti.i32,  # of the ray's end, -1 before the first ray
    far=ti.i32,  # how far the ray reaches, in fractions (``FINE``) of a cell
    reached=ti.i32,  # how far it reached in the last sweep
    end=ti.math.vec2,  # its end, cells from the eye
)


@ti.data_oriented
class LatticeStep(Step):
    """Parts of a step of a body on a lattice."""

    def __init__(self, config: PlannerConfig, body: BodyModel) -> None:
        super().__init__(config, body)
        self.advice = Advice(self.occupancy, self.paths)
        self.ahead = body.step // 2 if body.touching else body.step

    @ti.func
    def eye(self, state):
        """Return the eye's place, cells from the start: the state counts half cells."""
        return ti.Vector([0.5 * ti.cast(state.x, ti.f32), 0.5 * ti.cast(state.y, ti.f32)])

    @ti.func
    def move(self, memory: ti.template(), tables: ti.template(), observation: ti.template(), state, base, e,
             action, blocked, fresh):  # fmt: skip
        """Return the state after an action, and 1 if an episode or a new map begins here.

        The map is cleared in a ``fresh`` episode, and also if it turns out to lie at 45 degrees to the walls.
        """
        diagonal = -1
        done = 1
        if ti.static(self.body.slip) and fresh == 0:
            turn = ti.select(action == 2, 0, 1 - 2 * action)
            way = 0.5 * self.body.step * self.occupancy.ahead(state.heading)
            done = self.scan.done(memory, tables, observation, e, state.heading, turn, way)
        if (fresh == 0) & done:
            if action < 2:
                state.heading = (state.heading + ti.select(action == 0, 1, 7)) & 7
                state.straight = -1
            elif blocked == 0:
                way = self.occupancy.ahead(state.heading)
                if state.straight >= 0:
                    state.straight += self.body.step
                state.x += self.body.step * way[0]
                state.y += self.body.step * way[1]
        if (fresh == 1) | (state.aligned == 0):
            diagonal = self.scan.diagonal(tables, observation, e)
            if (diagonal >= 0) & (diagonal != state.heading & 1):
                # Until it saw a wall, the planner kept the map at 45 degrees to the walls.
                fresh = 1
        if fresh:
            state = self.begin(memory, state, base, ti.max(diagonal, 0))
        if diagonal >= 0:
            state.aligned = 1
        state.time += 1
        return state, fresh

    @ti.func
    def see(self, memory: ti.template(), tables: ti.template(), observation: ti.template(), state, base, e):
        """Mark what the body covers and the rays show on the map; return the state and the sighting."""
        eye, sight = self.eye(state), self.unsighted(state, state.straight)
        offset, new = state.target - eye, self.occupancy.see_body(memory, base, state.x, state.y, state.time)
        sight.forward = 1
        last = SweptRay(0)
        last.kind = -1
        for r in range(self.body.rays):
            d, kind = self.scan.end(tables, observation, e, state.heading, r)
            if ti.static(self.body.slip):
                memory.last[e * self.body.rays + r] = d
            j = 2 * (state.heading * self.body.rays + r)
            ray = ti.Vector([tables.directions[j], tables.directions[j + 1]])
            clear = tables.clear[(state.heading & 1) * self.body.rays + r]
            if (kind == WALL) & (d < clear):
                sight.forward = 0
            if ti.static(self.scan.doors):
                sight.door |= ti.cast((kind == DOOR) & (d < DOOR_WITHIN_STEPS * clear), ti.i32)
            if sight.due:
                end = d * ray
                unseen, hits, last = self.sweep(memory, tables, state, base, e, r, kind, d, end, eye, last)
                new += unseen
                sight.hits += hits
            sight = self.notice(sight, state.known, offset, kind, d, ray, ray / ray.norm())
        if sight.due:
            state.straight = 0
        state.new = new
        state.seen += new
        return state, sight

    @ti.func
    def sweep(self, memory: ti.template(), tables: ti.template(), state, base, e, r, kind, d, end, eye, last):
        """Mark the floor before the end of ray ``r``, cells from the eye, and what it ended on.

        ``last`` is the ray before it. Returns the number of cells that were never seen, the number of those
        newly found to be occupied, and this ray.
        """
        ray = SweptRay(kind=kind, far=ti.cast(d * self.body.ray_range, ti.i32), reached=0, end=end)
        corner = self.occupancy.at(state.x >> 1, state.y >> 1)
        pose = (state.heading * 4) | (state.x & 1) | ((state.y & 1) << 1)  # heading, and the place in a cell
        unseen, reached = self.visibility.floor(
            memory, tables, base, e * self.body.rays + r, corner, pose, r, ray.far, last.far, last.reached,
            state.straight, state.time,
        )  # fmt: skip
        ray.reached, hits = reached, 0
        if kind == WALL:
            hits = self.visibility.wall(memory, base, eye, end, last.end, last.kind == WALL, state.time)
        return unseen, hits, ray

    @ti.func
    def remember(self, memory: ti.template(), state, sight, base, blocked):
        """Update the target's place, the pick-ups, and what blocks the body; return state and sighting."""
        px, py = state.x, state.y
        state = self.remember_target(memory, state, sight, base, self.eye(state))
        # Before a closed door, the obstacle is the door, which will open.
        if (blocked != 0) & (sight.door == 0):
            sight.forward = 0
        if (px | py) & 1 == 0:
            # The body may stand nearer to a wall than the map would have let it go.
            self.occupancy.clear(memory, base, px >> 1, py >> 1)
        way = self.occupancy.ahead(state.heading)
        noted = sight.due | ti.cast(blocked, ti.i32)
        passes = self.occupancy.passes(memory, base, px, py, way[0], way[1], ti.static(self.body.step))
        if (sight.forward == 0) & noted & passes & (sight.door == 0):
            # The body cannot go where the map shows room: the obstacle lies between two rays.
            qx, qy = px + self.ahead * way[0], py + self.ahead * way[1]
            self.occupancy.close(memory, base, (qx + (way[0] > 0)) >> 1, (qy + (way[1] > 0)) >> 1)
            sight.hits += 1
        return state, sight

    @ti.func
    def advise(self, memory: ti.template(), state, base):
        """Return the action that leads to the goal."""
        px, py, heading = state.x, state.y, state.heading
        gains = self.advice.gains(memory, base, px, py, heading, state.forward)
        turn = self.advice.turn(memory, base, px, py, heading, gains)
        if (state.kind == SEARCH) & (state.look >= 0) & (state.path == 0):
            turn = (state.look - heading) & 7
        return self.advice.action(turn)


@cache
def step_kernel(program: Any, config: PlannerConfig, body: BodyModel) -> Any:
    """Return the kernel for a running Taichi.

    The kernel's arguments have the names of the planner's arrays.
    """
    parts = LatticeStep(config, body)

    @kernel
    def step(
        observation: Floats,
        action: Longs,
        blocked: Bytes,
        begun: Bytes,
        tables: PlannerTables,
        memory: PlannerArrays,
        states: Ints,
        advice: Longs,
    ):
        ti.loop_config(block_dim=8)  # few environments per thread: the times of their steps differ widely
        for e in range(blocked.shape[0]):
            if begun[e] != SKIPPED:
                base, state = e * parts.occupancy.area, loaded(states, e)
                fresh, hit = ti.cast(begun[e], ti.i32), ti.cast(blocked[e], ti.i32)
                state, fresh = parts.move(memory, tables, observation, state, base, e, action[e], hit, fresh)
                state, sight = parts.see(memory, tables, observation, state, base, e)
                state, sight = parts.remember(memory, state, sight, base, hit)
                state.forward = sight.forward
                state = parts.goal.choose(memory, tables, state, base, sight.hits)
                advice[e] = parts.advise(memory, state, base)
                store(states, e, state)

    return step


@cache
def lead_kernel(program: Any, config: PlannerConfig, body: BodyModel) -> Any:
    """Return the kernel that gives viewpoints to planners in the step in which they have none."""
    parts = LatticeStep(config, body)

    @kernel
    def lead(goals: Ints, memory: PlannerArrays, states: Ints, advice: Longs):
        ti.loop_config(block_dim=8)
        for e in range(advice.shape[0]):
            node = goals[3 * e]
            if node >= 0:
                base, state = e * parts.occupancy.area, loaded(states, e)
                state = parts.goal.lead(memory, state, base, node, goals[3 * e + 1], goals[3 * e + 2])
                advice[e] = parts.advise(memory, state, base)
                store(states, e, state)

    return lead
