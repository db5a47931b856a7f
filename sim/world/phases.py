"""Phases of the kernels in ``sim.world.kernels``, as functions of one environment."""

from typing import Any

from vitruvius.sim.runtime import ti
from vitruvius.sim.world.arrays import HEADING, NEXT_STEP
from vitruvius.sim.world.distance_field import touch
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.kind import WorldKind
from vitruvius.sim.world.states import drives, loaded, store_in

TERMINATED, TRUNCATED, BLOCKED, FINAL_BLOCKED = range(4)
"""Rows of ``flags``. Only ``SAME_STEP`` has the last row, for the last move of an ended episode."""

SAMPLE, KEEP = -1, -2
"""Placeholders for a house's number: sample a house; do not begin an episode."""


@ti.data_oriented
class Phases:
    """Functions of a step, for a kind of world. ``world`` is a record of arrays."""

    def __init__(self, kind: WorldKind, episodes: Episodes) -> None:
        """Take the episodes of a kind of world."""
        self.kind, self.config, self.episodes = kind, kind.config, episodes
        self.backend: Any = episodes.backend

    @ti.func
    def fetch(self, world: ti.template(), e):
        """Read values that the next environment looks up.

        While environment e is stepped, memory delivers them.
        """
        after = ti.min(e + 1, world.reals.shape[0] - 1)
        state = loaded(world, after)
        world.prefetched[e] = self.backend.prefetch(
            world.numbers, world.indices, state.house, state.origin, state.cell
        )
        if ti.static(self.kind.knows_distance):
            world.prefetched[e] &= touch(world, after, state.cell)

    @ti.func
    def begin(self, world: ti.template(), e, state, whole, real):
        """Return the state of an environment's next episode.

        A row of ``option_wholes`` and ``option_reals`` has the options. Also update the parts of the
        observation other than rays.
        """
        state = self.episodes.begin(world, e, state, whole[0])
        if real[0] == real[0]:  # no NaN
            state.origin = ti.Vector([real[0], real[1]])
            if ti.static(self.config.drives):
                state.cell = real[ti.static(HEADING)]
            else:
                state.cell = ti.Vector([whole[1], whole[2], whole[3]])
        if real[2] == real[2]:
            state.target = ti.Vector([real[2], real[3]])
        self.episodes.lay(world, e, state)
        self.episodes.aim(world, e, state)
        self.episodes.notice(world, e, state, -1, 0)
        return state

    @ti.func
    def begin_next(self, world: ti.template(), e, state):
        """Return the state of an environment's next episode, which begins automatically."""
        if ti.static(self.kind.guided):
            state = self.begin(world, e, state, world.next_wholes[e], world.next_reals[e])
        else:
            state = self.episodes.begin(world, e, state, SAMPLE)
            self.episodes.notice(world, e, state, -1, 0)
        return state

    @ti.func
    def play(self, world: ti.template(), e, state):
        """Return the state after a step, or after the begin of an episode in the mode ``NEXT_STEP``.

        Also write the reward, the flags, and the parts of the observation other than rays.
        """
        if ti.static(self.kind.mode == NEXT_STEP) and state.over:
            state = self.begin_next(world, e, state)
            world.reward[e] = 0.0
            self.flag(world, e, 0, 0, 0)
        else:
            state, earned, _, terminated, truncated, blocked = self.episodes.advance(
                world, e, state, self.action(world, e)
            )
            world.reward[e] = earned
            told = 0
            if ti.static(not self.config.drives):
                told = ti.cast(world.action[e], ti.i32)
            self.episodes.notice(world, e, state, told, blocked)
            self.flag(world, e, terminated, truncated, blocked)
        return state

    @ti.func
    def action(self, world: ti.template(), e):
        """Return the action of an environment: its number, or speeds."""
        if ti.static(self.config.drives):
            return world.action[e]
        return ti.cast(world.action[e], ti.i32)

    @ti.func
    def flag(self, world: ti.template(), e, terminated, truncated, blocked):
        """Write the flags of an environment."""
        count = world.reals.shape[0]
        world.flags[ti.static(TERMINATED) * count + e] = ti.cast(terminated, ti.u8)
        world.flags[ti.static(TRUNCATED) * count + e] = ti.cast(truncated, ti.u8)
        world.flags[ti.static(BLOCKED) * count + e] = ti.cast(blocked, ti.u8)

    @ti.func
    def part(self, world: ti.template(), e, state):
        """Separate the results of an episode's last step from those of the next episode, in ``SAME_STEP``.

        The state, the distance, the targets and the numbers are kept in the arrays ``last`` and ``final``.
        """
        count = world.reals.shape[0]
        world.flags[ti.static(FINAL_BLOCKED) * count + e] = world.flags[ti.static(BLOCKED) * count + e]
        if state.over:
            world.flags[ti.static(BLOCKED) * count + e] = ti.u8(0)
            store_in(world.last_reals, world.last_wholes, e, state, ti.static(drives(world)))
            if ti.static(self.kind.knows_distance):
                world.last_distance[e] = world.distance[e]
            if ti.static(self.config.extra_numbers > 0):
                self.copy(world.extras, world.final_extras, e, self.config.extra_numbers)
            if ti.static(self.kind.terms.memory > 0):
                self.copy(world.memory, world.last_memory, e, self.kind.terms.memory)
            if ti.static(self.kind.at_once > 1):
                self.copy(world.others, world.last_others, e, 2 * self.kind.at_once - 2)

    @ti.func
    def copy(self, of: ti.template(), to: ti.template(), e, numbers: ti.template()):
        """Copy an environment's numbers from one array to another."""
        for k in ti.static(range(numbers)):
            to[e * numbers + k] = of[e * numbers + k]

    @ti.func
    def show(self, state, pose: ti.template(), target: ti.template(), house: ti.template(), e):
        """Write an environment's row of the info."""
        eye = self.episodes.body.eye(state.origin, state.cell)
        pose[3 * e], pose[3 * e + 1] = eye[0], eye[1]
        pose[3 * e + 2] = self.episodes.body.heading(state.cell)
        target[2 * e], target[2 * e + 1] = state.target[0], state.target[1]
        house[e] = state.house
