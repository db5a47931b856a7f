"""Estimate of the target's place from the rays that met it: a square whose sides lie along the walls.

Places are in cells, east and south of the eye.
"""

from vitruvius.agent.planner.core.config import PlannerConfig
from vitruvius.sim.runtime import ti


@ti.data_oriented
class TargetEstimate:
    """Estimates from sightings of a square of half the side ``half``, in cells."""

    def __init__(self, config: PlannerConfig, half: float, disc: bool = False) -> None:
        """Estimate for a body that is a ``disc`` of a cell's radius, or else a square of two cells."""
        self.config, self.half, self.disc = config, half, disc

    @ti.func
    def centre(self, rays, low, high, way, known, before):
        """Return the centre of a square that ``rays`` rays met between the corners ``low`` and ``high``.

        ``way`` is the sum of the rays' directions. ``before`` is the centre so far, if it is ``known``. The
        centre is exact along an axis if a face is seen. Otherwise it is the place nearest to ``before``, if
        that is known, from which the square covers every seen part.
        """
        flat = high - low < ti.static(self.config.target_flat)
        least, most = high - self.half, low + self.half
        middle = 0.5 * (low + high)
        if known and not self.other(middle, before):
            middle = ti.max(least, ti.min(most, before))
        elif rays == 1:
            middle += way
        if rays > 1:
            if not flat[1]:
                middle[0] = ti.select(way[0] > 0, most[0], least[0])
            if not flat[0]:
                middle[1] = ti.select(way[1] > 0, most[1], least[1])
        return middle

    @ti.func
    def other(self, one, before):
        """Return 1 if a target at one place cannot be the known one, which lies at ``before``."""
        return ti.cast(ti.abs(one - before).max() > ti.static(self.config.target_apart), ti.i32)

    @ti.func
    def misses(self, at, ray, length):
        """Return 1 if a ray of some length along ``ray`` misses a target at ``at`` that it should meet."""
        along, aside = at.dot(ray) / ray.norm(), ti.abs(at.cross(ray)) / ray.norm()
        past = length > along + ti.static(self.config.target_behind)
        return ti.cast((along > 0) & (aside < ti.static(self.config.target_core)) & past, ti.i32)

    @ti.func
    def gone(self, at, missed):
        """Return 1 if a target that no ray meets has gone.

        It has gone if the body touches its place, or if from near rays have ``missed`` it that should have
        met it.
        """
        away = ti.abs(at).max()
        touched = away < ti.static(1.0 + self.half + self.config.target_contact)
        if ti.static(self.disc):
            touched = ti.max(0.0, ti.abs(at) - self.half).norm() < 1.0
        return ti.cast(touched | ((missed > 0) & (away < ti.static(self.config.target_certain))), ti.i32)
