# clingo.ast leaves the attributes of its nodes untyped.
# pyright: reportAttributeAccessIssue=false, reportOptionalMemberAccess=false, reportArgumentType=false
"""Why there is no house: a minimal set of the user's own statements and choices in conflict.

Every rule and fact of the grammar's files has one more condition (``conditional.py``), which is assumed.
Without the assumption the statement may hold or not: that leaves all the houses there were and adds some, so
leaving more out never makes a house impossible, and "take one away and there is a house" means something. The
lengths of the ``.pl`` files enter in the same way, in both stages: without its clause a length is anything
from nothing to very much.
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

from logic.errors import Reason
from logic.layout.conditional import (
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
from logic.layout.differences import Differences
from logic.layout.ground import Endless, Instances, Literals
from logic.layout.program import CORE, Conflict, Part, TooMany


@dataclass(frozen=True)
class Statement:
    """One thing that may be left out: what the user reads, and the literals that stand for it."""

    reason: Reason
    literals: tuple[int, ...]
    clause: Symbol | None = None
    """Of a ``.pl`` file: see ``Conflict``."""


EVERYTHING = 15
"""What clasp's option ``forget_on_step`` can say: scores, signs, nogoods and lemmas."""

CONFLICTS = 100
"""How many conflicts clingo may meet for each layout that may be refuted, where these are limited."""


class Late(Exception):
    """The time to try something is over."""


Refutation = Callable[[Sequence[Symbol]], Conflict | None]
"""Why a layout is impossible in stage 2, if it is."""


class Relaxed:
    """A ground program in which each statement of the user's can be left out."""

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

        ``lengths`` are facts for stage 1, with the clauses that each comes from and where these stand.
        With ``laws`` what the core requires can be left out too. With ``most`` ground rules are counted,
        which takes its time, and those past them are left out: of the files alone, nothing wider or added.
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
                # Without a clause a length has no bounds; what is no length does not hold.
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
        """When no more layouts are looked for, by ``time.monotonic``."""
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
        """A choice of the request's: that some atoms hold, and others do not."""
        literals = [self._literal_of[atom] for atom in holds]
        literals += [-self._literal_of[atom] for atom in fails if atom in self._literal_of]
        return Statement(reason, tuple(literals))

    def give(self, holds: Iterable[Symbol], fails: Iterable[Symbol]) -> None:
        """That these atoms hold, and the others do not, is never left out."""
        self._given += self.choice(Reason(""), holds, fails).literals

    def proved(self, reason: Reason, nogoods: Iterable[Mapping[Symbol, bool]]) -> Statement:
        """What is proved elsewhere, as a statement: no layout has all atoms of a nogood."""
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
        """How many ground rules there are, where these are counted."""
        return self._instances.number

    def binds(self, statement: Statement) -> bool:
        """Whether a statement has any ground instance, where these are counted."""
        return any(self._instances.of[literal] for literal in statement.literals)

    def largest(self) -> Statement:
        """The statement with the most ground instances, where these are counted."""
        return max(self.statements, key=lambda statement: self._instances.of[statement.literals[0]])

    def model(
        self,
        statements: Iterable[Statement],
        refuted: Refutation = lambda _: None,
        most: float = math.inf,
        conflicts: int | None = None,
    ) -> list[Symbol] | None:
        """The shown atoms of a layout under these statements that is not ``refuted``; None if there is none.

        What is refuted is excluded from then on. Raises ``Late``, and ``TooMany`` past so many refuted
        layouts or ``conflicts`` of clingo's own, ``CONFLICTS`` for each of these unless it is said.
        """
        if monotonic() > self.until:
            raise Late
        excluded: list[list[int]] = []
        if conflicts is None and most != math.inf:
            conflicts = CONFLICTS * int(most)
        self._search(models=0, conflicts=conflicts)
        try:
            # One search goes on past what is refuted: to begin another takes longer than all the rest.
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
        """Forget after each search what it learnt: a hard one would lead those after it astray."""
        self._control.configuration.solver.forget_on_step = EVERYTHING

    def left_out(self, statements: Iterable[Statement]) -> list[Statement]:
        """Those of the known statements that do not hold in the layout that was found last."""
        return [each for each in statements if not self._failing.isdisjoint(each.literals)]

    def prefer(self, statements: Iterable[Statement]) -> None:
        """Know these statements, and look for layouts in which as many as possible of them hold."""
        self._control.configuration.solver.heuristic = "Domain"
        self._known.update(literal for each in statements for literal in each.literals)
        with self._control.backend() as backend:
            for each in sorted(self._known):
                kind = HeuristicType.True_ if each > 0 else HeuristicType.False_
                backend.add_heuristic(abs(each), kind, 1, 1, [])

    def prefer_none(self) -> None:
        """Look for any layout again: one in which little holds is found many times sooner."""
        self._control.configuration.solver.heuristic = "Vsids"

    def core(self, statements: Sequence[Statement]) -> list[Statement]:
        """Some of these statements, which have no layout, that have none by themselves."""
        core: set[int] = set()
        self._search(models=1, conflicts=None)
        self._control.solve(assumptions=self._assumed(statements), on_core=core.update)
        return [statement for statement in statements if core.intersection(statement.literals)]

    def _search(self, models: int, conflicts: int | None) -> None:
        """Look for so many layouts, all with 0, before so many conflicts, if these are limited."""
        solve = self._control.configuration.solve
        solve.models, solve.solve_limit = models, f"{conflicts or 'umax'},umax"

    def _assumed(self, statements: Iterable[Statement]) -> list[int]:
        return self._given + [literal for statement in statements for literal in statement.literals]

    def at_most(self, number: int, choices: Iterable[Statement]) -> Statement:
        """That at most this number of choices, each of one atom that holds, are otherwise."""
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
            return  # To open a backend takes longer than a search.
        with self._control.backend() as backend:
            for literals in conflicts:
                backend.add_rule([], literals)
