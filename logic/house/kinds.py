"""The kinds of topology: how rooms lie together decides which rules, checks and files a house has."""

from enum import Enum

from logic.house.parts import MAP, ORIGINAL, STAR


class Kind(Enum):
    """A kind of topology."""

    STAR = STAR
    """Rooms touch a main room from outside, each with one door to it."""
    ORIGINAL = ORIGINAL
    """Stars of the original program: rooms overlap the main room, which is what they leave of it."""
    MAP = MAP
    """A map of cells: walls are around the free ones, and rooms are names of areas."""
    SHARED_WALLS = "shared walls"
    """All others: rooms tile an outline, and walls stand once."""


STARS = Kind.STAR, Kind.ORIGINAL
"""The kinds that have a main room."""

NAMED = {kind.value: kind for kind in (*STARS, Kind.MAP)}


def kind_of(topology: str) -> Kind:
    """The kind of a topology, by its name."""
    return NAMED.get(topology, Kind.SHARED_WALLS)
