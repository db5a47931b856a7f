"""Parts of a planner's step that all bodies have: the map, the choice of a goal, and the target's place."""

from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.agent.planner.core.state import first_state
from vitruvius.agent.planner.goal import Goal
from vitruvius.agent.planner.mapping.occupancy import Occupancy
from vitruvius.agent.planner.mapping.scan import TARGET, Scan
from vitruvius.agent.planner.mapping.target import TargetEstimate
from vitruvius.agent.planner.mapping.visibility import Visibility
from vitruvius.agent.planner.paths import Paths
from vitruvius.agent.planner.viewpoints.belief import Belief
from vitruvius.agent.planner.viewpoints.candidates import Candidates
from vitruvius.agent.planner.viewpoints.choice import Viewpoints
from vitruvius.sim.runtime import ti

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
        self.goal = Goal(config, self.occupancy, self.paths, self.viewpoints, body)

    @ti.func
    def begin(self, memory: ti.template(), state, base, heading):
        """Clear the map; return the state of an episode that begins at a heading."""
        self.paths.forget(memory, base, state.queued)
        self.occupancy.forget(memory, base)
        self.viewpoints.forget(memory, base)
        return first_state(heading)

    @ti.func
    def unsighted(self, state, straight):
        """Return the sighting before the first ray; ``straight``: see ``Visibility.due``."""
        sight = Sighting(0)
        sight.due = self.visibility.due(state.time, state.new, state.known, straight)
        sight.low, sight.high = ti.Vector([1e9, 1e9]), ti.Vector([-1e9, -1e9])
        return sight

    @ti.func
    def notice(self, sight, known, offset, kind, d, ray, way):
        """Return the sighting with one more ray, which met the target or should have met it.

        The ray ends after the fraction ``d`` of ``ray`` (east and south, cells), whose direction is ``way``.
        A ``known`` target lies at an ``offset`` from the eye, cells.
        """
        if kind == TARGET:
            end = d * ray
            sight.spotted += 1
            sight.side += way
            sight.low, sight.high = ti.min(sight.low, end), ti.max(sight.high, end)
        elif known:
            sight.missed |= self.target.misses(offset, ray, d * ray.norm())
        return sight

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
