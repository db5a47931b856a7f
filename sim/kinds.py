"""Kinds of pieces that an observation tells apart: what a ray that ends on a piece says of it."""

from collections.abc import Sequence

from logic import House
from logic.spelling import unknown
from sim.backend import NAMED, PIECE
from sim.furniture_tasks import pieces_in


def codes(house: House, kinds: Sequence[str]) -> list[int]:
    """What a ray that hits it says of each piece of a house: ``PIECE``, or ``NAMED`` and its kind's place."""
    at = {kind: NAMED + place for place, kind in enumerate(kinds)}
    return [at.get(piece.type, PIECE) for room in house.rooms for piece in room.pieces]


def check_kinds(houses: Sequence[House], kinds: Sequence[str]) -> None:
    """Raise ``ValueError`` for a kind of piece that no house has."""
    known = sorted({kind for house in houses for kind in pieces_in(house)})
    for kind in kinds:
        if kind not in known:
            raise ValueError(f"kinds: {unknown('piece', kind, known)}")
