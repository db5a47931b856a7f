"""What all tasks that come with the project may be asked for: terms, and where episodes start."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from logic import House
from logic.spelling import unknown
from sim.fields import settle
from sim.geometry import Box
from sim.tasks.terms import PLAIN, Terms

MAX_AT_ONCE = 64
"""Targets that are there at once: each is looked for in each step."""


def require_at_once(number: int) -> None:
    """Raise ``ValueError`` for a number of targets that cannot be there at once."""
    if not 1 <= number <= MAX_AT_ONCE:
        raise ValueError(f"at_once is {number!r}: from 1 to {MAX_AT_ONCE} targets")


@dataclass(frozen=True)
class BaseTask:
    """Of a task beside its targets."""

    terms: Terms = field(default=PLAIN, kw_only=True, repr=False)
    """What is rewarded, and when an episode ends."""
    starts: Literal["all"] | Sequence[str] = field(default=(), kw_only=True, repr=False)
    """Types of the rooms where episodes start, or ``all``; by default the main room, or hub, alone."""
    at_once: int = field(default=1, kw_only=True, repr=False)
    """Targets that are there at once; whichever is picked up, the next one appears."""

    def __post_init__(self) -> None:
        """Raise ``TypeError`` for what are no types of rooms, ``ValueError`` for other wrong values."""
        settle(self)
        if self.starts != "all":
            if isinstance(self.starts, str) or not all(isinstance(name, str) for name in self.starts):
                raise TypeError(f"starts: a list of room types, or all, not {self.starts!r}")
            object.__setattr__(self, "starts", tuple(self.starts))
        require_at_once(self.at_once)

    def start_spaces(self, house: House) -> list[Box]:
        """The rectangles of which a body that starts lies wholly in one; none for the usual room.

        Raises ``ValueError`` where a house has no such room.
        """
        if self.starts == "all":
            return [room.box for room in house.rooms]
        known = {room.type for room in house.rooms}
        if self.starts and not known & set(self.starts):
            raise ValueError(f"starts: {unknown('room type', self.starts[0], sorted(known))}")
        return [room.box for room in house.rooms if room.type in self.starts]
