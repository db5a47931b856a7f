"""Kinds of furniture that an observation distinguishes, and the codes that rays return for them."""

from collections import Counter
from collections.abc import Sequence

from vitruvius.logic import House
from vitruvius.logic.spelling import unknown
from vitruvius.sim.backends.backend import NAMED, PIECE, WALL
from vitruvius.sim.geometry import Geometry


def pieces_in(house: House) -> Counter[str]:
    """Return the number of pieces of furniture of each kind in a house."""
    return Counter(piece.type for room in house.rooms for piece in room.pieces)


def codes(house: House, shape: Geometry, kinds: Sequence[str]) -> list[int]:
    """Return the codes that rays return for each piece of furniture of a house, then for each of its blocks.

    The code of furniture is ``NAMED`` plus the index of its kind, or ``PIECE``.
    """
    at = {kind: NAMED + place for place, kind in enumerate(kinds)}
    pieces = [at.get(piece.type, PIECE) for room in house.rooms for piece in room.pieces]
    return pieces + [WALL] * len(shape.blocks)


def check_kinds(houses: Sequence[House], kinds: Sequence[str]) -> None:
    """Raise ``ValueError`` if no house has any of these kinds of furniture.

    Some kinds may be missing, so that an agent that distinguishes more kinds than a bank has can still play
    there.
    """
    known = sorted({kind for house in houses for kind in pieces_in(house)})
    if kinds and not set(kinds) & set(known):
        raise ValueError(f"kinds: {unknown('piece', kinds[0], known)}")
