"""Kernels that reset and step many environments, and that read their states.

A kernel is compiled for a kind of world and a backend; houses and states are arrays that it takes as
arguments. So one compilation serves every world of a kind, and changing the bank costs only its packing.
Arguments have the names of the world's arrays: see ``sim.world.arrays``.
"""

from functools import cache
from typing import Any, NamedTuple

from vitruvius.sim.backends.backend import Backend
from vitruvius.sim.config import Config
from vitruvius.sim.runtime import Floats, Ints, kernel, ti
from vitruvius.sim.world.arrays import OPTIONS, OVER, SAME_STEP
from vitruvius.sim.world.distance_field import NOT_YET, look_up
from vitruvius.sim.world.episodes import Episodes
from vitruvius.sim.world.kind import WorldKind
from vitruvius.sim.world.phases import KEEP, Phases
from vitruvius.sim.world.states import loaded, store


class Kernels(NamedTuple):
    """Kernels and functions compiled for a kind of world."""

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
def kernels(program: Any, kind: WorldKind, make: type[Backend]) -> Kernels:
    """Return kernels for a running Taichi."""
    rays, serial, by_ray, same = kind.config.rays, kind.serial, kind.by_ray, kind.mode == SAME_STEP
    lanes = 1 if by_ray else rays
    backend = _backend(program, make, kind.config, lanes)
    episodes = Episodes(kind, backend, lanes)
    phases = Phases(kind, episodes)
    Arrays, Results, States, Options = kind.arrays, kind.results, kind.states, kind.record(OPTIONS)

    @kernel
    def reset(world: Results, options: Options):
        """Begin the next episode of all environments whose house is not ``KEEP``."""
        ti.loop_config(serialize=serial)
        for e in range(world.reals.shape[0]):
            if options.option_wholes[e][0] != ti.static(KEEP):
                whole, real = options.option_wholes[e], options.option_reals[e]
                state = phases.begin(world, e, loaded(world, e), whole, real)
                store(world, e, state)
                if ti.static(not by_ray):
                    episodes.look(world, e, state, 0, rays, world.observation)
        if ti.static(by_ray):
            ti.loop_config(serialize=serial)
            for e, r in ti.ndrange(world.reals.shape[0], rays):
                if options.option_wholes[e][0] != ti.static(KEEP):
                    episodes.look(world, e, loaded(world, e), r, 1, world.observation)

    @kernel
    def step(world: Results):
        """Step every environment with its ``action``. An episode that begins samples its house.

        For a few environments the kernel also does the work of ``describe``, because a second launch would
        take as long as the step.
        """
        ti.loop_config(serialize=serial)
        for e in range(world.reals.shape[0]):
            if ti.static(not by_ray):
                phases.fetch(world, e)
            # move
            state = phases.play(world, e, loaded(world, e))
            # end
            if ti.static(same):
                phases.part(world, e, state)
                if ti.static(not by_ray) and state.over:
                    episodes.look(world, e, state, 0, rays, world.final)
                    state = phases.begin_next(world, e, state)
            store(world, e, state)
            if ti.static(serial):
                phases.show(state, world.pose, world.target, world.house, e)
            # see
            if ti.static(not by_ray):
                episodes.look(world, e, state, 0, rays, world.observation)
        if ti.static(by_ray and same):  # end
            ti.loop_config(serialize=serial)
            for e, r in ti.ndrange(world.reals.shape[0], rays):
                if world.wholes[e][ti.static(OVER)]:
                    episodes.look(world, e, loaded(world, e), r, 1, world.final)
            ti.loop_config(serialize=serial)
            for e in range(world.reals.shape[0]):
                if world.wholes[e][ti.static(OVER)]:
                    store(world, e, phases.begin_next(world, e, loaded(world, e)))
        if ti.static(by_ray):  # see
            ti.loop_config(serialize=serial)
            for e, r in ti.ndrange(world.reals.shape[0], rays):
                episodes.look(world, e, loaded(world, e), r, 1, world.observation)

    @kernel
    def describe(states: States, pose: Floats, target: Floats, house: Ints):
        """Write the eyes' poses (E, 3), the targets' centres (E, 2) and the houses (E,).

        Poses and centres are in metres, headings in radians in [0, 2 pi).
        """
        ti.loop_config(serialize=serial)
        for e in range(states.reals.shape[0]):
            phases.show(loaded(states, e), pose, target, house, e)

    @kernel
    def peek(world: Arrays, targets: Floats):
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
    def settle(world: Results):
        """Update the distances to new targets, after ``Distances`` has computed their fields."""
        ti.loop_config(serialize=serial)
        for e in range(world.reals.shape[0]):
            if world.distance[e] == NOT_YET:
                state = loaded(world, e)
                world.distance[e] = look_up(world, e, state.cell)
                episodes.extras.notice_distance(world, e)
                if ti.static(kind.terms.progress != 0):  # noqa: SIM102 - decided as it is compiled
                    if state.time > 0:
                        after = ti.cast(ti.max(0, world.distance[e]), ti.f32)
                        world.reward[e] += episodes.progress(0.0, after)

    return Kernels(backend, episodes, reset, step, describe, peek, stand, settle)
