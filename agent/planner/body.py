"""What a planner must know of the body and its rays."""

from typing import NamedTuple


class BodyModel(NamedTuple):
    """The body that a planner leads."""

    rays: int
    columns: tuple[str, ...]
    """What an observation says of each ray: ``Config.columns``."""

    step: int
    """Half cells."""

    touching: bool
    """Whether it fills a cell of the house."""

    target: float
    """Half a target's side, cells."""

    ray_range: float
    """Of rays, parts of a cell."""

    noise: float
    """The standard deviation of the rays' distances, cells."""

    dropout: bool
    """Whether a ray may return nothing though it met something."""

    slip: bool
    """Whether an action may do nothing, unnoticed."""

    eighth: int
    """Rays in an eighth of a turn."""

    errs: bool
    """Whether rays or wheels err, and the body does not fill a cell."""

    prior: bool
    """Whether what unseen places count is given from outside."""

    led: bool
    """Whether its viewpoints are given from outside, and none is chosen."""

    drives: bool = False
    """Whether it is a disc that drives, at any heading."""
