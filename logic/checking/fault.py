"""What the check finds: words, and the rooms that they are about."""

from typing import NamedTuple


class Fault(NamedTuple):
    """Something that a house breaks."""

    text: str
    rooms: tuple[str, ...] = ()
    """The rooms that it is about, by name; none where it is about the house, or a star's main room alone."""
