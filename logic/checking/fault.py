"""Result of a check: a text, and the rooms that it concerns."""

from typing import NamedTuple


class Fault(NamedTuple):
    """Promise that a house breaks."""

    text: str
    rooms: tuple[str, ...] = ()
    """Names of the rooms; empty if the fault concerns the house, or only a star's main room."""
