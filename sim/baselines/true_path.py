# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false
"""A body that drives along the shortest path to its target, by rule: it knows house and target.

The path is a ``Roadmap``'s, some air away from solids. The body pursues its next corner, or the target: it
turns to where that lies as fast as it can still stop turning, and drives the faster the less it is off. It
looks no further than to the target that it has, and no path of its is the fastest that there is.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from sim.backends.body import SKIN
from sim.baselines.roadmap import FAR, Roadmap, Roads, graph, point, sees
from sim.baselines.steering import steered
from sim.environment.vector import HouseVectorEnv
from sim.runtime import Array, Floats, Ints, Launch, kernel, start, ti
from sim.world.world import World

AIR = 0.04
"""Metres between the body and what it passes."""


class PursuitState(NamedTuple):
    """Where bodies are and what they pursue."""

    house: Ints
    pose: Floats
    """(x, y, heading) of each."""
    target: Floats
    known: Floats
    """(house, x, y) of the target that ``left`` is of."""
    left: Floats
    """Metres from each corner of the house to the target."""
    aim: Floats
    """(x, y) of what each pursues."""


class TruePath:
    """The E bodies of a ``HouseVectorEnv``, told what to do by one who knows the way."""

    def __init__(self, envs: HouseVectorEnv) -> None:
        """Drive these; the bank must stay as it is. ``ValueError`` where bodies do not drive."""
        self.world: World = envs.unwrapped.world
        config = self.world.config
        if not config.drives:
            raise ValueError("a true path is driven: take the backend free, or an oracle")
        config.drive.require_heading("a true path")
        roads, count = Roadmap(self.world, config.body[0] / 2 + AIR, cut=False), self.world.num_envs
        self.arrays = {
            "house": Array(ti.i32, count),
            "pose": Array(ti.f32, 3 * count),
            "target": Array(ti.f32, 2 * count),
            "known": Array.of(np.full(3 * count, -1, np.float32)),
            "left": Array(ti.f32, count * roads.most),
            "aim": Array(ti.f32, 2 * count),
        }
        made = _kernel(start(), config.body[0] / 2, config.target / 2)
        self.launch = Launch(made, roads.arrays | self.arrays)

    def act(self) -> np.ndarray:
        """What to do next: (v, w) (E, 2) float32, or the numbers (E,) int64 of the nearest commands."""
        pose, target, house = self.world.describe()
        self.arrays["house"].fill(house)
        self.arrays["pose"].fill(pose.ravel())
        self.arrays["target"].fill(target.ravel())
        self.launch()
        away = self.arrays["aim"].numpy().reshape(-1, 2) - pose[:, :2]
        bearing = np.arctan2(-away[:, 1], away[:, 0])
        return steered(self.world.config.drive, bearing - pose[:, 2])


@cache
def _kernel(program: Any, radius: float, half: float) -> Any:
    body = radius - 4 * SKIN

    @ti.func
    def edge(place, target):
        """The nearest place to one at which a disc just picks a target up."""
        nearest = ti.max(target - half, ti.min(target + half, place))
        away = place - nearest
        return nearest + away * ti.min(1.0, ti.static(radius - 4 * SKIN) / ti.max(1e-6, away.norm()))

    @kernel
    def pursue(roads: Roads, pursuit: PursuitState):
        for e in range(pursuit.house.shape[0]):
            where, base = pursuit.house[e], e * (pursuit.left.shape[0] // pursuit.house.shape[0])
            first, count, table = graph(roads, where)
            here = ti.Vector([pursuit.pose[3 * e], pursuit.pose[3 * e + 1]])
            goal = point(pursuit.target, e)
            key = ti.Vector([ti.cast(where, ti.f32), goal[0], goal[1]])
            if (key != ti.Vector([pursuit.known[3 * e + k] for k in ti.static(range(3))])).any():
                for k in ti.static(range(3)):
                    pursuit.known[3 * e + k] = key[k]
                for c in range(count):
                    pursuit.left[base + c] = FAR
                for c in range(count):
                    corner = point(roads.corners, first + c)
                    end = edge(corner, goal)
                    if sees(roads, where, corner, end, ti.static(body), True):
                        last = (end - corner).norm()
                        for a in range(count):
                            by = roads.lengths[table + a * count + c] + last
                            pursuit.left[base + a] = ti.min(pursuit.left[base + a], by)
            chosen, end = goal, edge(here, goal)
            if not sees(roads, where, here, end, ti.static(body), True):
                best = ti.f32(FAR)
                for c in range(count):
                    corner = point(roads.corners, first + c)
                    by = pursuit.left[base + c] + (corner - here).norm()
                    if by < best:  # noqa: SIM102 - Taichi does both
                        if sees(roads, where, here, corner, ti.static(body), True):
                            best, chosen = by, corner
            else:
                chosen = ti.max(goal - half, ti.min(goal + half, here))
            pursuit.aim[2 * e], pursuit.aim[2 * e + 1] = chosen[0], chosen[1]

    return pursue
