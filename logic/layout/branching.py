"""Branching in searches of stage 1: on the picks in a sampled order, house after house in one search."""

import math
from collections.abc import Iterable

import clingo
import numpy as np

FREE_SEARCHES = 4
"""Number of searches that are left to the solver after one in the given order."""


class Brancher(clingo.Propagator):
    """Propagator that makes the solver branch on the picks in a given order, each set to true if possible.

    One search finds a model for each order. All decisions for a model are under a switch, a literal without a
    meaning. Once the switch is false, the solver retracts the decisions and begins at the root under the next
    switch. Nogoods are clauses of one search, which end with it. As rules of the program they would remain.
    """

    def __init__(self, picks: np.ndarray, patience: int | None = None) -> None:
        """Set the pick literals of a program.

        With ``patience`` the solver chooses its own branches after this number of decisions. The result then
        depends on everything that the solver has solved before. At each ``FREE_SEARCHES``-th search it
        branches in the given order again, because refuted layouts have many neighbours that are refuted, too.
        """
        self._picks: list[int] = picks.tolist()
        self._patience = self._left = math.inf if patience is None else patience
        self._searches = 0
        self._solver_literals: list[int] = []
        self._first_switch = 0
        self.branch()
        self._searches = 0
        self._begin(self._first_switch)

    def branch(
        self, order: Iterable[int] = (), then: Iterable[int] = (), nogoods: Iterable[list[int]] = ()
    ) -> None:
        """Order the picks for the next model, which is the first one outside the nogoods in this order.

        ``then``: index in the order at which to continue after each pick that becomes true. Nogoods must be
        set before a search begins.
        """
        self._order, self._nogoods = order, nogoods
        self._left = (
            self._patience if self._searches % FREE_SEARCHES == 0 or self._patience == math.inf else 0
        )
        self._searches += 1
        self._then = [1, *(place + 1 for place in then)]
        self.waiting = True
        """True if the search for a model in this order has not begun."""

    def init(self, init: clingo.PropagateInit) -> None:
        """Begin a search."""
        if not self._solver_literals:
            self._solver_literals = [init.solver_literal(pick) for pick in self._picks]
            for literal in self._solver_literals:
                init.freeze_literal(literal)
            self._first_switch = init.add_literal()
        self._clauses = [[-init.solver_literal(literal) for literal in nogood] for nogood in self._nogoods]
        self._begin(self._first_switch)

    def _begin(self, switch: int) -> None:
        """Begin at the root."""
        self.waiting, self._switch, self._scanned = False, switch, [0]
        self._queue = [switch, *(self._solver_literals[place] for place in self._order)]

    def check(self, control: clingo.PropagateControl) -> None:
        """Keep a new layout if it has no nogood, or leave the layout of the last order."""
        if self.waiting:
            left = self._switch
            self._begin(control.add_literal())
            if control.add_clause([-left], tag=True):
                control.propagate()
            return
        while self._clauses:
            # Locked, because clasp would otherwise delete them like learnt clauses.
            if not control.add_clause(self._clauses.pop(), tag=True, lock=True) or not control.propagate():
                return

    def decide(self, thread_id: int, assignment: clingo.Assignment, fallback: int) -> int:
        """Return the next pick that is still undecided, or the solver's own choice."""
        self._left -= 1
        if self._left < 0:
            return fallback
        queue, then, scanned, level = self._queue, self._then, self._scanned, assignment.decision_level
        scanned.extend([0] * (level + 1 - len(scanned)))
        # Decisions from before this level, up to its place in the queue, still hold.
        place = scanned[level]
        while place < len(queue) and (taken := assignment.value(queue[place])) is not None:
            place = then[place] if taken else place + 1
        found = place < len(queue)
        del scanned[level + 1 :]
        scanned.append(then[place] if found else place)
        return queue[place] if found else fallback
