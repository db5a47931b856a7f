"""Readings of a noisy sensor: ray ends on walls and furniture faces, with the noise averaged out.

All obstacles have faces along one of two axes. So neighbouring rays that end within the noise of one line
across an axis end on one face. Each of them ends where it meets the mean of their lines: the error of the
mean of n rays is 1 / sqrt(n) of one ray's. A ray that returned nothing next to one that returned a hit is a
drop-out. It shows no more floor than the ray next to it, and no end. Exact rays are used as they are.
"""

import math

from vitruvius.agent.avoidance import NOISE_DEVIATIONS, pair
from vitruvius.agent.planner.core.body import BodyModel
from vitruvius.agent.planner.mapping.visibility import FINE
from vitruvius.sim.runtime import ti

NOTHING, WALL, TARGET, DOOR = range(4)
"""Kinds of ray ends: the range, a wall or a piece of furniture, the target, a closed door."""

MIN_RAYS_ON_LINE = 3
"""Least number of rays that must agree on a line."""

MAX_NEIGHBOURS = 6
"""Number of neighbours to each side of a ray that are read."""

MIN_FACE_SINE = 0.1
"""Sine of the angle to a face below which a ray is not used to locate the face."""

SLIP_PROBABILITY = 0.01
"""Prior probability that an action was not carried out, before a look gives evidence."""


