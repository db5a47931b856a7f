"""Palettes: which colours and patterns a drawing has. ``palettes.json``."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Literal, get_args

import msgspec

from logic.errors import RequestError
from logic.house import House
from logic.looks import INK, Looks, looks_of
from logic.spelling import unknown

Name = Literal["colour", "distinct", "grey"]
"""``colour``: each type has its own, always the same. ``distinct``: colours that the colour-blind tell apart.
``grey``: for print. In the last two, types of one drawing differ in colour or pattern, all of them.
"""


class Inks(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Colours of all but floors, ``#rrggbb``."""

    ink: str = INK
    """Words."""
    paper: str = "#fbfaf6"
    """The main room of a star."""
    wall: str = "#333a45"
    faint: str = "#8b929d"
    """Symbols, swings of doors."""
    edge: str = "#626a76"
    """Of furniture."""
    wood: str = "#ffffff"
    """Furniture."""
    mark: str = "#c8552d"
    """Entrances, and fronts that no symbol shows."""
    pattern: str = "#8b929d"


class Palette(Inks, frozen=True, forbid_unknown_fields=True):
    """Inks, and floors where each type has no colour of its own: first all colours without a pattern."""

    floors: tuple[str, ...] = ()
    hatches: tuple[str, ...] = ("",)


class Fill(msgspec.Struct, frozen=True):
    """How a floor is filled: its colour, and its pattern, a character of ``Palette.hatches``."""

    colour: str
    hatch: str = ""


PALETTES = msgspec.json.decode(
    Path(__file__).with_name("palettes.json").read_bytes(), type=dict[str, Palette]
)


@dataclass(frozen=True)
class Style:
    """How a drawing looks."""

    inks: Inks
    looks: Looks
    fills: dict[str, Fill]
    """Of room types; one that is not here has the colour of its looks."""

    def fill(self, kind: str) -> Fill:
        """How the floor of a room type is filled."""
        return self.fills.get(kind) or Fill(self.looks.colour(kind))


def style(houses: Iterable[House], palette: Name = "colour", grammar: str | Path | None = None) -> Style:
    """The style of a drawing of these houses, with the looks of their grammars, or of a grammar's folder.

    Raises ``RequestError`` for a palette that there is not, ``GrammarError`` for looks that are wrong.
    """
    if palette not in PALETTES:
        raise RequestError(unknown("palette", palette, get_args(Name)))
    houses = list(houses)
    ones = {house.provenance.grammar if house.provenance else "": house for house in houses}
    looks = reduce(or_, (looks_of(house, grammar) for house in ones.values()))
    chosen, fills = PALETTES[palette], {}
    if chosen.floors:
        known = {kind: number for number, kind in enumerate(looks.rooms)}
        types = {room.type for house in houses for room in house.counted}
        for number, kind in enumerate(sorted(types, key=lambda kind: (known.get(kind, len(known)), kind))):
            row, column = divmod(number, len(chosen.floors))
            fills[kind] = Fill(chosen.floors[column], chosen.hatches[row % len(chosen.hatches)])
    return Style(chosen, looks, fills)
