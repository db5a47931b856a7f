"""Palettes: which colours and patterns a drawing has. ``palettes.json``."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Literal, get_args

import msgspec

from logic.errors import RequestError
from logic.house.house import House
from logic.house.looks import INK, Looks, looks_of
from logic.spelling import unknown

Name = Literal["colour", "distinct", "grey"]
"""``colour``: each type has its own. ``distinct``: colours that the colour-blind tell apart.
``grey``: for print. In the last two, types of one drawing differ in colour or pattern, all of them.
"""


APART = 10.0
"""How much a new type's colour differs from all others where it can: see ``difference``."""


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
    new: tuple[str, ...] = ()
    """Without ``floors``: of types that have no colour in their looks, first those that differ most."""
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
    """Of the room types that the houses have."""

    def fill(self, kind: str) -> Fill:
        """How the floor of a room type is filled."""
        return self.fills[kind]


def style(houses: Iterable[House], palette: Name = "colour", grammar: str | Path | None = None) -> Style:
    """The style of a drawing of these houses, with the looks of their grammars, or of a grammar's folder.

    Raises ``RequestError`` for a palette that there is not, ``GrammarError`` for looks that are wrong.
    """
    if palette not in PALETTES:
        raise RequestError(unknown("palette", palette, get_args(Name)))
    houses = list(houses)
    ones = {house.provenance.grammar if house.provenance else "": house for house in houses}
    looks = reduce(or_, (looks_of(house, grammar) for house in ones.values()))
    chosen, types = PALETTES[palette], {house.whole(room).type for house in houses for room in house.counted}
    return Style(chosen, looks, _patterned(chosen, types, looks) or _coloured(chosen, types, looks))


def _patterned(palette: Palette, types: Iterable[str], looks: Looks) -> dict[str, Fill]:
    """Each type in the next colour, and when all were taken in the next pattern."""
    known = {kind: number for number, kind in enumerate(looks.rooms)}
    fills = {}
    for number, kind in enumerate(sorted(types, key=lambda kind: (known.get(kind, len(known)), kind))):
        if palette.floors:
            row, column = divmod(number, len(palette.floors))
            fills[kind] = Fill(palette.floors[column], palette.hatches[row % len(palette.hatches)])
    return fills


def _coloured(palette: Palette, types: Iterable[str], looks: Looks) -> dict[str, Fill]:
    """Each type in the colour of its looks. Without one it is the first that differs from all others here,
    from a place in the palette that its name gives: mostly the same for the same name.
    """
    types = sorted(types)
    chosen = {kind: looks.rooms[kind] for kind in types if kind in looks.rooms}
    for kind in types:
        if kind not in chosen:
            turn = zlib.crc32(kind.encode()) % len(palette.new)  # not hash(), which differs by process
            order = palette.new[turn:] + palette.new[:turn]
            taken = chosen.values()
            chosen[kind] = max(
                order,
                key=lambda one: min([APART, *(difference(one, other) for other in taken)]),
            )
    return {kind: Fill(colour) for kind, colour in chosen.items()}


def difference(one: str, other: str) -> float:
    """How much two colours differ as people see them: CIE 1976, of 0 to about 100; 2.3 is just noticed."""
    return math.dist(_lab(one), _lab(other))


def _lab(colour: str) -> tuple[float, float, float]:
    """CIE L*a*b* of an sRGB colour, in the light of day (D65)."""
    values = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (((v + 0.055) / 1.055) ** 2.4 if v > 0.04045 else v / 12.92 for v in values)
    xyz = (
        (0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.9505,
        0.2126 * red + 0.7152 * green + 0.0722 * blue,
        (0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.089,
    )
    x, y, z = (math.cbrt(v) if v > (6 / 29) ** 3 else v * 841 / 108 + 4 / 29 for v in xyz)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)
