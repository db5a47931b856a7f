"""Kernels that reset and step many environments, and that read their states.

A kernel is compiled for a configuration and a backend; houses and states are arrays that it takes as
arguments. So one compilation serves every world of a configuration, and changing the bank costs only its
packing.
"""

from functools import cache
from typing import Any, NamedTuple

from vitruvius.sim.backends.backend import Backend
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Bytes, Floats, Ints, Longs, kernel, ti
from vitruvius.sim.tasks.terms import Terms
from vitruvius.sim.world.distance_field import NOT_YET, look_up, touch
from vitruvius.sim.world.episodes import (
    OVER,
    Episodes,
    PlainArrays,
    Reals,
    RememberingArrays,
    States,
    Wholes,
    WorldArrays,
    loaded,
    store,
)

TERMINATED, TRUNCATED, BLOCKED, FINAL_BLOCKED = range(4)
"""Rows of ``step``'s flags. Only ``SAME_STEP`` has the last row, for the last move of an ended episode."""

NEXT_STEP, SAME_STEP, DISABLED = range(3)
"""Behaviour after an episode's end: the next step begins another episode, the same step does, or none
begins."""

SAMPLE, KEEP = -1, -2
"""Placeholders for a house's number: sample a house; do not begin an episode."""


class Kernels(NamedTuple):
    """Kernels and functions compiled for a configuration."""

    backend: Backend
    episodes: Episodes
    reset: Any
    step: Any
    describe: Any
    peek: Any
    stand: Any
    settle: Any


@cache
def _backend(program: Any, make: type[Backend], config: Config, lanes: int) -> Backend:
    """Return the backend of a configuration, which all its kernels share.

    Kernels of the backend itself, such as those that survey houses, are then compiled once for all modes.
    """
    return make(config, lanes)


