"""What a network reads of a planner: numbers of the whole and of each of eight headings.

The scales below are part of what released networks were trained with.
"""

from agent.planner.state import SEARCH, TARGET
from sim.runtime import ti

SCALARS, SIDES = 14, 3
FEATURES = SCALARS + 8 * SIDES
"""Numbers that describe a planner: some of the whole, some for each of the eight headings."""


@ti.func
def describe(features: ti.template(), state, e, forward, free, gains, turn, action, bearing, nose):
    """Write an environment's features: of the steps at each heading from the body's own whether they are
    ``free`` and what they ``gain``, the advised ``turn`` and ``action``, the path to the goal and its
    ``bearing``, how new things are, and whether the body can go ``forward``; ``nose`` is the way that it
    faces.
    """
    f = e * FEATURES
    crow = bearing.norm() + 1e-3
    far = 0.5 * ti.cast(ti.min(state.path, 2000), ti.f32)
    features[f] = ti.cast(state.kind == SEARCH, ti.f32)
    features[f + 1] = ti.cast(state.kind == TARGET, ti.f32)
    features[f + 2] = ti.exp(-far / 8.0)
    features[f + 3] = ti.exp(-far / 40.0)
    features[f + 4] = ti.exp(-far / 160.0)
    features[f + 5] = ti.exp(-crow / 20.0)
    features[f + 6] = ti.min(1.0, ti.cast(state.new, ti.f32) / 50.0)
    features[f + 7] = ti.min(1.0, ti.cast(state.time - state.last_new, ti.f32) / 100.0)
    features[f + 8] = ti.min(1.0, ti.cast(state.time - state.since, ti.f32) / 300.0)
    features[f + 9] = ti.cast(forward, ti.f32)
    features[f + 10] = bearing.dot(nose) / (crow * nose.norm())
    features[f + 11] = nose.cross(bearing) / (crow * nose.norm())
    features[f + 12] = ti.cast(action == 0, ti.f32)
    features[f + 13] = ti.cast(action == 1, ti.f32)
    for k in range(8):
        side = f + SCALARS + k * SIDES
        features[side] = ti.cast(free[k], ti.f32)
        features[side + 1] = ti.max(-1.0, ti.min(1.0, gains[k]))
        features[side + 2] = ti.cast(turn == k, ti.f32)
