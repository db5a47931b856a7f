"""Model of the body and its rays, as a planner needs it."""

from typing import NamedTuple


class BodyModel(NamedTuple):
    """Body that a planner leads."""

    rays: int
    columns: tuple[str, ...]
    """Columns of an observation of each ray: ``Config.columns``."""

    step: int
    """Length of a step, half cells."""

    touching: bool
    """True if the body fills a cell of the house."""

    target: float
    """Half a target's side, cells."""

    ray_range: float
    """Range of the rays, in fractions of a cell: see ``FINE``."""

    noise: float
    """Standard deviation of the rays' distances, cells."""

    dropout: bool
    """True if a ray may return nothing although it met something."""

    slip: bool
    """True if an action may be ignored unnoticed."""

    eighth: int
    """Number of rays in an eighth of a turn."""

    errs: bool
    """True if rays or wheels err and the body does not fill a cell."""

    prior: bool
    """True if the weights of unseen places are given from outside."""

    led: bool
    """True if viewpoints are given from outside and the planner chooses none."""

    drives: bool
    """True if the body is a disc that drives at any heading."""
