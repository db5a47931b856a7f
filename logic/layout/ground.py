"""Results of grounding: the number of ground rules, and the literals of atoms."""

from collections import Counter
from collections.abc import Sequence

import clingo
from clingo import Symbol


class Endless(Exception):
    """There are more ground rules than permitted, perhaps infinitely many."""


class Instances(clingo.Observer):
    """Observer that counts ground rules, in total and by the literals that they depend on."""

    def __init__(self, most: int | None = None) -> None:
        """Set the largest number of ground rules, if any, after which ``rule`` raises ``Endless``."""
        self._most = most
        self.number = 0
        self.of: Counter[int] = Counter()

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Count a ground rule."""
        for literal in body:  # There are very many: Counter.update takes four times as long.
            self.of[literal] += 1
        self.number += 1
        if self._most is not None and self.number > self._most:
            raise Endless


class Literals:
    """Literals of the atoms that may hold in a ground program, looked up on demand."""

    def __init__(self, atoms: clingo.SymbolicAtoms) -> None:
        """Set the atoms of a ground program, which must live as long."""
        # The control itself would outlive its theory if kept alive here, and crash.
        self._atoms = atoms
        self._known: dict[Symbol, int | None] = {}

    def get(self, atom: Symbol) -> int | None:
        """Return the literal of an atom, or None if the atom can never hold."""
        if atom not in self._known:
            found = self._atoms[atom]
            self._known[atom] = found.literal if found else None
        return self._known[atom]

    def __getitem__(self, atom: Symbol) -> int:
        """Return the literal of an atom that may hold. Raises ``KeyError`` for others."""
        literal = self.get(atom)
        if literal is None:
            raise KeyError(atom)
        return literal

    def __contains__(self, atom: Symbol) -> bool:
        """Return True if an atom may hold."""
        return self.get(atom) is not None
