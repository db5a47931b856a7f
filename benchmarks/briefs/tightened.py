"""Grammars that a house keeps at their limits: the sizes and areas of its rooms are all that they allow."""

import re
import shutil
from collections import defaultdict
from math import ceil, floor
from pathlib import Path

from benchmarks.briefs.boxes import around
from logic.generation.builder import Builder
from logic.house.house import House

ROUNDED = 1e6
"""So many parts of a metre, or of a square metre, are told apart."""


def tightened(builder: Builder, house: House, folder: Path) -> Path:
    """Return a copy of a grammar with the least and the greatest of a house, by type of room, and its size.

    The folder is not there yet, and the size of each type stands in a line of its own.
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
    return floor(min(values) * ROUNDED) / ROUNDED, ceil(max(values) * ROUNDED) / ROUNDED
