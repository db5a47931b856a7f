"""Step of all planners: move, see, remember, choose, advise."""

from functools import cache
from typing import Any

from vitruvius.agent.planner.core.arrays import PlannerArrays, PlannerTables
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import SEARCH, first_state, loaded, store
from vitruvius.agent.planner.goal import Goal
from vitruvius.agent.planner.lattice.advice import Advice
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.mapping.scan import DOOR, TARGET, WALL, Scan
from vitruvius.agent.planner.mapping.target import TargetEstimate
from vitruvius.agent.planner.mapping.visibility import Visibility
from vitruvius.agent.planner.paths import Paths
from vitruvius.agent.planner.viewpoints.belief import Belief
from vitruvius.agent.planner.viewpoints.candidates import Candidates
from vitruvius.agent.planner.viewpoints.choice import Viewpoints
from vitruvius.sim.runtime import Bytes, Floats, Ints, Longs, kernel, ti

SKIPPED = 2
"""Value of ``begun`` for environments whose planner stays as it is."""

Sighting = ti.types.struct(
    due=ti.i32,  # 1 if the rays were swept
    hits=ti.i32,  # cells newly found to be occupied
    forward=ti.i32,  # 1 if the rays leave the body room to go forward
    door=ti.i32,  # 1 if the body is before a closed door
    spotted=ti.i32,  # rays that met the target
    missed=ti.i32,  # 1 if a ray missed a known target that it should have met
    low=ti.math.vec2,  # corners of the box of the rays' ends on the target, cells from the eye
    high=ti.math.vec2,
    side=ti.math.vec2,  # sum of these rays' directions
)


@ti.data_oriented
class Step:
    """Parts of a step, for a configuration and a body; environment ``e``'s cells begin at ``base``."""

    def __init__(self, config: PlannerConfig, body: BodyModel) -> None:
        self.config, self.body = config, body
        self.scan = Scan(body)
        self.occupancy = Occupancy(config, body.step, body.touching, body.errs)
        self.visibility = Visibility(config, self.occupancy, body.rays, body.ray_range, self.scan.tolerance)
        self.target = TargetEstimate(config, body.target, body.drives)
        self.belief = Belief(config, self.occupancy, body.prior)
        candidates = Candidates(config, self.occupancy, self.belief)
        self.viewpoints = Viewpoints(config, self.occupancy, candidates, body.drives)
        self.paths = Paths(config, self.occupancy)
        self.advice = Advice(self.occupancy, self.paths)
        self.ahead = body.step // 2 if body.touching else body.step
        self.goal = Goal(config, self.occupancy, self.paths, self.viewpoints, body)

    @ti.func
    def move(self, memory: ti.template(), tables: ti.template(), observation: ti.template(), state, base, e,
             action, blocked, fresh):  # fmt: skip
        """Return the state after an action, and 1 if an episode or a new map begins here.

        In a ``fresh`` episode the map is cleared. So is a map that turns out to lie at 45 degrees to the
        walls.
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
                # Before the first wall, the map took everything for what lies 45 degrees aside.
                fresh = 1
        if fresh:
            self.paths.forget(memory, base, state.queued)
            self.occupancy.forget(memory, base)
            self.viewpoints.forget(memory, base)
            state = first_state(ti.max(diagonal, 0))
        if diagonal >= 0:
            state.aligned = 1
        state.time += 1
        return state, fresh

    @ti.func
    def see(self, memory: ti.template(), tables: ti.template(), observation: ti.template(), state, base, e):
        """Mark what the body covers and the rays show on the map; return the state and the sighting."""
        px, py, heading, time, known = state.x, state.y, state.heading, state.time, state.known
        eye = ti.Vector([0.5 * ti.cast(px, ti.f32), 0.5 * ti.cast(py, ti.f32)])
        offset, new = state.target - eye, self.occupancy.see_body(memory, base, px, py, time)
        sight = Sighting(0)
        sight.due = self.visibility.due(time, state.new, known, state.straight)
        sight.forward, sight.low, sight.high = 1, ti.Vector([1e9, 1e9]), ti.Vector([-1e9, -1e9])
        before, last_kind, last_far, last_reached = ti.Vector([0.0, 0.0]), -1, 0, 0
        corner = self.occupancy.at(px >> 1, py >> 1)
        row = (heading * 4) | (px & 1) | ((py & 1) << 1)  # of the fan: the heading, and the place in a cell
        for r in range(self.body.rays):
            j = 2 * (heading * self.body.rays + r)
            d, kind = self.scan.end(tables, observation, e, heading, r)
            if ti.static(self.body.slip):
                memory.last[e * self.body.rays + r] = d
            ray = ti.Vector([tables.directions[j], tables.directions[j + 1]])
            end = d * ray
            if (kind == WALL) & (d < tables.clear[(heading & 1) * self.body.rays + r]):
                sight.forward = 0
            if ti.static(self.scan.doors):
                sight.door |= ti.cast(
                    (kind == DOOR) & (d < 1.5 * tables.clear[(heading & 1) * self.body.rays + r]), ti.i32
                )
            if sight.due:
                far = ti.cast(d * self.body.ray_range, ti.i32)
                unseen, reached = self.visibility.floor(
                    memory, tables, base, e * self.body.rays + r, corner, row, r, far, last_far,
                    last_reached, state.straight, time,
                )  # fmt: skip
                new += unseen
                if kind == WALL:
                    sight.hits += self.visibility.wall(
                        memory, base, eye, end, before, last_kind == WALL, time
                    )
                before, last_kind, last_far, last_reached = end, kind, far, reached
            if kind == TARGET:
                sight.spotted += 1
                sight.side += ray / ray.norm()
                sight.low, sight.high = ti.min(sight.low, end), ti.max(sight.high, end)
            elif known:
                sight.missed |= self.target.misses(offset, ray, d * ray.norm())
        if sight.due:
            state.straight = 0
        state.new = new
        state.seen += new
        return state, sight

    @ti.func
    def remember(self, memory: ti.template(), state, sight, base, blocked):
        """Update the target's place, the pick-ups, and what blocks the body; return state and sighting."""
        px, py = state.x, state.y
        eye = ti.Vector([0.5 * ti.cast(px, ti.f32), 0.5 * ti.cast(py, ti.f32)])
        state = self.remember_target(memory, state, sight, base, eye)
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
    def remember_target(self, memory: ti.template(), state, sight, base, eye):
        """Update the target's place and the pick-ups, seen from the ``eye``, cells; return the state."""
        offset, known, picked = state.target - eye, state.known, 0
        if sight.spotted > 0:
            there = self.target.centre(sight.spotted, sight.low, sight.high, sight.side, known, offset)
            picked = known & self.target.other(there, offset)
            state.target = eye + there
            known = 1
        elif known & self.target.gone(offset, sight.missed):
            known = 0
            picked = ti.cast(ti.abs(offset).max() < ti.static(self.config.picked_up), ti.i32)
        if picked:
            state.since, state.straight = state.time, -1
            state.found += 1
            self.viewpoints.forget(memory, base)
            spot = ti.cast(ti.floor(eye + offset + 0.5), ti.i32)
            state.found_here += self.belief.within(self.belief.start_room(memory, base), spot[0], spot[1])
        state.known = known
        return state

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
    parts = Step(config, body)

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
    parts = Step(config, body)

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