@cache
def kernels(
    program: Any,
    config: Config,
    make: type[Backend],
    mode: int,
    by_ray: bool,
    serial: bool,
    ends_on_pick_up: bool,
    terms: Terms,
    at_once: int = 1,
    guided: bool = False,
) -> Kernels:
    """Return kernels for a running Taichi, whose arguments have the names of the world's arrays.

    ``serial``: kernels run in the calling thread, because waking other threads takes longer than stepping a
    few environments. ``guided``: episodes that begin automatically use the options ``next_wholes`` and
    ``next_reals``.
    """
    lanes = 1 if by_ray else config.rays
    backend = _backend(program, make, config, lanes)
    episodes = Episodes(config, backend, ends_on_pick_up, terms, lanes, at_once)
    more = episodes.knows_distance or config.extras or config.latency or guided or at_once > 1
    few = RememberingArrays if terms.memory or terms.surveys else PlainArrays
    Arrays = WorldArrays if more else few
    rays, all_rays = config.rays, not by_ray
    Given = ti.i64 if config.drives else ti.i32
    Observation = ti.types.ndarray(ti.u64 if config.channels == 2 else ti.f32, 1)
    Options = ti.types.ndarray(ti.types.vector(4, ti.i32), 1)

    @ti.func
    def flag(flags: ti.template(), e, count, terminated, truncated, blocked):
        flags[ti.static(TERMINATED) * count + e] = ti.cast(terminated, ti.u8)
        flags[ti.static(TRUNCATED) * count + e] = ti.cast(truncated, ti.u8)
        flags[ti.static(BLOCKED) * count + e] = ti.cast(blocked, ti.u8)

    @ti.func
    def show(pose: ti.template(), target: ti.template(), house: ti.template(), e, state):
        """Write an environment's row of the results of ``describe``."""
        eye = backend.body.eye(state.origin, state.cell)
        pose[3 * e], pose[3 * e + 1] = eye[0], eye[1]
        pose[3 * e + 2] = backend.body.heading(state.cell)
        target[2 * e], target[2 * e + 1] = state.target[0], state.target[1]
        house[e] = state.house

    @ti.func
    def begin(world: ti.template(), e, state, whole, real):
        """Return the state of an environment's next episode, with the options of a row of ``option_wholes``
        and ``option_reals``. Also update the parts of the observation other than rays.
        """
        state = episodes.begin(world, e, state, whole[0])
        if real[0] == real[0]:
            state.origin = ti.Vector([real[0], real[1]])
            state.cell = ti.Vector([whole[1], whole[2], whole[3]])
        if real[2] == real[2]:
            state.target = ti.Vector([real[2], real[3]])
        episodes.close_doors(world, e, state)
        episodes.aim(world, e, state)
        episodes.notice(world, e, state, -1, 0)
        return state

    @ti.func
    def begin_next(world: ti.template(), e, state):
        """Return the state of an environment's next episode, which begins automatically."""
        if ti.static(guided):
            state = begin(world, e, state, world.next_wholes[e], world.next_reals[e])
        else:
            state = episodes.begin(world, e, state, SAMPLE)
            episodes.notice(world, e, state, -1, 0)
        return state

    @kernel
    def reset(world: Arrays, option_wholes: Options, option_reals: Reals, observation: Observation):
        """Begin the next episode of all environments whose house is not ``KEEP``.

        ``option_wholes`` (E, 4) has the house, then the cell. ``option_reals`` (E, 4) has the origin of that
        cell, and the target. Values that are NaN are sampled.
        """
        ti.loop_config(serialize=serial)
        for e in range(world.reals.shape[0]):
            if option_wholes[e][0] != ti.static(KEEP):
                state = begin(world, e, loaded(world, e), option_wholes[e], option_reals[e])
                store(world, e, state)
                if ti.static(all_rays):
                    episodes.look(world, e, state, 0, rays, observation)
        if ti.static(by_ray):
            ti.loop_config(serialize=serial)
            for e, r in ti.ndrange(world.reals.shape[0], rays):
                if option_wholes[e][0] != ti.static(KEEP):
                    episodes.look(world, e, loaded(world, e), r, 1, observation)

    @kernel
    def step(
        world: Arrays,
        action: Longs,
        observation: Observation,
        final: Observation,
        reward: Floats,
        flags: Bytes,
        last_reals: Reals,
        last_wholes: Wholes,
        prefetched: Ints,
        pose: Floats,
        target: Floats,
        house: Ints,
    ):
        """Step every environment with ``action`` (E,). An episode that begins samples its house.

        The kernel fills ``observation``, ``extras``, ``reward`` (E,) and ``flags`` (3, E): terminated,
        truncated, blocked. In ``SAME_STEP`` it also fills a fourth row of ``flags``, ``final``,
        ``final_extras`` and the ``last`` state. For a few environments it also does the work of ``describe``,
        because a second launch would take as long as the step.
        """
        ti.loop_config(serialize=serial)
        for e in range(world.reals.shape[0]):
            if ti.static(all_rays):
                # While this environment is stepped, memory delivers the values that the next one looks up.
                after = loaded(world, ti.min(e + 1, world.reals.shape[0] - 1))
                prefetched[e] = backend.prefetch(
                    world.numbers, world.indices, after.house, after.origin, after.cell
                )
                if ti.static(episodes.knows_distance):
                    at = ti.min(e + 1, world.reals.shape[0] - 1)
                    prefetched[e] &= touch(world, at, after.cell)
            state = loaded(world, e)
            if ti.static(mode == NEXT_STEP) and state.over:
                state = begin_next(world, e, state)
                reward[e] = 0.0
                flag(flags, e, world.reals.shape[0], 0, 0, 0)
            else:
                state, earned, _, terminated, truncated, blocked = episodes.advance(
                    world, e, state, ti.cast(action[e], Given)
                )
                reward[e] = earned
                told = 0 if ti.static(config.drives) else ti.cast(action[e], ti.i32)
                episodes.notice(world, e, state, told, blocked)
                flag(flags, e, world.reals.shape[0], terminated, truncated, blocked)
                if ti.static(mode == SAME_STEP):
                    flags[ti.static(FINAL_BLOCKED) * world.reals.shape[0] + e] = ti.cast(blocked, ti.u8)
                    if state.over:  # the row BLOCKED belongs to the next episode
                        flags[ti.static(BLOCKED) * world.reals.shape[0] + e] = ti.u8(0)
            if ti.static(mode == SAME_STEP) and state.over:
                store(ti.static(States(last_reals, last_wholes)), e, state)
                if ti.static(episodes.knows_distance):
                    world.last_distance[e] = world.distance[e]
                for k in ti.static(range(config.extra_numbers)):
                    at = e * ti.static(config.extra_numbers) + k
                    world.final_extras[at] = world.extras[at]
                for k in ti.static(range(terms.memory)):
                    at = e * ti.static(terms.memory) + k
                    world.last_memory[at] = world.memory[at]
                for k in ti.static(range(2 * at_once - 2)):
                    at = e * ti.static(2 * at_once - 2) + k
                    world.last_others[at] = world.others[at]
                if ti.static(all_rays):
                    episodes.look(world, e, state, 0, rays, final)
                    state = begin_next(world, e, state)
            store(world, e, state)
            if ti.static(serial):
                show(pose, target, house, e, state)
            if ti.static(all_rays):
                episodes.look(world, e, state, 0, rays, observation)
        if ti.static(by_ray):
            if ti.static(mode == SAME_STEP):
                ti.loop_config(serialize=serial)
                for e, r in ti.ndrange(world.reals.shape[0], rays):
                    if world.wholes[e][ti.static(OVER)]:
                        episodes.look(world, e, loaded(world, e), r, 1, final)
                ti.loop_config(serialize=serial)
                for e in range(world.reals.shape[0]):
                    if world.wholes[e][ti.static(OVER)]:
                        store(world, e, begin_next(world, e, loaded(world, e)))
            ti.loop_config(serialize=serial)
            for e, r in ti.ndrange(world.reals.shape[0], rays):
                episodes.look(world, e, loaded(world, e), r, 1, observation)

    @kernel
    def describe(states: States, pose: Floats, target: Floats, house: Ints):
        """Write the eyes' poses (E, 3), the targets' centres (E, 2) and the houses (E,).

        Poses and centres are in metres, headings in radians in [0, 2 pi).
        """
        ti.loop_config(serialize=serial)
        for e in range(states.reals.shape[0]):
            show(pose, target, house, e, loaded(states, e))

    @kernel
    def peek(world: WorldArrays, targets: Floats):
        """Write each environment's current and next targets, (E, count, 2), metres."""
        for e in range(world.reals.shape[0]):
            state, count = loaded(world, e), targets.shape[0] // (2 * world.reals.shape[0])
            for k in range(count):
                targets[2 * (e * count + k)] = state.target[0]
                targets[2 * (e * count + k) + 1] = state.target[1]
                state = episodes.following(world, e, state, k)

    @kernel
    def stand(numbers: Floats, indices: Ints, origins: Floats, cells: Ints, free: Ints):
        """Write 1 for each cell (n, 4) (house, i, j, heading) in which a body can be, else 0.

        The cells are counted from ``origins`` (n, 2), metres.
        """
        for k in range(free.shape[0]):
            origin = ti.Vector([origins[2 * k], origins[2 * k + 1]])
            cell = ti.Vector([cells[4 * k + 1], cells[4 * k + 2], cells[4 * k + 3]])
            free[k] = backend.stands(numbers, indices, cells[4 * k], origin, cell)

    @kernel
    def settle(world: WorldArrays, reward: Floats):
        """Update the distances to new targets, after their fields have been computed."""
        ti.loop_config(serialize=serial)
        for e in range(world.reals.shape[0]):
            if ti.static(episodes.knows_distance):  # noqa: SIM102 - decided as it is compiled
                if world.distance[e] == NOT_YET:
                    state = loaded(world, e)
                    world.distance[e] = look_up(world, e, state.cell)
                    episodes.extras.notice_distance(world, e)
                    if ti.static(terms.progress != 0):  # noqa: SIM102
                        if state.time > 0:
                            after = ti.cast(ti.max(0, world.distance[e]), ti.f32)
                            reward[e] += episodes.progress(0.0, after)

    return Kernels(backend, episodes, reset, step, describe, peek, stand, settle)
