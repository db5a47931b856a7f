"""What a network is told of a map: numbers of the whole and of each of eight headings."""

from agent.planner.counts import COUNTS, KIND, LAST_NEW, NEW, SEARCH, SINCE, TARGET, TIME, WAY
from sim.runtime import ti

SCALARS, SIDES = 14, 3
FEATURES = SCALARS + 8 * SIDES
"""Numbers that describe a map: some of the whole, some for each of the eight headings."""


@ti.func
def describe(
    features: ti.template(), counts: ti.template(), e, forward, free, gains, turn, action, bearing, nose
):
    """Write an environment's features: of the steps at each heading from the body's own whether they are
    ``free`` and what they ``gain``, the advised ``turn`` and ``action``, the way and the ``bearing`` of the
    goal, how new things are, and whether the body can go ``forward``; ``nose`` is the way that it faces.
    """
    w, f = e * COUNTS, e * FEATURES
    kind, time = counts[w + KIND], counts[w + TIME]
    crow = bearing.norm() + 1e-3
    far = 0.5 * ti.cast(ti.min(counts[w + WAY], 2000), ti.f32)
    features[f] = ti.cast(kind == SEARCH, ti.f32)
    features[f + 1] = ti.cast(kind == TARGET, ti.f32)
    features[f + 2] = ti.exp(-far / 8.0)
    features[f + 3] = ti.exp(-far / 40.0)
    features[f + 4] = ti.exp(-far / 160.0)
    features[f + 5] = ti.exp(-crow / 20.0)
    features[f + 6] = ti.min(1.0, ti.cast(counts[w + NEW], ti.f32) / 50.0)
    features[f + 7] = ti.min(1.0, ti.cast(time - counts[w + LAST_NEW], ti.f32) / 100.0)
    features[f + 8] = ti.min(1.0, ti.cast(time - counts[w + SINCE], ti.f32) / 300.0)
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
