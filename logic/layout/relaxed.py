# clingo.ast leaves the attributes of its nodes untyped.
# pyright: reportAttributeAccessIssue=false, reportOptionalMemberAccess=false, reportArgumentType=false
"""Ground programs with retractable statements, to find a minimal core of the user's statements and choices.

Every rule and fact of the grammar's files has one more condition (``conditional.py``), which is assumed.
Without the assumption the statement may hold or not. This keeps all houses and adds some, so that leaving
more out never makes a house impossible. Therefore "without this one there is a house" is meaningful. The
lengths of the ``.pl`` files enter in the same way, in both stages. Without its clause a length may be
anything between zero and a very large value.
"""

import contextlib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from time import monotonic
from typing import Any

import clingo
from clingo import Symbol, ast
from clingo.backend import HeuristicType
from msgspec import structs

from vitruvius.logic.errors import Reason
from vitruvius.logic.layout.conditional import (
    ABSENT,
    HERE,
    LEFT_OUT,
    Source,
    atom_of,
    free,
    literal,
    stated,
    stated_symbol,
    unbound,
)
from vitruvius.logic.layout.differences import Differences
from vitruvius.logic.layout.ground import Endless, Instances, Literals
from vitruvius.logic.layout.program import CORE, Conflict, Part, TooMany


@dataclass(frozen=True)
class Statement:
    """Statement that may be left out: the text for the user, and the literals that stand for it."""

    reason: Reason
    literals: tuple[int, ...]
    clause: Symbol | None = None
    """Clause of a ``.pl`` file: see ``Conflict``."""


FORGET_ALL = 15
"""Value of clasp's option ``forget_on_step`` for scores, signs, nogoods and lemmas."""

CONFLICTS = 100
"""Number of conflicts of clingo per layout that may be refuted, if these are limited."""


class Late(Exception):
    """The time for an attempt is over."""


Refutation = Callable[[Sequence[Symbol]], Conflict | None]
"""Function that returns the conflict of a layout in stage 2, or None."""


