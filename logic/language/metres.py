"""Lengths that are probably not in metres: a grammar in centimetres gives a main room of 284 m by 546 m."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from clingo import Function, Symbol

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.house.parts import MAX_COORDINATE_M

MIN_LENGTH_M = 0.01
"""Length in metres below which another unit is likely, unless the length is 0."""

LONGEST_LENGTH, LONGEST_SIDE, LONGEST_PIECE = 5.0, 120.0, 20.0
"""Lengths in metres above which another unit is likely: a named length, a side of a room, and a piece."""


Origins = Callable[[Iterable[Symbol]], Mapping[Symbol, tuple[str, int]]]


def impossible(lengths: Mapping[str, Any], origins: Origins) -> Iterator[GrammarError]:
    """Yield an error at the origin of each clause with a length that no house can have."""
    found = {}
    for clause, metres, _ in _sizes(lengths):
        if max(metres) > MAX_COORDINATE_M:
            text = f"{clause.arguments[-1]}: {max(metres):g} m, more than the {MAX_COORDINATE_M:g} m "
            text += f"of a house. Lengths are in metres: {max(metres):g} mm are {max(metres) / 1000:g}"
            found[origins([clause])[clause]] = text
    for (file, line), text in found.items():
        yield GrammarError(text, file, line, 1)


def unlikely(lengths: Mapping[str, Any], origins: Origins) -> Iterator[GrammarError]:
    """Yield a warning at the origin of each clause with an unlikely length, from ``stated_lengths``."""
    found = {}
    for clause, metres, longest in _sizes(lengths):
        wrong = next((m for m in metres if m > longest or 0 < m < MIN_LENGTH_M), None)
        if wrong is not None:
            place, name = origins([clause])[clause], clause.arguments[-1]
            meant = f"{wrong:g} cm are {wrong / 100:g}" if wrong > longest else "1 cm is 0.01"
            found[place] = f"{name}: {wrong:g} m. Lengths are in metres: {meant}"
    for (file, line), text in found.items():
        yield GrammarError(text, file, line, 1)


def _sizes(lengths: Mapping[str, Any]) -> Iterator[tuple[Symbol, Sequence[float], float]]:
    """Yield the clauses with their least and greatest lengths, and the longest likely length."""
    for name, metres in lengths["lengths"].items():
        yield Function("length", [Function(name)]), [metres], LONGEST_LENGTH
    for type_, room in lengths["rooms"].items():
        yield Function("size", [Function(type_)]), room, LONGEST_SIDE
        if max(room) <= LONGEST_SIDE:  # A piece may be as long as its wall.
            for piece, size in lengths["pieces"][type_].items():
                yield Function("size", [Function(type_), Function(piece)]), size, LONGEST_PIECE
