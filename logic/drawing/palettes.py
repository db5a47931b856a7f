"""Palettes: the colours and patterns of a drawing, from ``palettes.json``."""

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

from vitruvius.logic.errors import RequestError
from vitruvius.logic.house.house import House
from vitruvius.logic.looks.looks import INK, Looks, looks_of
from vitruvius.logic.spelling import unknown

Name = Literal["colour", "distinct", "grey"]
"""``colour``: each type has its own colour. ``distinct``: colours that the colour-blind tell apart.

``grey``: for print. In the last two, all types of one drawing differ in colour or pattern.
"""


MIN_COLOUR_DIFFERENCE = 10.0
"""Least difference between a new type's colour and all others, if possible: see ``difference``."""


class Inks(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Colours of everything except floors, ``#rrggbb``."""

    ink: str = INK
    """Colour of words."""
    paper: str = "#fbfaf6"
    """Colour of a star's main room."""
    wall: str = "#333a45"
    faint: str = "#8b929d"
    """Colour of symbols and of swings of doors."""
    edge: str = "#626a76"
    """Colour of the edges of furniture."""
    wood: str = "#ffffff"
    """Colour of furniture."""
    mark: str = "#c8552d"
    """Colour of entrances, and of fronts that no symbol shows."""
    pattern: str = "#8b929d"


class Palette(Inks, frozen=True, forbid_unknown_fields=True):
    """Inks, and floors for palettes in which types have no colour of their own.

    All colours come first without a pattern.
    """

    floors: tuple[str, ...] = ()
    new: tuple[str, ...] = ()
    """Colours of types without a colour in their looks, most distinct first. Used without ``floors``."""
    hatches: tuple[str, ...] = ("",)


class Fill(msgspec.Struct, frozen=True):
    """Filling of a floor: a colour, and a pattern, which is a character of ``Palette.hatches``."""

    colour: str
    hatch: str = ""


PALETTES = msgspec.json.decode(
    Path(__file__).with_name("palettes.json").read_bytes(), type=dict[str, Palette]
)


@dataclass(frozen=True)
class Style:
    """Style of a drawing."""

    inks: Inks
    looks: Looks
    fills: dict[str, Fill]
    """Fillings for the room types of the houses."""

    def fill(self, kind: str) -> Fill:
        """Return the filling for the floor of a room type."""
        return self.fills[kind]


def style(houses: Iterable[House], palette: Name = "colour", grammar: str | Path | None = None) -> Style:
    """Return the style of a drawing of these houses, with the looks of their grammars or of a given one.

    Raises ``RequestError`` for an unknown palette, and ``GrammarError`` for wrong looks.
    """
    if palette not in PALETTES:
        raise RequestError(unknown("palette", palette, get_args(Name)))
    houses = list(houses)
    ones = {house.provenance.grammar if house.provenance else "": house for house in houses}
    looks = reduce(or_, (looks_of(house, grammar) for house in ones.values()))
    chosen, types = PALETTES[palette], {house.whole(room).type for house in houses for room in house.counted}
    return Style(chosen, looks, _patterned(chosen, types, looks) or _coloured(chosen, types, looks))


def _patterned(palette: Palette, types: Iterable[str], looks: Looks) -> dict[str, Fill]:
    """Return fillings that give each type the next colour and, after all colours, the next pattern."""
    known = {kind: number for number, kind in enumerate(looks.rooms)}
    fills = {}
    for number, kind in enumerate(sorted(types, key=lambda kind: (known.get(kind, len(known)), kind))):
        if palette.floors:
            row, column = divmod(number, len(palette.floors))
            fills[kind] = Fill(palette.floors[column], palette.hatches[row % len(palette.hatches)])
    return fills


def _coloured(palette: Palette, types: Iterable[str], looks: Looks) -> dict[str, Fill]:
    """Return fillings with the colour of each type's looks.

    A type without looks has the first colour that differs from all others here. The search starts at a place
    in the palette that the type's name determines, so that the same name mostly has the same colour.
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
                key=lambda one: min([MIN_COLOUR_DIFFERENCE, *(difference(one, other) for other in taken)]),
            )
    return {kind: Fill(colour) for kind, colour in chosen.items()}


def difference(one: str, other: str) -> float:
    """Return the perceived difference of two colours by CIE 1976, 0 to about 100; 2.3 is just visible."""
    return math.dist(_lab(one), _lab(other))


def _lab(colour: str) -> tuple[float, float, float]:
    """Return the CIE L*a*b* values of an sRGB colour, for daylight (D65)."""
    values = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (((v + 0.055) / 1.055) ** 2.4 if v > 0.04045 else v / 12.92 for v in values)
    xyz = (
        (0.4124 * red + 0.3576 * green + 0.1805 * blue) / 0.9505,
        0.2126 * red + 0.7152 * green + 0.0722 * blue,
        (0.0193 * red + 0.1192 * green + 0.9505 * blue) / 1.089,
    )
    x, y, z = (math.cbrt(v) if v > (6 / 29) ** 3 else v * 841 / 108 + 4 / 29 for v in xyz)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)
