# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""What bodies that drive pursue on the shortest paths to their goals: the next corner, or the goal itself.

Paths are a ``Roadmap``'s, some air away from solids.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from sim.backends.body import SKIN
from sim.baselines.roadmap import FAR, Roadmap, Roads, graph, point, sees
from sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from sim.world.world import World

AIR = 0.04
"""Metres between the body and what it passes."""


class FollowerArrays(NamedTuple):
    """Where bodies are, where they go, and what they pursue."""

    house: Ints
    pose: Floats
    """(x, y, heading) of each."""
    goal: Floats
    """(x, y) of where each goes."""
    half: Floats
    """Half the side of the target about its goal, which is to be picked up; 0 for a place to be at."""
    known: Floats
    """(house, x, y, half) of the goal that ``left`` is of."""
    left: Floats
    """Metres from each corner of the house to the goal."""
    aim: Floats
    """(x, y) of what each pursues."""
    way: Floats
    """Metres that are left of its path, ``FAR`` where there is none."""


class PathFollower:
    """The paths of the E bodies of a world to their goals, which are the arrays ``goal`` and ``half``."""

    def __init__(self, world: World) -> None:
        """Follow paths in the world's bank, which must stay as it is. ``ValueError``: see ``Roadmap``."""
        self.world, count, radius = world, world.num_envs, world.config.body[0] / 2
        self.roads = Roadmap(world, radius + AIR)
        self.arrays = {
            "house": Array(ti.i32, count),
            "pose": Array(ti.f32, 3 * count),
            "goal": Array(ti.f32, 2 * count),
            "half": Array(ti.f32, count),
            "known": Array.of(np.full(4 * count, -1, np.float32)),
            "left": Array(ti.f32, count * self.roads.most),
            "aim": Array(ti.f32, 2 * count),
            "way": Array(ti.f32, count),
        }
        self._launch = Launch(_kernel(start(), radius), self.roads.arrays | self.arrays)

    def follow(self, house: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """For bodies in houses (E,) int32 at poses (E, 3): the bearing of what each pursues (E,) float64,
        radians, and the metres (E,) float32 that are left of its path, ``FAR`` where there is none.
        """
        self.arrays["house"].fill(house)
        self.arrays["pose"].fill(pose.ravel())
        self._launch()
        away = self.arrays["aim"].numpy().reshape(-1, 2) - pose[:, :2]
        return np.arctan2(-away[:, 1], away[:, 0]), self.arrays["way"].numpy()


def solid_of(radius: float) -> float:
    """Metres by which solids are widened where a body goes straight: what it touches is not in its way."""
    return radius - 4 * SKIN


@cache
def _kernel(program: Any, radius: float) -> Any:
    body = solid_of(radius)

    @ti.func
    def edge(place, goal, half):
        """The nearest place to one at which a disc just picks a target up, or the goal that is none."""
        nearest = ti.max(goal - half, ti.min(goal + half, place))
        away, near = place - nearest, ti.select(half > 0.0, ti.static(body), 0.0)
        return nearest + away * ti.min(1.0, near / ti.max(1e-6, away.norm()))

    @kernel
    def pursue(roads: Roads, follower: FollowerArrays):
        for e in range(follower.house.shape[0]):
            where, base = follower.house[e], e * (follower.left.shape[0] // follower.house.shape[0])
            first, count, table = graph(roads, where)
            here = ti.Vector([follower.pose[3 * e], follower.pose[3 * e + 1]])
            there, wide = point(follower.goal, e), follower.half[e]
            key = ti.Vector([ti.cast(where, ti.f32), there[0], there[1], wide])
            if (key != ti.Vector([follower.known[4 * e + k] for k in ti.static(range(4))])).any():
                for k in ti.static(range(4)):
                    follower.known[4 * e + k] = key[k]
                for c in range(count):
                    follower.left[base + c] = FAR
                for c in range(count):
                    corner = point(roads.corners, first + c)
                    end = edge(corner, there, wide)
                    if sees(roads, where, corner, end, ti.static(body), True):
                        last = (end - corner).norm()
                        for a in range(count):
                            by = roads.lengths[table + a * count + c] + last
                            follower.left[base + a] = ti.min(follower.left[base + a], by)
            chosen, end, best = there, edge(here, there, wide), ti.f32(FAR)
            if not sees(roads, where, here, end, ti.static(body), True):
                for c in range(count):
                    corner = point(roads.corners, first + c)
                    by = follower.left[base + c] + (corner - here).norm()
                    if by < best:  # noqa: SIM102 - Taichi does both
                        if sees(roads, where, here, corner, ti.static(body), True):
                            best, chosen = by, corner
            else:
                chosen, best = ti.max(there - wide, ti.min(there + wide, here)), (end - here).norm()
            follower.aim[2 * e], follower.aim[2 * e + 1] = chosen[0], chosen[1]
            follower.way[e] = best

    return pursue
