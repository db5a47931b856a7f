"""Baseline that drives along the shortest path to its target by a rule; it knows the house and the target.

The body pursues the next corner of its path, from a ``Roadmap``, or the target. It turns towards the point as
fast as it can still stop turning, and drives faster with a smaller error. It does not plan beyond its current
target, and its paths are not the fastest possible.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from vitruvius.agent.baselines.driving.roadmap import NO_PATH_M, Roadmap, Roads, graph, point, sees
from vitruvius.agent.baselines.driving.steering import steered
from vitruvius.sim.backends.body import SKIN
from vitruvius.sim.environment.vector import HouseVectorEnv
from vitruvius.sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from vitruvius.sim.world.world import World

CLEARANCE_M = 0.04
"""Distance between the body and the obstacles that it passes, in metres."""


class FollowerArrays(NamedTuple):
    """Poses and targets of bodies, and the points that they pursue."""

    house: Ints
    pose: Floats
    """(x, y, heading) of each body."""
    target: Floats
    """(x, y) of each body's target."""
    known: Floats
    """(house, x, y) of the target to which ``left`` refers."""
    left: Floats
    """Distance in metres from each corner of the house to the target."""
    aim: Floats
    """(x, y) of the point that each body pursues."""


class TruePath:
    """Commands that drive the E bodies of a ``HouseVectorEnv`` along the shortest paths."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Take environments whose bank must not change.

        Raises ``ValueError`` if bodies do not drive, and for the reasons of ``Roadmap``.
        """
        self.world: World = envs.unwrapped.world
        config, count = self.world.config, self.world.num_envs
        if not config.drives:
            raise ValueError("the true path needs a driving robot: use the backend free, or the oracle")
        config.drive.require_heading("a true path")
        radius = config.body[0] / 2
        roads = Roadmap(self.world, radius + CLEARANCE_M)
        self.arrays = {
            "house": Array(ti.i32, count),
            "pose": Array(ti.f32, 3 * count),
            "target": Array(ti.f32, 2 * count),
            "known": Array.of(np.full(3 * count, -1, np.float32)),
            "left": Array(ti.f32, count * roads.most),
            "aim": Array(ti.f32, 2 * count),
        }
        self._pursue = Launch(_kernel(start(), radius, config.target / 2), roads.arrays | self.arrays)

    def act(self) -> np.ndarray:
        """Return the next speeds (v, w) (E, 2) float32, or the numbers (E,) int64 of the nearest commands."""
        pose, target, house = self.world.describe()
        for name, values in (("house", house), ("pose", pose), ("target", target)):
            self.arrays[name].fill(values.ravel())
        self._pursue()
        away = self.arrays["aim"].numpy().reshape(-1, 2) - pose[:, :2]
        return steered(self.world.config.drive, np.arctan2(-away[:, 1], away[:, 0]) - pose[:, 2])


@cache
def _kernel(program: Any, radius: float, half: float) -> Any:
    body = radius - 4 * SKIN  # an obstacle that a body touches is not in its way

    @ti.func
    def nearest(place, target):
        """Return the point of a target that is nearest to a place."""
        return ti.max(target - ti.static(half), ti.min(target + ti.static(half), place))

    @ti.func
    def edge(place, target):
        """Return the nearest place where a disc just picks up a target."""
        point = nearest(place, target)
        away = place - point
        return point + away * ti.min(1.0, ti.static(body) / ti.max(1e-6, away.norm()))

    @kernel
    def pursue(roads: Roads, follower: FollowerArrays):
        for e in range(follower.house.shape[0]):
            where, base = follower.house[e], e * (follower.left.shape[0] // follower.house.shape[0])
            first, count, table = graph(roads, where)
            here = ti.Vector([follower.pose[3 * e], follower.pose[3 * e + 1]])
            there = point(follower.target, e)
            key = ti.Vector([ti.cast(where, ti.f32), there[0], there[1]])
            if (key != ti.Vector([follower.known[3 * e + k] for k in ti.static(range(3))])).any():
                for k in ti.static(range(3)):
                    follower.known[3 * e + k] = key[k]
                for c in range(count):
                    follower.left[base + c] = NO_PATH_M
                for c in range(count):
                    corner = point(roads.corners, first + c)
                    end = edge(corner, there)
                    if sees(roads, where, corner, end, ti.static(body), True):
                        last = (end - corner).norm()
                        for a in range(count):
                            by = roads.lengths[table + a * count + c] + last
                            follower.left[base + a] = ti.min(follower.left[base + a], by)
            chosen, end, best = there, edge(here, there), ti.f32(NO_PATH_M)
            if not sees(roads, where, here, end, ti.static(body), True):
                for c in range(count):
                    corner = point(roads.corners, first + c)
                    by = follower.left[base + c] + (corner - here).norm()
                    if by < best:  # noqa: SIM102 - Taichi does both
                        if sees(roads, where, here, corner, ti.static(body), True):
                            best, chosen = by, corner
            else:
                chosen = nearest(here, there)
            follower.aim[2 * e], follower.aim[2 * e + 1] = chosen[0], chosen[1]

    return pursue