@ti.data_oriented
class Scan:
    """Readings of a body's rays."""

    def __init__(self, body: BodyModel) -> None:
        self.rays, self.columns = body.rays, body.columns
        self.doors = "is door" in body.columns
        self.ray_range, self.noise, self.dropout = body.ray_range / FINE, body.noise, body.dropout
        self.apart, self.eighth = pair(body.noise), body.eighth
        self.error = max(body.noise, 0.05) / self.ray_range
        self.margin = MIN_RAYS_ON_LINE if body.noise > 0 else 1
        self.most = (
            1.0 - NOISE_DEVIATIONS * self.noise / self.ray_range
        )  # a ray that met nothing ends there by noise
        self.tolerance = 1e-3 + NOISE_DEVIATIONS * 2**0.5 * self.noise

    @ti.func
    def said(self, observation: ti.template(), e, ray, column: ti.template()):
        """Return the sensor's value of a ray in a column."""
        at = ti.static(self.columns.index(column))
        return observation[(e * self.rays + ray) * ti.static(len(self.columns)) + at]

    @ti.func
    def raw(self, observation: ti.template(), e, ray):
        """Return the sensor's distance of a ray, as a fraction of its range."""
        return self.said(observation, e, ray, "distance")

    @ti.func
    def kind(self, observation: ti.template(), e, ray):
        """Return the kind of a ray's end, by the sensor."""
        kind = ti.select(self.raw(observation, e, ray) < self.most, WALL, NOTHING)
        if self.said(observation, e, ray, "is target") > 0:
            kind = TARGET
        if ti.static(self.doors):  # noqa: SIM102 - decided as it is compiled
            if self.said(observation, e, ray, "is door") > 0:
                kind = DOOR
        return kind

    @ti.func
    def diagonal(self, tables: ti.template(), observation: ti.template(), e):
        """Return 1 if the heading lies at 45 degrees to the walls, 0 if along them, -1 if no wall shows it.

        If two rays end on one wall, the line through both ends runs along an axis in one of the two cases:
        the pairs vote.
        """
        votes = ti.Vector([0, 0])
        for r in range(self.rays - self.apart):
            other = r + self.apart
            one, next_ = self.raw(observation, e, r), self.raw(observation, e, other)
            if (one < self.most) & (next_ < self.most):
                for h in ti.static(range(2)):
                    for axis in ti.static(range(2)):
                        j = 2 * h * self.rays + axis
                        gap = one * tables.directions[j + 2 * r] - next_ * tables.directions[j + 2 * other]
                        votes[h] += ti.cast(ti.abs(gap) < self.tolerance, ti.i32)
        return ti.select(ti.abs(votes[0] - votes[1]) < self.margin, -1, ti.cast(votes[1] > votes[0], ti.i32))

    @ti.func
    def reach(self, observation: ti.template(), e, ray):
        """Return a ray's distance, as a fraction of its range, and its kind of end, by itself.

        If rays may drop out, a ray that met nothing reaches no further than those next to it.
        """
        d, kind = self.raw(observation, e, ray), self.kind(observation, e, ray)
        if kind == NOTHING:
            d = 1.0
            if ti.static(self.dropout):
                for k in ti.static((-1, 1)):
                    if (ray + k >= 0) & (ray + k < self.rays):
                        d = ti.min(d, self.raw(observation, e, ray + k))
        return d, kind

    @ti.func
    def end(self, tables: ti.template(), observation: ti.template(), e, heading, ray):
        """Return a ray's distance, as a fraction of its range, and its kind of end, averaged over a face."""
        d, kind = self.reach(observation, e, ray)
        if ti.static(self.noise > 0):  # noqa: SIM102 - decided as it is compiled
            if kind != NOTHING:
                d = self.averaged(tables, observation, e, heading, ray, d, kind)
        return d, kind

    @ti.func
    def averaged(self, tables: ti.template(), observation: ti.template(), e, heading, ray, d, kind):
        """Return where a ray meets the mean line of the neighbours that end on the same face."""
        most, mean_end = MIN_RAYS_ON_LINE - 1, d
        for axis in ti.static(range(2)):
            j = 2 * heading * self.rays + axis
            way = tables.directions[j + 2 * ray]
            if ti.abs(way) > ti.static(MIN_FACE_SINE * self.ray_range):
                number, weights, mean = 0, 0.0, 0.0
                for side in ti.static((-1, 1)):
                    k, going = ti.static(max(-side, 0)), 1  # this ray itself counts once
                    while going & (k <= MAX_NEIGHBOURS):
                        other = ray + side * k
                        going = ti.cast((other >= 0) & (other < self.rays), ti.i32)
                        if going:
                            across = tables.directions[j + 2 * other]
                            line = self.raw(observation, e, other) * across
                            within = ti.max(ti.abs(way), ti.abs(across)) * ti.static(
                                NOISE_DEVIATIONS * 2**0.5 * self.noise / self.ray_range
                            )
                            same = self.kind(observation, e, other) == kind
                            going = ti.cast(same & (ti.abs(line - d * way) < within + 1e-3), ti.i32)
                            if going:
                                weight = 1.0 / (across * across)
                                number, weights, mean = number + 1, weights + weight, mean + weight * line
                        k += 1
                if number > most:
                    most, mean_end = number, mean / weights / way
        return mean_end

    @ti.func
    def done(
        self, memory: ti.template(), tables: ti.template(), observation: ti.template(), e, heading, turn, way
    ):
        """Return 1 if an action was carried out, 0 if the wheels slipped.

        The action is a ``turn`` of -1, 0 or 1 eighths, or a step of ``way`` cells. A log-likelihood ratio
        compares this look with what the last look predicts in either case. If both predictions are equally
        good, the action counts as carried out.
        """
        odds = ti.cast(ti.static(2 * math.log(1 / SLIP_PROBABILITY)), ti.f32)
        for ray in range(self.rays):
            before = memory.last[e * self.rays + ray]
            now = self.raw(observation, e, ray)
            if turn == 0:
                now = self.end(tables, observation, e, heading, ray)[0]
            expected = before
            if turn != 0:
                turned = ray - turn * ti.static(self.eighth)
                expected = -1.0
                if (turned >= 0) & (turned < self.rays):
                    expected = memory.last[e * self.rays + turned]
            elif before < self.most:
                expected = before - self.nearer(memory, tables, e, heading, ray, way)
            if (expected >= 0.0) & (now < self.most) & (before < self.most) & (expected < self.most):
                odds += self.surprise(now - before) - self.surprise(now - expected)
        return ti.cast(odds > 0, ti.i32)

    @ti.func
    def surprise(self, error):
        """Return the squared error of a distance, in squared standard deviations, at most 9."""
        return ti.min(9.0, (error / self.error) ** 2)

    @ti.func
    def nearer(self, memory: ti.template(), tables: ti.template(), e, heading, ray, way):
        """Return how much nearer a step brings the end of a ray in the last look, as a fraction of the range.

        The end lies on a face across the axis along which neighbouring rays ended nearest to each other.
        """
        at, low, high = e * self.rays, ti.max(ray - 2, 0), ti.min(ray + 2, self.rays - 1)
        nearer, least = 0.0, self.tolerance
        for axis in ti.static(range(2)):
            j = 2 * heading * self.rays + axis
            gap = (
                memory.last[at + low] * tables.directions[j + 2 * low]
                - memory.last[at + high] * tables.directions[j + 2 * high]
            )
            across = tables.directions[j + 2 * ray]
            if (ti.abs(gap) < least) & (ti.abs(across) > ti.static(MIN_FACE_SINE * self.ray_range)):
                nearer, least = way[axis] / across, ti.abs(gap)
        return nearer
