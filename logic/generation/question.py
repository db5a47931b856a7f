"""Questions to both stages: whether there is a layout under some statements that stage 2 does not refute."""

import math
from collections.abc import Callable, Collection, Sequence

from clingo import Symbol

from logic.layout.program import Conflict
from logic.layout.relaxed import Relaxed, Statement

Refutation = Callable[[Sequence[Symbol], Collection[Symbol]], Conflict | None]
"""The conflict of a layout in stage 2, some clauses left out; None if it has none."""


class Question:
    """Asked of one relaxed program; what stage 2 refutes is learnt, so that a core is one of both stages."""

    def __init__(self, relaxed: Relaxed, refuted: Refutation | None = None) -> None:
        """Know the program, and how stage 2 refutes its layouts, if it has any part in them."""
        self.relaxed, self.refuted = relaxed, refuted

    def layout(self, some: Sequence[Statement], most: float = math.inf) -> list[Symbol] | None:
        """A layout under these statements; None where there is none.

        Raises ``TooMany`` if stage 2 refutes so many, or clingo searches for too long (``Relaxed.model``).
        """
        refuted = self.refuted
        if refuted is None:
            return self.relaxed.model(some, most=most)
        stated = {each.literals for each in some}
        clauses = [each for each in self.relaxed.statements if each.clause]
        without = {each.clause for each in clauses if each.clause and each.literals not in stated}
        return self.relaxed.model(some, lambda layout: refuted(layout, without), most)

    def possible(self, some: Sequence[Statement], most: float = math.inf) -> bool:
        """Whether these have a layout; raises as ``layout``."""
        return self.layout(some, most) is not None

    def core(self, some: Sequence[Statement]) -> list[Statement]:
        """Some of these, which have no layout, that have none by themselves."""
        return self.relaxed.core(some)
