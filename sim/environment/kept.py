"""Environments that are kept for later: their state as arrays, and pickled."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sim.actions import HEADINGS
from sim.config import Config
from sim.geometry import Geometry
from sim.world.episodes import HOUSE

SPACES = "observation_space", "action_space", "single_observation_space", "single_action_space"

KEPT = (*SPACES, "_np_random", "_np_random_seed", "spec")
"""What a pickled environment has beside its arguments and its state: spaces sample at random, too."""


MARGIN_M = 1.0
"""Distance that a body may be outside its house: a collision that ends an episode leaves it in the wall."""


def require_state(
    state: dict[str, Any], own: dict[str, np.ndarray], geometries: Sequence[Geometry], config: Config
) -> None:
    """Raise ``ValueError`` for a state that environments in houses of these ``geometries`` cannot have.

    ``own`` is the state that it replaces.
    """
    kinds = {name: (array.dtype.str, array.shape) for name, array in own.items()}
    given = {name: np.asarray(array) for name, array in state.items()}
    if {name: (array.dtype.str, array.shape) for name, array in given.items()} != kinds:
        raise ValueError(f"a state of other kinds or shapes: here they are {kinds}")
    reals, wholes = given["reals"].astype(np.float64), given["wholes"]
    house, cells, place = wholes[:, HOUSE], wholes[:, :HOUSE], reals[:, :2]
    if strange := house[(house < 0) | (house >= len(geometries))].tolist():
        raise ValueError(f"a state of another bank: a body is in house {strange[0]} of {len(geometries)}")
    if config.drives:
        if config.drive.sideways:  # speeds are whole numbers
            cells = cells[:, 2:]
        if not np.isfinite(np.ascontiguousarray(cells).view(np.float32)).all():
            raise ValueError("a state of no house: a speed or a heading is no finite number")
    else:
        place = place + config.step * cells[:, :2]  # cells count from the start of an episode: some are < 0
        headings = np.concatenate([given.get("past_cells", cells)[:, 2], cells[:, 2]])
        if not ((headings >= 0) & (headings < len(HEADINGS))).all():
            raise ValueError("a state of no house: a body has no heading")
    known, which = np.unique(house, return_inverse=True)
    bounds = np.array([geometries[k].bounds for k in known])[which]
    inside = (bounds[:, :2] - MARGIN_M <= place) & (place <= bounds[:, 2:] + MARGIN_M)
    if not (inside.all() and np.isfinite(reals).all()):
        raise ValueError("a state of no house: a body is outside its house, or a target is nowhere")


def remade(
    kind: type,
    arguments: dict[str, Any],
    kept: dict[str, Any],
    state: dict[str, np.ndarray] | None,
    closed: bool,
) -> Any:
    """The environments that were pickled."""
    envs = kind(**arguments)
    envs.__dict__.update(kept)
    if state is not None:
        envs.state = state
    if closed:
        envs.close()
    return envs
