"""Options of all built-in tasks: terms, rooms where episodes start, and the number of targets at once."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from vitruvius.logic import House
from vitruvius.logic.spelling import unknown
from vitruvius.sim.fields import settle
from vitruvius.sim.geometry import Box
from vitruvius.sim.tasks.terms import PLAIN, Terms

MAX_AT_ONCE = 64
"""Largest number of targets at once. Each step computes the visibility of all of them."""


def require_at_once(number: int) -> None:
    """Raise ``ValueError`` for an invalid number of targets at once."""
    if not 1 <= number <= MAX_AT_ONCE:
        raise ValueError(f"at_once is {number!r}: it must be 1 to {MAX_AT_ONCE} targets")


@dataclass(frozen=True)
class BaseTask:
    """Base class of the built-in tasks, with the options that all tasks share."""

    terms: Terms = field(default=PLAIN, kw_only=True, repr=False)
    """Rewards, and conditions that end an episode."""
    starts: Literal["all"] | Sequence[str] = field(default=(), kw_only=True, repr=False)
    """Types of the rooms where episodes start, or ``all``; the default is the main room or hub."""
    at_once: int = field(default=1, kw_only=True, repr=False)
    """Number of targets at once. When the agent picks up one of them, a new target appears."""

    def __post_init__(self) -> None:
        """Raise ``TypeError`` for invalid room types, and ``ValueError`` for other invalid values."""
        settle(self)
        if self.starts != "all":
            if isinstance(self.starts, str) or not all(isinstance(name, str) for name in self.starts):
                raise TypeError(f"starts: give a list of room types, or all, not {self.starts!r}")
            object.__setattr__(self, "starts", tuple(self.starts))
        require_at_once(self.at_once)

    def start_spaces(self, house: House) -> list[Box]:
        """Return the rectangles where episodes start; an empty list stands for ``House.start``.

        At the start of an episode the body lies completely in one of the rectangles. Raises ``ValueError``
        for a house without such a room.
        """
        if self.starts == "all":
            return [room.box for room in house.rooms]
        known = {room.type for room in house.rooms}
        if self.starts and not known & set(self.starts):
            raise ValueError(f"starts: {unknown('room type', self.starts[0], sorted(known))}")
        return [room.box for room in house.rooms if room.type in self.starts]
