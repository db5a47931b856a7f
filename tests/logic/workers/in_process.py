"""Generation of houses in the process of the tests, since a solver process takes longer to start.

It is for tests of rules. Tests of processes, limits and messages use ``vitruvius.generate``.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import Grammar, find
from vitruvius.logic.house.house import House
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest


def generate(
    rooms: int,
    *,
    grammar: str | Path = "family",
    cell: float = 0.0,
    seed: int = 0,
    count: int = 1,
    **counts: Any,
) -> Iterator[House]:
    """Yield the houses of ``vitruvius.generate`` for these arguments."""
    request = HouseRequest.read({"rooms": rooms, "types": {}, "furniture": {}, "cell": cell} | counts)
    rules = find(grammar)
    for index in range(count):
        yield house_or_proof(_builder(rules, cell), request, seed, index)


@lru_cache(maxsize=1)  # SWI-Prolog holds one grammar at a time
def _builder(grammar: Grammar, cell: float) -> Builder:
    Programs.rooms.cache_clear()
    return Builder(grammar, cell)
