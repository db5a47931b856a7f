"""Grammars that a house keeps at their limits: they allow no sizes and areas beyond those of its rooms."""

import re
import shutil
from collections import defaultdict
from math import ceil, floor
from pathlib import Path

from benchmarks.briefs.boxes import around
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House

PER_METRE = 1e6
"""Steps of a stated length per metre, and of a stated area per square metre."""


def tightened(builder: Builder, house: House, folder: Path) -> Path:
    """Return a copy of a grammar in a new folder, with the sizes and areas of a house as its bounds.

    The grammar must state the size of each type in a line of its own.
    """
    shutil.copytree(builder.grammar.directory, folder)
    oblong = {fact.arguments[0].name for fact in builder.programs.rooms(1).facts("oblong", 1)}
    sides = defaultdict[str, list[tuple[float, float]]](list)
    for room in house.rooms:
        side = (room.width, room.height)
        sides[room.type].append((min(side), max(side)) if room.type in oblong else side)
    stated = re.compile(rf"(house_size|room_(size|area)\(({'|'.join(sides)})\b)")
    for file in folder.glob("*.pl"):
        lines = file.read_text().splitlines(keepends=True)
        file.write_text("".join(line for line in lines if not stated.match(line)))
    west, north, east, south = around(room.box for room in house.rooms)
    rules = [f"house_size(W, D) :- {_between('W', [east - west])}, {_between('D', [south - north])}."]
    for type_, some in sides.items():
        widths, depths = zip(*some, strict=True)
        rules.append(f"room_size({type_}, W, D) :- {_between('W', widths)}, {_between('D', depths)}.")
    for type_, some in sides.items():
        least, most = _ends([width * depth for width, depth in some])
        rules.append(f"room_area({type_}, {least}, {most}).")
    (folder / "tightened.pl").write_text("\n".join(rules) + "\n")
    return folder


def _between(name: str, lengths: list[float] | tuple[float, ...]) -> str:
    least, most = _ends(lengths)
    return f"{{ {name} >= {least}, {name} =< {most} }}"


def _ends(values: list[float] | tuple[float, ...]) -> tuple[float, float]:
    return floor(min(values) * PER_METRE) / PER_METRE, ceil(max(values) * PER_METRE) / PER_METRE
