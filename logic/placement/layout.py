"""Input of stage 2: the rooms of a layout from stage 1."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from clingo import Symbol

from vitruvius.logic.placement.prolog import Term
from vitruvius.logic.request.fixed_rooms import FixedRoom


@dataclass(frozen=True)
class RoomLayout:
    """Room of a layout: its number, type and side, the atoms that furnish it, and the seed of its lengths.

    ``given`` is its known size and doors: see ``rules/room/given_rooms.pl``.
    """

    number: int
    type: Symbol
    side: Symbol
    furniture: Sequence[Symbol]
    seed: int = 0
    fixed: FixedRoom | None = None
    given: Term | str = "any"


@dataclass(frozen=True)
class Layout:
    """Result of stage 1: the rooms, clockwise, and for each corner the side that may stand out past it."""

    rooms: Sequence[RoomLayout]
    corners: Sequence[Symbol]

    @classmethod
    def unfurnished(cls, atoms: Iterable[Symbol], fixed: Sequence[FixedRoom]) -> "Layout":
        """Return the layout of these atoms without furniture: types, sides, and the ``fixed`` rooms."""
        named = defaultdict[str, list[Symbol]](list)
        for atom in atoms:
            named[atom.name].append(atom)
        types, sides = (
            {atom.arguments[0].number: atom.arguments[1] for atom in named[name]} for name in ("room", "side")
        )
        numbered = {atom.arguments[1].number: fixed[atom.arguments[0].number] for atom in named["numbered"]}
        rooms = [
            RoomLayout(number, type_, sides[number], (), fixed=numbered.get(number))
            for number, type_ in sorted(types.items())
        ]
        return cls(rooms, named["corner"])
