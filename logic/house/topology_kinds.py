"""Kinds of topology, which decide the rules, checks and files of a house."""

from enum import Enum

from vitruvius.logic.house.parts import MAP, ORIGINAL, STAR


class Kind(Enum):
    """Kind of topology."""

    STAR = STAR
    """Rooms touch a main room from outside, each with one door to the main room."""
    ORIGINAL = ORIGINAL
    """Stars of the original program: rooms overlap the main room, which is the rest of its rectangle."""
    MAP = MAP
    """Map of cells: walls surround the free cells, and rooms are names of areas."""
    SHARED_WALLS = "shared walls"
    """All other topologies: rooms tile an outline, and rooms share walls."""


STARS = Kind.STAR, Kind.ORIGINAL
"""Kinds with a main room."""

NAMED = {kind.value: kind for kind in (*STARS, Kind.MAP)}


def kind_of(topology: str) -> Kind:
    """Return the kind of a topology, by its name."""
    return NAMED.get(topology, Kind.SHARED_WALLS)
