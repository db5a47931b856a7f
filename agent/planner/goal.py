"""Goal of a planner: the target that was seen, or else the next best view; and the paths to the goal."""

from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import NONE, SEARCH, TARGET
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.paths import UNREACHED, Paths
from vitruvius.agent.planner.viewpoints.choice import Viewpoints
from vitruvius.sim.runtime import ti

ARRIVED_HALF_CELLS = 2
"""Half cells from a viewpoint within which a body that drives has arrived."""


@ti.data_oriented
class Goal:
    """Choice of a goal, and of the paths to it."""

    def __init__(
        self,
        config: PlannerConfig,
        occupancy: Occupancy,
        paths: Paths,
        viewpoints: Viewpoints,
        body: BodyModel,
    ) -> None:
        self.config, self.occupancy, self.half, self.led = config, occupancy, body.target, body.led
        self.drives = body.drives
        self.paths, self.viewpoints = paths, viewpoints
        self.radius = config.goal_radius_touching if occupancy.touching else config.goal_radius

    @ti.func
    def choose(self, memory: ti.template(), tables: ti.template(), state, base, hits):
        """Update the goal and the paths to it; return the state.

        The goal is the target that was seen, or else the next best view. A body that is ``led`` gets its view
        afterwards (``lead``).
        """
        far = self.paths.far(memory, base, state.x, state.y)
        state.stale += hits
        state.path_age += 1
        state.plan_age += 1
        old = (state.stale > 0) & (state.path_age > ti.static(self.config.path_interval))
        again = ti.cast(old | (far == UNREACHED), ti.i32)
        search, within = again, 0
        if state.known:
            there = ti.cast(ti.floor(state.target + 0.5), ti.i32)
            node = self.occupancy.at(there[0], there[1])
            moved = ti.max(
                ti.abs(self.occupancy.apart(self.occupancy.across(state.goal), self.occupancy.across(node))),
                ti.abs(self.occupancy.apart(self.occupancy.down(state.goal), self.occupancy.down(node))),
            )
            # From far away, one node of drift does not change the path.
            drifted = self.config.target_drift * moved > far
            # If the body stands at the goal without a pick-up, the target lies a fraction of a cell aside.
            search |= ti.cast((state.kind != TARGET) | drifted | (far == 0), ti.i32)
            state.kind, state.goal = TARGET, ti.select(search, node, state.goal)
            # The target is usually in sight, so the first search allows no path much longer than the straight
            # one.
            away = ti.max(
                ti.abs(state.target[0] - 0.5 * ti.cast(state.x, ti.f32)),
                ti.abs(state.target[1] - 0.5 * ti.cast(state.y, ti.f32)),
            )
            within = ti.cast(ti.static(self.config.path_detour) * away, ti.i32) + self.config.path_slack
        elif state.kind == SEARCH:
            gx, gy = self.occupancy.across(state.goal), self.occupancy.down(state.goal)
            done = ti.cast((state.look == state.heading) & (far == 0), ti.i32)
            if ti.static(self.drives):
                done = ti.cast(
                    (state.look == state.heading) & (state.aligned > 0) & (far <= ARRIVED_HALF_CELLS), ti.i32
                )
            if state.look < 0:
                done = 1 - self.occupancy.hides(memory, base, gx, gy, state.since)
            done |= ti.cast(state.plan_age > ti.static(self.config.replan_interval), ti.i32)
            if done | self.occupancy.solid(memory, base, gx, gy):
                state.kind = NONE
        else:
            state.kind = NONE
        if (state.kind == SEARCH) & (far == UNREACHED):
            state.kind = NONE
        if ti.static(self.led):
            if state.kind == NONE:
                self.paths.forget(memory, base, state.queued)
                state.queued, state.plan_age = 0, 0
        else:
            while state.kind == NONE:
                self.paths.forget(memory, base, state.queued)
                state.queued, state.plan_age, search = 0, 0, 1
                goal, look, longest = self.viewpoints.choose(memory, tables, state, base)
                state.goal, state.look, within = goal, look, longest
                if goal >= 0:
                    state.kind = SEARCH
                elif state.since >= state.time:
                    break
                else:
                    state = self.look_again(memory, state, base)
        if (search > 0) & (state.kind != NONE):
            state = self.search(memory, state, base, within)
        state.path = self.paths.far(memory, base, state.x, state.y)
        return state

    @ti.func
    def look_again(self, memory: ti.template(), state, base):
        """Make the places unseen again that were not seen for longest: no candidate is left."""
        state.since += ti.max(1, (state.time - state.since) // 2)
        state.straight = -1
        self.viewpoints.forget(memory, base)
        return state

    @ti.func
    def lead(self, memory: ti.template(), state, base, node, look, within):
        """Go to a node and look at a heading from there, by a path of about ``within`` nodes."""
        state.kind, state.goal, state.look, state.plan_age = SEARCH, node, look, 0
        state = self.search(memory, state, base, within + self.config.path_slack)
        state.path = self.paths.far(memory, base, state.x, state.y)
        return state

    @ti.func
    def search(self, memory: ti.template(), state, base, within):
        """Search paths to the goal, at most ``within`` nodes long; if there are none, to places near it."""
        self.paths.forget(memory, base, state.queued)
        state.queued, state.stale, state.path_age = 0, 0, 0
        off, radius = ti.Vector([0.0, 0.0]), 0.5
        if state.kind == TARGET:
            # Radius at which the body touches the target.
            off = state.target - ti.floor(state.target + 0.5)
            radius = 1.0 + self.half - self.config.target_overlap
        px, py = state.x, state.y
        if within > 0:
            state.queued = self.paths.measure(memory, base, state.goal, off, radius, within, px, py)
        if self.paths.far(memory, base, px, py) == UNREACHED:
            # The viewpoint was chosen when fewer obstacles were known on its path: now a place near it will
            # do.
            self.paths.forget(memory, base, state.queued)
            about = ti.static(self.radius)
            state.queued = self.paths.measure(memory, base, state.goal, off, about, UNREACHED, px, py)
        return state
