"""What grounding makes of rules: how many ground rules, and which literals its atoms have."""

from collections import Counter
from collections.abc import Sequence

import clingo
from clingo import Symbol


class Endless(Exception):
    """There are more ground rules than were asked for, perhaps without end."""


class Instances(clingo.Observer):
    """Counts ground rules, and by the literals that they depend on."""

    def __init__(self, most: int | None = None) -> None:
        """End the grounding by ``Endless`` past this number of ground rules, if any."""
        self._most = most
        self.number = 0
        self.of: Counter[int] = Counter()

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """A ground rule."""
        for literal in body:  # There are very many: Counter.update takes four times as long.
            self.of[literal] += 1
        self.number += 1
        if self._most is not None and self.number > self._most:
            raise Endless


class Literals:
    """The literals of the atoms that may hold in a ground program, of which few are ever asked for."""

    def __init__(self, atoms: clingo.SymbolicAtoms) -> None:
        """Look them up among the atoms of a ground program, which must live as long."""
        # Not the control itself: kept alive here, it would outlive its theory and crash.
        self._atoms = atoms
        self._known: dict[Symbol, int | None] = {}

    def get(self, atom: Symbol) -> int | None:
        """The literal of an atom; None where it can never hold."""
        if atom not in self._known:
            found = self._atoms[atom]
            self._known[atom] = found.literal if found else None
        return self._known[atom]

    def __getitem__(self, atom: Symbol) -> int:
        """The literal of an atom that may hold; ``KeyError`` for others."""
        literal = self.get(atom)
        if literal is None:
            raise KeyError(atom)
        return literal

    def __contains__(self, atom: Symbol) -> bool:
        """Whether an atom may hold."""
        return self.get(atom) is not None
