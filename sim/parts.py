"""Table of the parts of an observation other than rays, in which all of them are listed once.

From the table come the spaces of observations, the array ``extras``, and the page ``docs/arrays.md``.
``sim.world.extras`` writes the parts.
"""

from collections.abc import Callable
from math import inf
from typing import Any, NamedTuple


class ObservedPart(NamedTuple):
    """A part of an observation."""

    meaning: str

    numbers: int | Callable[[Any], int]
    """Number of its values, or a function of a ``Config`` that returns the number."""

    unit: str = ""

    low: float = -inf
    high: float = inf
    """Bounds of its values."""

    sees_room: bool = False
    """True if it needs ``surroundings``, the table of rooms, and ``rooms``, the last rooms of bodies."""


MEMORY = "memory"
"""Name of the part of an observation with the values that the task's terms keep."""

PARTS = {
    "bump": ObservedPart("1 if the last move was blocked", 1, low=0, high=1),
    "last_action": ObservedPart(
        "1 for the last action; none in an episode's first observation", 3, low=0, high=1
    ),
    "odometry": ObservedPart(
        "estimated place, forward and left of the start; cosine and sine of the turn", 4, "m"
    ),
    "goal": ObservedPart("forward and left from the body to the target", 2, "m"),
    "geodesic": ObservedPart("fewest actions to the target; -1 if no path leads there", 1, "actions", low=-1),
    "speed": ObservedPart(
        "forward speed and turn rate to the left; with `sideways`, speeds forward and left and the turn "
        "rate; only in the backend `free`",
        lambda config: len(config.drive.low),
        "m/s, rad/s",
    ),
    MEMORY: ObservedPart("numbers that the task's terms keep", lambda config: config.memory, "the terms'"),
}
"""Parts by their names in ``Config.observe``."""
