"""Generation of houses in the process of the tests, since a solver process takes longer to start.

It is for tests of rules, by ``generate`` or the fixture ``solved_here``. Tests of processes, limits and
messages use ``vitruvius.generate``.
"""

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.proofs.moved_plan import moved_plan
from vitruvius.logic.request.arguments import house_request
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers import pool
from vitruvius.logic.workers.messages import Moved, MovePlan, Open

_shipped, _own = lru_cache(maxsize=4)(Builder), lru_cache(maxsize=1)(Builder)


def builder(grammar: str | Path, cell: float = 0.0) -> Builder:
    """Return the builder of a grammar, for use until another one is asked for.

    SWI-Prolog holds one grammar at a time. Shipped grammars keep the programs that they have ground.
    """
    rules = find(grammar)
    made = (_shipped if rules.directory.parent == SHIPPED else _own)(rules, cell)
    made.begin()
    return made


def generate(
    rooms: int | None = None, *, seed: int = 0, count: int = 1, start: int = 0, **asked: Any
) -> Iterator[House]:
    """Yield the houses of ``vitruvius.generate`` for these arguments."""
    request = house_request(rooms, **asked)
    for made in outcomes(request, seed, range(start, start + count)):
        if isinstance(made, LimitReached):
            raise made
        yield made


def outcomes(
    request: HouseRequest, seed: int, indices: range, workers: int = 1
) -> Iterator[House | LimitReached]:
    """Yield the outcomes of ``pool.outcomes``, without warnings about rules without effect."""
    said = set[str]()
    for index in indices:
        made = builder(request.rules.directory, request.cell)
        try:
            house = house_or_proof(made, request.at(index), seed, index)
        except LimitReached as limit:
            yield limit
            continue
        pool._say_what_gave_way(request, house, said)
        yield house


def moved(opening: Open, question: MovePlan, *_: Any) -> Iterator[Moved]:
    """Yield the answer of a solver process about a plan that has no house."""
    yield Moved(moved_plan(builder(opening.grammar), question.request, question.seed))
