"""State of an environment in kernels: its type, and its place in the arrays of a world."""

from functools import cache
from typing import Any

from vitruvius.sim.runtime import ti
from vitruvius.sim.world.arrays import COUNTERS, FOUND, HEADING, HOUSE, NUMBER, OVER, SEED, TIME

FIELDS = {
    "origin": ti.math.vec2,  # of the body's lattice, or the place of a body that drives, metres
    "target": ti.math.vec2,  # its centre, metres
    "house": ti.i32,
    "time": ti.i32,  # steps in this episode
    "found": ti.i32,  # targets picked up in this episode, plus one
    "over": ti.i32,  # 1 if the episode has ended
    "episode": ti.i32,
    "seed": ti.u64,
}
"""Fields of every state."""


@cache
def state_type(speeds: int) -> Any:
    """Return the type of a state, of a body that drives with this number of speeds, or on a lattice for 0.

    A ``cell`` has what a body's pose has besides the origin. On a lattice it is steps east, steps south and
    heading in eighths of a turn. For a body that drives it is only the heading, in radians.
    """
    if not speeds:
        return ti.types.struct(**FIELDS, cell=ti.math.ivec3)
    return ti.types.struct(**FIELDS, cell=ti.f32, speeds=ti.types.vector(speeds, ti.f32))


def drives(states: Any) -> bool:
    """Return True if a record of arrays has the states of bodies that drive."""
    return "speeds" in states._fields


@ti.func
def loaded(states: ti.template(), e):
    """Return an environment's state."""
    real, whole = states.reals[e], states.wholes[e]
    low = ti.cast(ti.bit_cast(whole[ti.static(SEED)], ti.u32), ti.u64)
    high = ti.cast(ti.bit_cast(whole[ti.static(SEED + 1)], ti.u32), ti.u64)
    state = states.State()
    state.origin, state.target = ti.Vector([real[0], real[1]]), ti.Vector([real[2], real[3]])
    state.house, state.time = whole[ti.static(HOUSE)], whole[ti.static(TIME)]
    state.found, state.over = whole[ti.static(FOUND)], whole[ti.static(OVER)]
    state.episode, state.seed = whole[ti.static(NUMBER)], low | (high << ti.u64(32))
    if ti.static(drives(states)):
        state.cell, state.speeds = real[ti.static(HEADING)], states.speeds[e]
    else:
        state.cell = ti.Vector([whole[ti.static(COUNTERS + k)] for k in range(3)])
    return state


@ti.func
def store(states: ti.template(), e, state):
    """Write an environment's state, except its seed."""
    store_in(states.reals, states.wholes, e, state, ti.static(drives(states)))
    if ti.static(drives(states)):
        states.speeds[e] = state.speeds


@ti.func
def store_in(reals: ti.template(), wholes: ti.template(), e, state, driving: ti.template()):
    """Write an environment's state, except its seed and its speeds."""
    old, origin, target, cell = wholes[e], state.origin, state.target, state.cell
    if ti.static(driving):
        reals[e] = ti.Vector([origin[0], origin[1], target[0], target[1], cell])
        wholes[e] = ti.Vector(
            [state.house, state.time, state.found, state.over, state.episode, old[SEED], old[SEED + 1]]
        )
    else:
        reals[e] = ti.Vector([origin[0], origin[1], target[0], target[1]])
        wholes[e] = ti.Vector(
            [
                state.house, state.time, state.found, state.over, state.episode, old[SEED], old[SEED + 1],
                cell[0], cell[1], cell[2],
            ]
        )  # fmt: skip
