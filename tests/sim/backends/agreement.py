"""Comparison of backends that must show the same from the same place."""

from collections.abc import Sequence

import numpy as np

from vitruvius.logic import House
from vitruvius.sim import HouseVectorEnv


def require_equal_rays(houses: Sequence[House], count: int, targets: str) -> None:
    """Require the same distances and the same targets from both backends at the grid's poses."""
    grid, continuous = (
        HouseVectorEnv(houses, num_envs=count, backend=backend, targets=targets)
        for backend in ("grid", "continuous")
    )
    ours, info = grid.reset(seed=0)
    options = {name: info[name] for name in ("house", "pose", "target")}
    theirs, _ = continuous.reset(seed=0, options=options)
    assert np.abs(ours - theirs)[..., 0].max() * grid.config.range < 1e-5
    np.testing.assert_array_equal(ours[..., 1], theirs[..., 1])
