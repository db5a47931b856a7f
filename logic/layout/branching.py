"""How a search of stage 1 branches: on the picks in a sampled order, house after house in one search."""

import math
from collections.abc import Iterable

import clingo
import numpy as np

AGAIN = 4
"""Searches that are left to the solver after one that is led."""


class Brancher(clingo.Propagator):
    """Makes the solver branch on the picks in a given order, each to be taken where it still can be.

    One search finds a model for each order. All that is decided for a model is decided under a switch, a
    literal without a meaning: once that is false, the solver takes all of it back, and begins at the root
    under the next switch. Nogoods are clauses of one search, which end with it: as rules of the program they
    would stay behind.
    """

    def __init__(self, picks: np.ndarray, patience: int | None = None) -> None:
        """Know the pick literals of a program. With ``patience`` the solver is left to itself after so many
        decisions: then what it finds depends on all that it has solved before. It is led again at each
        ``AGAIN``-th search, for what is refuted has many neighbours that are refuted too.
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
        """From the next model on find the first one outside the nogoods by the picks in this order.

        ``then``: where in the order to go on after each pick that is taken. Nogoods need a search that begins
        with them.
        """
        self._order, self._nogoods = order, nogoods
        self._left = self._patience if self._searches % AGAIN == 0 or self._patience == math.inf else 0
        self._searches += 1
        self._then = [1, *(place + 1 for place in then)]
        self.waiting = True
        """Whether no model is found in this order yet, nor looked for."""

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
        """A layout is found; or that of the last order still stands, and is to be left."""
        if self.waiting:
            left = self._switch
            self._begin(control.add_literal())
            if control.add_clause([-left], tag=True):
                control.propagate()
            return
        while self._clauses:
            # Locked: else clasp may delete them, as if it had learnt them.
            if not control.add_clause(self._clauses.pop(), tag=True, lock=True) or not control.propagate():
                return

    def decide(self, thread_id: int, assignment: clingo.Assignment, fallback: int) -> int:
        """The next pick that is neither taken nor refused."""
        self._left -= 1
        if self._left < 0:
            return fallback
        queue, then, scanned, level = self._queue, self._then, self._scanned, assignment.decision_level
        scanned.extend([0] * (level + 1 - len(scanned)))
        # What was decided when this level began, and so up to its place in the queue, still is.
        place = scanned[level]
        while place < len(queue) and (taken := assignment.value(queue[place])) is not None:
            place = then[place] if taken else place + 1
        found = place < len(queue)
        del scanned[level + 1 :]
        scanned.append(then[place] if found else place)
        return queue[place] if found else fallback
