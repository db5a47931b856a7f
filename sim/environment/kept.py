"""Environments that are kept for later: their state as arrays, and pickled."""

from typing import Any

import numpy as np

from sim.config import Config
from sim.world.episodes import HOUSE, MOST_CELLS

SPACES = "observation_space", "action_space", "single_observation_space", "single_action_space"

KEPT = (*SPACES, "_np_random", "_np_random_seed", "spec")
"""What a pickled environment has beside its arguments and its state: spaces sample at random, too."""


def require_state(state: dict[str, Any], own: dict[str, np.ndarray], houses: int, config: Config) -> None:
    """Raise ``ValueError`` for a state that environments with a bank of so many houses, whose ``own`` state
    it is to replace, cannot have.
    """
    kinds = {name: (array.dtype.str, array.shape) for name, array in own.items()}
    given = {name: np.asarray(array) for name, array in state.items()}
    if {name: (array.dtype.str, array.shape) for name, array in given.items()} != kinds:
        raise ValueError(f"a state of other kinds or shapes: here they are {kinds}")
    house, cells = given["wholes"][:, HOUSE], given["wholes"][:, :HOUSE]
    if strange := house[(house < 0) | (house >= houses)].tolist():
        raise ValueError(f"a state of another bank: a body is in house {strange[0]} of {houses}")
    if config.drives:
        if config.drive.sideways:  # speeds are whole numbers
            cells = cells[:, 2:]
        if not np.isfinite(np.ascontiguousarray(cells).view(np.float32)).all():
            raise ValueError("a state of no house: a speed or a heading is no finite number")
    elif not ((cells >= 0) & (cells < MOST_CELLS)).all():
        raise ValueError("a state of no house: a body is in no cell, or has no heading")


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
