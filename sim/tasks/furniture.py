"""Tasks that depend on furniture: targets beside furniture of a kind, and targets by each house's habits.

The houses' own data have all kinds of rooms and furniture.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol, runtime_checkable

import msgspec

from vitruvius.logic import House
from vitruvius.logic.spelling import unknown
from vitruvius.sim.backends.piece_kinds import pieces_in
from vitruvius.sim.geometry import Box
from vitruvius.sim.tasks.base import BaseTask

BESIDE = 0.75
"""Largest distance in metres from furniture to the outer edge of a target beside it; the default target is
0.538 m wide."""


@runtime_checkable
class WeightedTask(Protocol):
    """A task whose targets are drawn from regions of a house with different probabilities."""

    ends_on_pick_up: ClassVar[bool]
    """True if the first pick-up terminates the episode."""

    def regions(self, house: House) -> Sequence[tuple[Sequence[Box], float]]:
        """Return regions, each some rectangles with the probability that the next target is drawn from them.

        A target lies completely in one rectangle of its region, and all places of a region are equally
        probable. Regions may overlap; the probabilities of their common places then add up. A region where no
        target fits is left out, and the others keep their proportions.
        """
        ...


def beside(house: House, kind: str, margin: float = BESIDE) -> list[Box]:
    """Return the rectangles around each piece of a kind, ``margin`` metres wide, within the piece's room."""
    boxes = []
    for room in house.rooms:
        west, north, east, south = room.box
        for piece in room.pieces:
            if piece.type == kind:
                x, y, end_x, end_y = piece.box
                boxes.append((
                    max(west, x - margin), max(north, y - margin),
                    min(east, end_x + margin), min(south, end_y + margin),
                ))  # fmt: skip
    return boxes


@dataclass(frozen=True)
class Object(BaseTask):
    """Task to find furniture of a kind: a target is beside it, and its pick-up ends the episode."""

    piece: str
    ends_on_pick_up: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Raise ``TypeError`` unless ``piece`` is a string."""
        if not isinstance(self.piece, str):
            raise TypeError(f"piece: give a furniture type, not {self.piece!r}")
        super().__post_init__()

    def suits(self, house: House) -> bool:
        """Return True if a house has such a piece."""
        return self.piece in pieces_in(house)

    def check(self, houses: Sequence[House]) -> None:
        """Raise ``ValueError`` if a house has no such piece."""
        lacking = [index for index, house in enumerate(houses) if not self.suits(house)]
        if len(lacking) == len(houses):
            known = sorted({kind for house in houses for kind in pieces_in(house)})
            raise ValueError(f"targets: {unknown('piece', self.piece, known)}")
        if lacking:
            raise ValueError(
                f"house {lacking[0]} of {len(houses)} has no {self.piece}: use the "
                f"{len(houses) - len(lacking)} houses that have one"
            )

    def spaces(self, house: House) -> list[Box]:
        """Return the rectangles around each such piece: see ``Task``."""
        return beside(house, self.piece)


@dataclass(frozen=True)
class Habit(BaseTask):
    """Task to pick up as many targets as possible, which lie where the house's habits put them.

    A house's regions are the rooms of each type, and the floor beside the furniture of each kind. Their order
    is a function of the house's rooms and ``seed`` only. The first region is the favourite and has the
    fraction ``share`` of the targets; each following region has that fraction of the rest.
    """

    share: float = 0.65
    seed: int = 0
    ends_on_pick_up: ClassVar[bool] = False

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for an invalid share."""
        super().__post_init__()
        if not 0 < self.share <= 1:
            raise ValueError(f"share must be above 0 and at most 1, not {self.share}")

    def order(self, house: House) -> list[tuple[str, str]]:
        """Return the regions, the favourite first: ("room", type) and ("piece", kind)."""
        shape = msgspec.json.encode(house.rooms)
        names = {("room", room.type) for room in house.rooms}
        names |= {("piece", kind) for kind in pieces_in(house)}

        def number(name: tuple[str, str]) -> bytes:
            return hashlib.sha256(repr((self.seed, *name)).encode() + shape).digest()

        return sorted(names, key=number)

    def regions(self, house: House) -> list[tuple[list[Box], float]]:
        """Return the regions and their probabilities: see ``WeightedTask``."""
        found = []
        for rank, (what, name) in enumerate(self.order(house)):
            rooms = [room.box for room in house.rooms if room.type == name]
            boxes = rooms if what == "room" else beside(house, name)
            found.append((boxes, self.share * (1 - self.share) ** rank))
        return [(boxes, weight) for boxes, weight in found if weight > 0]
