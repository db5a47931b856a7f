"""Generation of houses in the process of the tests, since a solver process takes longer to start.

It is for tests of rules. Tests of processes, limits and messages use ``vitruvius.generate``.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.layout.programs import Programs
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.arguments import house_request


def generate(
    rooms: int | None = None, *, seed: int = 0, count: int = 1, start: int = 0, **asked: Any
) -> Iterator[House]:
    """Yield the houses of ``vitruvius.generate`` for these arguments, without its warnings."""
    request = house_request(rooms, **asked)
    for index in range(start, start + count):
        yield house_or_proof(_builder(request.rules, request.cell), request.at(index), seed, index)


@lru_cache(maxsize=1)  # SWI-Prolog holds one grammar at a time
def _builder(grammar: Grammar, cell: float) -> Builder:
    Programs.rooms.cache_clear()
    return Builder(grammar, cell)
