# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportCallIssue=false, reportOptionalCall=false
"""The state of E environments over a bank of houses: episodes, targets, rewards and random numbers.

How bodies move and what they see is the backend's. Every draw is Philox's word for (seed of the
environment, episode, counter): counter 0 is the episode's house and start, counter k its k-th target, so no
draw depends on how many environments there are, on how often others reset, or, for targets, on the agent.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from logic import House
from sim.backend import Backend
from sim.body import SKIN
from sim.config import Config
from sim.philox import below, philox
from sim.places import places
from sim.runtime import ti

TRIES = 32
"""Draws until a place that should lie apart from another is taken as it comes."""

NORTH = 2
"""The heading of fixed starts."""

TERMINATED, TRUNCATED, BLOCKED = range(3)
"""Rows of ``step``'s flags."""


@ti.data_oriented
class World:
    """E environments. Arrays that ``reset`` and ``step`` fill are the caller's: contiguous."""

    def __init__(
        self, config: Config, backend: Backend, houses: Sequence[House], targets: str, num_envs: int
    ):
        """Pack the houses into the backend and find their starts and targets (``ValueError`` if none)."""
        self.config, self.backend, self.num_envs = config, backend, num_envs
        self.body = backend.body
        # Apart by more than this, a target is not picked up from where the one before it was.
        self.apart = config.target + max(config.body)
        self._pack(houses, targets)
        self.seed = ti.field(ti.u64, shape=num_envs)
        self.episode = ti.field(ti.i32, shape=num_envs)
        self.house = ti.field(ti.i32, shape=num_envs)
        self.origin = ti.Vector.field(2, ti.f32, shape=num_envs)
        self.cell = ti.Vector.field(3, ti.i32, shape=num_envs)
        self.target = ti.Vector.field(2, ti.f32, shape=num_envs)
        self.count = ti.field(ti.i32, shape=num_envs)
        self.time = ti.field(ti.i32, shape=num_envs)
        self.over = ti.field(ti.i32, shape=num_envs)

    def _pack(self, houses: Sequence[House], targets: str) -> None:
        bank = self.backend.pack(houses)
        self.lattices, found = [], []
        for index, shape in enumerate(bank):
            try:
                lattice = self.backend.lattice(index)
                survey = self.backend.survey(index, lattice)
                found.append(places(shape, lattice, survey, self.config, targets))
                self.lattices.append(lattice)
            except ValueError as error:
                raise ValueError(f"house {index} of {len(bank)}: {error}") from None
        self.num_houses = len(bank)
        self.corner = ti.Vector.field(2, ti.f32, shape=len(bank))
        self.corner.from_numpy(np.stack([lattice.origin for lattice in self.lattices]))
        self.start_end, self.starts = _ragged([here.starts for here in found])
        self.target_end, self.targets = _ragged([here.targets for here in found])

    @ti.kernel
    def sow(self, seeds: ti.types.ndarray(ti.u64, 1)):
        """Give each environment its seed (E,) uint64; its next episode is number 0."""
        for e in self.seed:
            self.seed[e] = seeds[e]
            self.episode[e] = -1

    @ti.kernel
    def reset(
        self,
        house: ti.types.ndarray(ti.i32, 1),
        origin: ti.types.ndarray(ti.f32, 2),
        cell: ti.types.ndarray(ti.i32, 2),
        target: ti.types.ndarray(ti.f32, 2),
        observation: ti.types.ndarray(ti.f32, 3),
    ):
        """Begin every environment's next episode, in ``house`` (E,) where that is not negative; an ``origin``
        (E, 2) with its ``cell`` (E, 3) and a ``target`` (E, 2) replace what is drawn where they are not NaN.
        """
        for e in range(self.num_envs):
            self.enter(e, house[e])
            self.draw_target(e, -1.0)
            self.draw_start(e)
            if origin[e, 0] == origin[e, 0]:
                self.origin[e] = ti.Vector([origin[e, 0], origin[e, 1]])
                self.cell[e] = ti.Vector([cell[e, 0], cell[e, 1], cell[e, 2]])
            if target[e, 0] == target[e, 0]:
                self.target[e] = ti.Vector([target[e, 0], target[e, 1]])
            self.look(e, observation)

    @ti.kernel
    def step(
        self,
        action: ti.types.ndarray(ti.i64, 1),
        observation: ti.types.ndarray(ti.f32, 3),
        reward: ti.types.ndarray(ti.f32, 1),
        flags: ti.types.ndarray(ti.u8, 2),
    ):
        """One step of every environment; the step after an episode's end begins the next one instead.

        ``action`` (E,) int64; fills ``observation`` (E, R, C) and ``reward`` (E,) float32, and ``flags``
        (3, E) uint8: terminated, truncated, blocked.
        """
        for e in range(self.num_envs):
            picked, terminated, truncated, blocked = self.advance(e, ti.cast(action[e], ti.i32))
            reward[e] = ti.cast(picked, ti.f32)
            flags[ti.static(TERMINATED), e] = ti.cast(terminated, ti.u8)
            flags[ti.static(TRUNCATED), e] = ti.cast(truncated, ti.u8)
            flags[ti.static(BLOCKED), e] = ti.cast(blocked, ti.u8)
            self.look(e, observation)

    @ti.kernel
    def describe(
        self,
        pose: ti.types.ndarray(ti.f32, 2),
        target: ti.types.ndarray(ti.f32, 2),
        house: ti.types.ndarray(ti.i32, 1),
    ):
        """Write the eyes' poses (E, 3), metres and radians in [0, 2 pi), the targets' centres (E, 2), metres,
        and the houses (E,).
        """
        for e in range(self.num_envs):
            eye = self.body.eye(self.origin[e], self.cell[e])
            pose[e, 0], pose[e, 1] = eye[0], eye[1]
            pose[e, 2] = ti.cast(self.cell[e][2], ti.f32) * ti.static(np.pi / 4)
            target[e, 0], target[e, 1] = self.target[e][0], self.target[e][1]
            house[e] = self.house[e]

    @ti.func
    def advance(self, e, action):
        """One step of an environment but for sight: picked up, terminated, truncated, blocked (i32)."""
        fresh = self.over[e]
        picked, terminated, truncated, blocked = 0, 0, 0, 0
        if fresh:
            self.enter(e, -1)
        else:
            cell, blocked_ = self.backend.move(self.house[e], self.origin[e], self.cell[e], action)
            blocked = blocked_
            if ti.static(self.config.ends_on_collision):
                terminated = blocked
            elif blocked:
                cell = self.cell[e]
            self.cell[e] = cell
            picked = self.overlaps(self.origin[e], cell, self.target[e])
            self.time[e] += 1
            truncated = ti.cast(self.time[e] >= ti.static(self.config.steps), ti.i32)
            self.over[e] = terminated | truncated
        if fresh | picked:
            self.draw_target(e, ti.select(fresh, -1.0, ti.static(self.apart)))
        if fresh:
            self.draw_start(e)
        return picked, terminated, truncated, blocked

    @ti.func
    def enter(self, e, wanted):
        """Begin an environment's next episode in the wanted house, or a drawn one if that is negative."""
        self.episode[e] += 1
        house = ti.select(wanted >= 0, wanted, below(self.draw(e, 0, 0)[0], self.num_houses))
        self.house[e], self.origin[e] = house, self.corner[house]
        self.time[e], self.count[e], self.over[e] = 0, 0, 0

    @ti.func
    def draw_start(self, e):
        """Draw where an environment's episode starts, not on its first target."""
        first, last = span(self.start_end, self.house[e])
        turn, searching = 0, 1
        while searching:
            turn += 1
            words = self.draw(e, 0, turn)
            place = self.starts[first + below(words[0], last - first)]
            heading = ti.select(ti.static(self.config.random_start), below(words[1], 8), NORTH)
            self.cell[e] = ti.Vector([place[0], place[1], heading])
            on_target = self.overlaps(self.origin[e], self.cell[e], self.target[e])
            searching = on_target & ti.cast(turn < ti.static(TRIES), ti.i32)

    @ti.func
    def draw_target(self, e, apart):
        """Draw an environment's next target, not within ``apart`` metres of the last along both axes."""
        self.count[e] += 1
        corner, last_target = self.corner[self.house[e]], self.target[e]
        first, last = span(self.target_end, self.house[e])
        turn, searching = 0, 1
        while searching:
            turn += 1
            place = self.targets[first + below(self.draw(e, self.count[e], turn)[0], last - first)]
            self.target[e] = corner + ti.cast(place, ti.f32) * ti.static(self.config.step)
            near = ti.cast(ti.abs(self.target[e] - last_target).max() < apart, ti.i32)
            searching = near & ti.cast(turn < ti.static(TRIES), ti.i32)

    @ti.func
    def draw(self, e, counter, turn):
        """The random words of this environment's episode for a counter, at a turn of drawing again."""
        words = ti.Vector([self.episode[e], counter, turn, 0])
        return philox(self.seed[e], ti.cast(words, ti.u64))

    @ti.func
    def overlaps(self, origin, cell, target):
        """Whether the body overlaps a target's square (i32); touching is not overlapping."""
        reach = self.body.half(cell) + ti.static(self.config.target / 2 - SKIN)
        return ti.cast(ti.abs(self.body.centre(origin, cell) - target).max() < reach, ti.i32)

    @ti.func
    def look(self, e, observation: ti.template()):
        """Write what an environment's rays see: (angle / 359 degrees,) distance / range, is target."""
        cell = self.cell[e]
        distance, seen = self.backend.see(self.house[e], self.origin[e], cell, self.target[e])
        at = ti.static(self.config.channels - 2)
        for r in range(ti.static(self.config.rays)):
            observation[e, r, at] = distance[r] * ti.static(1 / self.config.range)
            observation[e, r, at + 1] = seen[r]
        if ti.static(self.config.sees_angle):
            for r in range(ti.static(self.config.rays)):
                angle = (
                    45.0 * cell[2] + ti.static(self.config.first_ray) - ti.static(self.config.ray_spacing) * r
                )
                observation[e, r, 0] = (angle - 360.0 * ti.floor(angle / 360.0)) / 359.0


@ti.func
def span(ends: ti.template(), house):
    """Where a house's rows begin and end in a ragged field."""
    first = 0
    if house > 0:
        first = ends[house - 1]
    return first, ends[house]


def _ragged(rows: list[np.ndarray]) -> tuple[Any, Any]:
    """Lists of (n, 2) int32 rows end to end, as a field of ends (H,) and one of 2-vectors."""
    ends = ti.field(ti.i32, shape=len(rows))
    ends.from_numpy(np.cumsum([len(r) for r in rows]).astype(np.int32))
    flat = ti.Vector.field(2, ti.i32, shape=sum(len(r) for r in rows))
    flat.from_numpy(np.concatenate(rows))
    return ends, flat
