"""Questions to both stages about a layout under some statements that stage 2 does not refute."""

import math
from collections.abc import Callable, Collection, Sequence

from clingo import Symbol

from vitruvius.logic.layout.program import Conflict
from vitruvius.logic.layout.relaxed import Relaxed, Statement

Refutation = Callable[[Sequence[Symbol], Collection[Symbol]], Conflict | None]
"""Function that returns the conflict of a layout in stage 2 without some clauses, or None."""


class Question:
    """Question about one relaxed program, which learns each conflict of stage 2.

    A core covers both stages.
    """

    def __init__(self, relaxed: Relaxed, refuted: Refutation | None = None) -> None:
        """Set the program, and the function by which stage 2 refutes its layouts, if any."""
        self.relaxed, self.refuted = relaxed, refuted

    def layout(self, some: Sequence[Statement], most: float = math.inf) -> list[Symbol] | None:
        """Return a layout under these statements, or None if there is none.

        Raises ``TooMany`` if stage 2 refutes ``most`` layouts, or clingo searches for too long
        (``Relaxed.model``).
        """
        refuted = self.refuted
        if refuted is None:
            return self.relaxed.model(some, most=most)
        stated = {each.literals for each in some}
        clauses = [each for each in self.relaxed.statements if each.clause]
        without = {each.clause for each in clauses if each.clause and each.literals not in stated}
        return self.relaxed.model(some, lambda layout: refuted(layout, without), most)

    def possible(self, some: Sequence[Statement], most: float = math.inf) -> bool:
        """Return True if these statements have a layout. Raises as ``layout`` does."""
        return self.layout(some, most) is not None

    def core(self, some: Sequence[Statement]) -> list[Statement]:
        """Return a core: those of these statements, which have no layout, that suffice for a conflict."""
        return self.relaxed.core(some)
