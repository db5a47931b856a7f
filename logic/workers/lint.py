"""Search for mistakes in a grammar's files that the solvers ignore."""

import time
from pathlib import Path

from vitruvius.logic.errors import Finding, GrammarError
from vitruvius.logic.grammar import find
from vitruvius.logic.workers.messages import Judged, Lint, Loaded, Open
from vitruvius.logic.workers.solver import Solver

TRIED = (10, 20)
"""Numbers of rooms for which lint tries each rule to find the slow one, if judging the rules is too slow."""


def lint(grammar: str | Path = "family", seconds: float = 60.0) -> list[Finding]:
    """Return the mistakes in a grammar's files that the solvers ignore, without running the grammar.

    ``generate`` refuses a grammar with an error. Raises ``GrammarError`` if there is no such grammar, and
    ``LimitReached`` after ``seconds``.
    """
    opening = Open(grammar=str(find(grammar).directory), errors=True)
    end = time.monotonic() + seconds
    worker = Solver(opening)
    try:
        answer = worker.loaded(seconds)
        if isinstance(answer, Loaded):
            left = end - time.monotonic()
            worker.ask(Lint(), left)
            answer = worker.answer(Judged, left, f"{grammar}: lint took {seconds:g} s", TRIED)
        return answer.findings
    except GrammarError as error:
        return [Finding("error", str(error.file), error.line or 1, error.column or 1, error.message)]
    finally:
        worker.end()