class Relaxed:
    """Ground program in which each statement of the user can be left out."""

    def __init__(
        self,
        source: Source,
        constants: dict[str, Any],
        parts: Iterable[Part],
        lengths: Iterable[tuple[Symbol, Mapping[Symbol, Reason]]] = (),
        laws: bool = False,
        most: int | None = None,
    ) -> None:
        """Ground these parts of the core and of the source's files.

        ``lengths`` are facts for stage 1, with the clauses that each comes from and the places of these. With
        ``laws`` the requirements of the core can be left out, too. With ``most`` ground rules are counted,
        which takes time, and the rules after that number are left out. These are then only rules of the
        files, without wider bounds or additions.
        """
        self._control = clingo.Control(
            [f"-c{name}={value}" for name, value in constants.items()], logger=lambda *_: None
        )
        self._instances = Instances(most)
        if most:
            self._control.register_observer(self._instances)
        parts = tuple(parts)
        self._differences = Differences(self._control, source.files, parts, lambda _: None)
        if not laws:
            self._control.load(str(CORE))
        if not most:
            self._control.load(str(LEFT_OUT))
        rules, reasons, first = source.conditional(self._differences.files, laws)
        found: list[tuple[Reason, Symbol | None]] = [(reason, None) for reason in reasons]
        with ast.ProgramBuilder(self._control) as builder:
            for rule in rules:
                self._differences.add(rule, builder)
            builder.add(ast.Program(HERE, "base", []))
            numbers: dict[Symbol, int] = {}
            for fact, clauses in lengths:
                for clause, reason in clauses.items():
                    if clause not in numbers:
                        numbers[clause] = len(found)
                        found.append((reason, clause))
                conditions = [stated(numbers[clause]) for clause in clauses]
                builder.add(ast.Rule(HERE, literal(atom_of(fact)), [literal(atom) for atom in conditions]))
                # Without its clause a length has no bounds, and any other fact does not hold.
                for atom in conditions if unbound(fact) != fact else ():
                    missing = literal(atom, ast.Sign.Negation)
                    builder.add(ast.Rule(HERE, literal(atom_of(unbound(fact))), [missing]))
            for number in range(len(found)):
                builder.add(free(number))
        with contextlib.suppress(Endless):
            self._control.ground([("base", []), *parts, ("pick", [])])
        self._differences.prepare()
        self._control.configuration.solve.enum_mode = "user"
        self._literal_of = Literals(self._control.symbolic_atoms)
        self._given: list[int] = []
        self._failing: set[int] = set()
        self.until = math.inf
        """Time, of ``time.monotonic``, at which searches for layouts end."""
        self.statements = [
            Statement(reason, (self._literal_of[stated_symbol(number)],), clause)
            for number, (reason, clause) in enumerate(found)
            if stated_symbol(number) in self._literal_of
        ]
        for atom in self._control.symbolic_atoms.by_signature("added'", 1):
            (fact,) = atom.symbol.arguments
            place = first.get(str(fact).partition(",")[0]) or first.get(fact.name, Reason(""))
            self.statements.append(
                Statement(structs.replace(place, text=f"{fact}{ABSENT}"), (-atom.literal,))
            )
        self._known = {literal for each in self.statements for literal in each.literals}

    def choice(self, reason: Reason, holds: Iterable[Symbol] = (), fails: Iterable[Symbol] = ()) -> Statement:
        """Return the choice of a request that some atoms hold, and others do not."""
        literals = [self._literal_of[atom] for atom in holds]
        literals += [-self._literal_of[atom] for atom in fails if atom in self._literal_of]
        return Statement(reason, tuple(literals))

    def give(self, holds: Iterable[Symbol], fails: Iterable[Symbol]) -> None:
        """Assume, in all searches, that these atoms hold and the others do not."""
        self._given += self.choice(Reason(""), holds, fails).literals

    def proved(self, reason: Reason, nogoods: Iterable[Mapping[Symbol, bool]]) -> Statement:
        """Return a result of another proof as a statement: no layout has all atoms of a nogood."""
        with self._control.backend() as backend:
            stated = backend.add_atom()
            backend.add_rule([stated], choice=True)
            for nogood in nogoods:
                atoms = [
                    self._literal_of[atom] if holds else -self._literal_of[atom]
                    for atom, holds in nogood.items()
                    if holds or atom in self._literal_of
                ]
                backend.add_rule([], [stated, *atoms])
        return Statement(reason, (stated,))

    @property
    def instances(self) -> int:
        """Number of ground rules, if they are counted."""
        return self._instances.number

    def binds(self, statement: Statement) -> bool:
        """Return True if a statement has any ground instance, if these are counted."""
        return any(self._instances.of[literal] for literal in statement.literals)

    def largest(self) -> Statement:
        """Return the statement with the most ground instances, if these are counted."""
        return max(self.statements, key=lambda statement: self._instances.of[statement.literals[0]])

    def model(
        self,
        statements: Iterable[Statement],
        refuted: Refutation = lambda _: None,
        most: float = math.inf,
        conflicts: int | None = None,
    ) -> list[Symbol] | None:
        """Return the shown atoms of a layout under these statements that is not ``refuted``, or None.

        Refuted layouts remain excluded. Raises ``Late``, and ``TooMany`` after ``most`` refuted layouts or
        after ``conflicts`` of clingo. The default is ``CONFLICTS`` for each of the ``most`` layouts.
        """
        if monotonic() > self.until:
            raise Late
        excluded: list[list[int]] = []
        if conflicts is None and most != math.inf:
            conflicts = CONFLICTS * int(most)
        self._search(models=0, conflicts=conflicts)
        try:
            # The search continues after refuted layouts, since starting another takes longer than all the
            # rest.
            with self._control.solve(assumptions=self._assumed(statements), yield_=True) as handle:
                for model in handle:
                    layout = sorted(model.symbols(shown=True))
                    conflict = refuted(layout)
                    if conflict is None:
                        self._failing = {each for each in self._known if not model.is_true(each)}
                        return layout
                    excluded.append(self._literals_of(conflict))
                    model.context.add_clause([-literal for literal in excluded[-1]])
                    if monotonic() > self.until:
                        raise Late
                    if len(excluded) >= most:
                        raise TooMany
                if not handle.get().exhausted:
                    raise TooMany
            return None
        finally:
            self._exclude(excluded)

    def forget(self) -> None:
        """Forget after each search what it learnt, since a hard search would mislead later ones."""
        self._control.configuration.solver.forget_on_step = FORGET_ALL

    def left_out(self, statements: Iterable[Statement]) -> list[Statement]:
        """Return the known statements that do not hold in the last layout."""
        return [each for each in statements if not self._failing.isdisjoint(each.literals)]

    def prefer(self, statements: Iterable[Statement]) -> None:
        """Register these statements, and search for layouts in which as many of them as possible hold."""
        self._control.configuration.solver.heuristic = "Domain"
        self._known.update(literal for each in statements for literal in each.literals)
        with self._control.backend() as backend:
            for each in sorted(self._known):
                kind = HeuristicType.True_ if each > 0 else HeuristicType.False_
                backend.add_heuristic(abs(each), kind, 1, 1, [])

    def prefer_none(self) -> None:
        """Search for any layout again, since a layout in which little holds is found many times sooner."""
        self._control.configuration.solver.heuristic = "Vsids"

    def core(self, statements: Sequence[Statement]) -> list[Statement]:
        """Return a core: those of these statements, which have no layout, that suffice for a conflict."""
        core: set[int] = set()
        self._search(models=1, conflicts=None)
        self._control.solve(assumptions=self._assumed(statements), on_core=core.update)
        return [statement for statement in statements if core.intersection(statement.literals)]

    def _search(self, models: int, conflicts: int | None) -> None:
        """Limit the next search to this number of layouts (0 for all) and, if given, of conflicts."""
        solve = self._control.configuration.solve
        solve.models, solve.solve_limit = models, f"{conflicts or 'umax'},umax"

    def _assumed(self, statements: Iterable[Statement]) -> list[int]:
        return self._given + [literal for statement in statements for literal in statement.literals]

    def at_most(self, number: int, choices: Iterable[Statement]) -> Statement:
        """Return the statement that at most this number of choices, each of one atom that holds, change."""
        with self._control.backend() as backend:
            more = backend.add_atom()
            others = [(-literal, 1) for choice in choices for literal in choice.literals]
            backend.add_weight_rule([more], number + 1, others)
        return Statement(Reason(f"at most {number} other changes"), (-more,))

    def exclude(self, conflict: Conflict) -> None:
        """Exclude all layouts with this conflict, as long as its clauses are stated."""
        self._exclude([self._literals_of(conflict)])

    def _literals_of(self, conflict: Conflict) -> list[int]:
        clauses = [
            statement.literals[0] for statement in self.statements if statement.clause in conflict.clauses
        ]
        return clauses + [
            self._literal_of[atom] if holds else -self._literal_of[atom]
            for atom, holds in conflict.atoms.items()
            if atom in self._literal_of
        ]

    def _exclude(self, conflicts: Sequence[list[int]]) -> None:
        if not conflicts:
            return  # Opening a backend takes longer than a search.
        with self._control.backend() as backend:
            for literals in conflicts:
                backend.add_rule([], literals)
