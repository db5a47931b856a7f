"""Difference constraints in stage 1: the theory of clingo-dl, if the rules state any.

``&diff { a - b } <= c`` in ``differences.lp`` states what lengths forbid while the walls are still being
chosen (clingo-dl: Janhunen, Kaminski, Ostrowski, Schaub, Schellhorn and Wanko, TPLP 17, 2017). Stage 2 has
these constraints too, with others that are no differences. The theory saves time and excludes nothing that
fits.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from weakref import finalize

from clingo import Control, Symbol
from clingo.ast import AST, ProgramBuilder, parse_files

from vitruvius.logic.grammar import ADJACENT, BRIEF, GUARD, RULES, Places
from vitruvius.logic.layout.reading import load, parse

DIFFERENCES, ROOM = RULES / "shared_walls" / "differences.lp", "room"
"""File that states differences, and the part of the rules that has none: furniture."""

STATING = DIFFERENCES, ADJACENT, GUARD, BRIEF
"""All files that state differences."""

FURNITURE = RULES / "room"
"""Rules of furniture, which programs with differences omit, since they are about the rooms of a house."""

_spent = list[object]()
"""Theories whose controls are freed, or about to be. They are freed with the next program."""


class Differences:
    """Difference theory of a program, which must live as long; none without ``DIFFERENCES`` in its rules."""

    def __init__(
        self,
        control: Control,
        files: Sequence[Path],
        parts: Iterable[tuple[str, Sequence[Symbol]]],
        remark: Callable[[str], None],
        left_out: Places = frozenset(),
    ) -> None:
        """Register the theory with a control, unless ``parts`` are of furniture, which has no differences.

        ``load`` reads ``self.files`` without the typical rules at ``left_out``, and passes messages of clingo
        to ``remark``.
        """
        self._control, self._remark, self._left_out = control, remark, left_out
        furniture = any(name == ROOM for name, _ in parts)
        self.files = [file for file in files if not (furniture and _of_topology(file))]
        self._theory = None
        if DIFFERENCES in self.files:
            from clingodl import ClingoDLTheory

            self._theory = ClingoDLTheory()
            if BRIEF in self.files:  # Its areas are many differences between few lines.
                self._theory.configure("propagate", "full")
            self._theory.register(control)
            # A freed control calls its theory. In a reference cycle the collector might free the theory
            # first.
            _spent.clear()
            finalize(control, _spent.append, self._theory)

    def load(self) -> None:
        """Load the files."""
        if self._theory is None:
            load(self._control, self.files, lambda _, text: self._remark(text), self._left_out)
            return
        shared = tuple(file for file in self.files if RULES in file.parents)
        with ProgramBuilder(self._control) as builder:
            for statement in core_statements(shared):
                builder.add(statement)
            parse(
                [file for file in self.files if file not in shared],
                lambda statement: self.add(statement, builder),
                lambda _, text: self._remark(text),
                self._left_out,
            )

    def add(self, statement: AST, builder: ProgramBuilder) -> None:
        """Add a statement, which may state a difference."""
        if self._theory is None:
            builder.add(statement)
        else:
            self._theory.rewrite_ast(statement, builder.add)

    def prepare(self) -> None:
        """Prepare the differences of the ground program."""
        if self._theory is not None:
            self._theory.prepare(self._control)


def _of_topology(file: Path) -> bool:
    """Return True if a file belongs to a topology, which furniture does not need."""
    return RULES in file.parents and file.parent != RULES


@cache
def core_statements(files: tuple[Path, ...]) -> list[AST]:
    """Return the statements of these core files about a house's rooms, ready to be added.

    They are cached, because a process makes a dozen programs of the same files.
    """
    from clingodl import ClingoDLTheory

    found: list[AST] = []
    theory = ClingoDLTheory()

    def take(statement: AST) -> None:
        if FURNITURE not in Path(statement.location.begin.filename).parents:
            theory.rewrite_ast(statement, found.append)

    parse_files([str(file) for file in files], take)
    return found
