"""Smallest sets of statements that are impossible together (smallest MUS), for proofs as short as possible.

The statements that fail in a layout are a correction set: each conflict contains one of them. If the fewest
statements that hit all correction sets found so far have no layout, they are a smallest conflict. If they
have a layout, it yields another correction set (Ignatiev, Previti, Liffiton and Marques-Silva, CP 2015).
"""

import contextlib
import math
from collections.abc import Collection, Iterable, Sequence
from functools import partial

import clingo

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.question import Question
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.layout.conflicts import minimal
from vitruvius.logic.layout.program import TooMany
from vitruvius.logic.layout.relaxed import Relaxed, Statement

MOST_LAYOUTS = 400
"""Largest number of layouts in the search for a smallest conflict, after which a minimal one suffices."""

MOST_CONFLICTS = 10_000
"""Largest number of clingo's conflicts for one layout, after which a minimal conflict suffices, too."""

MOST_NAMED = 20
"""Largest number of statements of a given plan that a proof lists; more become one statement."""

MOST_REFUTED = 60
"""Largest number of layouts refuted in stage 2 to test if a statement can go; past it the statement stays."""


def least(question: "Question | AnyOf", statements: Sequence[Statement]) -> list[Statement]:
    """Return statements that are impossible together, and possible or undecided with any one left out.

    A test is undecided after ``MOST_REFUTED`` layouts. If stage 2 has no part in the question, the statements
    are as few as possible.
    """
    if isinstance(question, Question) and question.refuted is None:
        with contextlib.suppress(TooMany):
            if (found := fewest(statements, question.relaxed)) is not None:
                return found
        question.relaxed.prefer_none()

    return minimal(statements, partial(_may_be_possible, question), question.core)


def least_of_plan(
    question: Question, statements: Sequence[Statement], own: Collection[Reason]
) -> list[Statement]:
    """Return the result of ``least``. More than ``MOST_NAMED`` of a plan's ``own`` statements become one."""

    def of_plan(some: Sequence[Statement]) -> list[Statement]:
        return [each for each in some if each.reason in own]

    core = question.core(statements)
    if len(of_plan(core)) <= MOST_NAMED:
        return least(question, statements)
    # If a few of them are impossible, whole parts of them can be left out.
    for parts in (2, 4, 8):
        for part in range(parts):
            mine = of_plan(core)
            out = mine[len(mine) * part // parts : len(mine) * (part + 1) // parts]
            fewer = [each for each in core if each not in out]
            if not _may_be_possible(question, fewer):
                core = question.core(fewer)
    mine = of_plan(core)
    if len(mine) <= MOST_NAMED:
        return least(question, [each for each in statements if each in mine or each.reason not in own])
    together = Reason(f"{mine[0].reason}, and {len(mine) - 1} more that it says of its rooms")
    whole = Statement(together, tuple(literal for each in mine for literal in each.literals))
    others = [each for each in core if each not in mine]
    return minimal([whole, *others], partial(_may_be_possible, question), question.core)


def least_of_brief(
    question: Question, statements: Sequence[Statement], own: Collection[Reason]
) -> list[Statement]:
    """Return the result of ``least`` for a brief alone, whose rules are those of any plan.

    The result first has as few of the brief's ``own`` lines as possible while all rules hold, then as few
    rules. Therefore without any one of the lines the others have a house.
    """
    rules = [each for each in statements if each.reason not in own]
    lines = [each for each in statements if each.reason in own]

    def possible(kept: Sequence[Statement], some: Sequence[Statement]) -> bool:
        return _may_be_possible(question, [*kept, *some])

    def core(kept: Sequence[Statement], some: Sequence[Statement]) -> list[Statement]:
        found = {id(each) for each in question.core([*kept, *some])}
        return [each for each in some if id(each) in found]

    lines = minimal(lines, partial(possible, rules), partial(core, rules))
    return [*minimal(rules, partial(possible, lines), partial(core, lines)), *lines]


def _may_be_possible(question: "Question | AnyOf", some: Sequence[Statement]) -> bool:
    """Return True if there is a layout, or if a layout is neither found nor refuted soon."""
    try:
        return question.possible(some, MOST_REFUTED)
    except TooMany:
        return True


def fewest(statements: Sequence[Statement], relaxed: Relaxed) -> list[Statement] | None:
    """Return a smallest set of statements that are impossible together, with the fewest shipped rules.

    Returns None if it is not found with ``MOST_LAYOUTS``. Raises ``TooMany`` after ``MOST_CONFLICTS``.
    """
    relaxed.prefer(statements)
    hitting = Hitting([str(SHIPPED) in (each.reason.file or "") for each in statements])
    places = {id(each): place for place, each in enumerate(statements)}
    layouts = 0
    while layouts < MOST_LAYOUTS:
        some = smallest = [statements[place] for place in hitting.set()]
        # Correction sets that share no statement show best how many statements are needed.
        while relaxed.model(some, conflicts=MOST_CONFLICTS) is not None:
            layouts += 1
            left_out = relaxed.left_out(statements)
            hitting.add(places[id(each)] for each in left_out)
            some = [*some, *left_out]
        if some is smallest:
            return smallest
    return None


class Hitting:
    """Smallest hitting set: the fewest indices that include one of each added set."""

    def __init__(self, dear: Sequence[bool]) -> None:
        """Set the number of indices.

        Among equally small sets the one with the fewest ``dear`` indices is best.

        Further ties go to the first indices.
        """
        self._control = clingo.Control(["--opt-strategy=usc"])
        with self._control.backend() as backend:
            self._atoms = [backend.add_atom() for _ in dear]
            backend.add_rule(self._atoms, choice=True)
            backend.add_minimize(2, [(atom, 1) for atom in self._atoms])
            backend.add_minimize(1, [(self._atoms[place], 1) for place, each in enumerate(dear) if each])
            backend.add_minimize(0, [(atom, place) for place, atom in enumerate(self._atoms)])

    def add(self, some: Iterable[int]) -> None:
        """Require one of these indices in the set."""
        with self._control.backend() as backend:
            backend.add_rule([], [-self._atoms[place] for place in some])

    def set(self) -> list[int]:
        """Return the best set."""
        best: list[int] = []
        with self._control.solve(yield_=True) as handle:
            for model in handle:
                best = [place for place, atom in enumerate(self._atoms) if model.is_true(atom)]
        return best


class AnyOf:
    """Question with several alternatives, which has a layout if one of them has.

    All have the same statements.
    """

    def __init__(self, questions: Sequence[Question], statements: Sequence[Sequence[Statement]]) -> None:
        """Set the questions, and the statements of each. Methods take the statements of the first."""
        self._questions, self._statements = questions, statements
        self._places = {id(each): place for place, each in enumerate(statements[0])}

    def _of(self, number: int, some: Sequence[Statement]) -> list[Statement]:
        return [self._statements[number][self._places[id(each)]] for each in some]

    def possible(self, some: Sequence[Statement], most: float = math.inf) -> bool:
        """Return True if these statements have a layout. Raises as ``Question.layout`` does."""
        asked = enumerate(self._questions)
        return any(question.possible(self._of(number, some), most) for number, question in asked)

    def core(self, some: Sequence[Statement]) -> list[Statement]:
        """Return a core: those of these statements, which have no layout, that suffice for a conflict."""
        found = set[int]()
        for number, question in enumerate(self._questions):
            core = {id(each) for each in question.core(self._of(number, some))}
            found |= {place for place, each in enumerate(self._statements[number]) if id(each) in core}
        return [each for each in some if self._places[id(each)] in found]
