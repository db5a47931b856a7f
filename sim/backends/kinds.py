"""Kinds of pieces that an observation tells apart: what a ray that ends on a piece says of it."""

from collections import Counter
from collections.abc import Sequence

from logic import House
from logic.spelling import unknown
from sim.backends.backend import NAMED, PIECE, WALL
from sim.geometry import Geometry


def pieces_in(house: House) -> Counter[str]:
    """How many pieces of each kind a house has."""
    return Counter(piece.type for room in house.rooms for piece in room.pieces)


def codes(house: House, shape: Geometry, kinds: Sequence[str]) -> list[int]:
    """What a ray says of each piece of a house that it hits, ``PIECE``, or ``NAMED`` and its kind's place;
    then of each of its blocks.
    """
    at = {kind: NAMED + place for place, kind in enumerate(kinds)}
    pieces = [at.get(piece.type, PIECE) for room in house.rooms for piece in room.pieces]
    return pieces + [WALL] * len(shape.blocks)


def check_kinds(houses: Sequence[House], kinds: Sequence[str]) -> None:
    """Raise ``ValueError`` where no house has any of these kinds of pieces. Some may be absent: an agent that
    tells more kinds than a bank has plays in it all the same.
    """
    known = sorted({kind for house in houses for kind in pieces_in(house)})
    if kinds and not set(kinds) & set(known):
        raise ValueError(f"kinds: {unknown('piece', kinds[0], known)}")
