"""A smallest set of statements that are impossible together, so that a proof is as short as there is one.

What does not hold in a layout is a correction set: each conflict has one of its statements. So the fewest
statements that hit all correction sets found so far are a smallest conflict, if they have no layout; and if
they have one, it leaves another correction set (Ignatiev, Previti, Liffiton and Marques-Silva, CP 2015).
"""

import contextlib
import math
from collections.abc import Collection, Iterable, Sequence
from functools import partial

import clingo

from logic.errors import Reason
from logic.generation.question import Question
from logic.grammar import SHIPPED
from logic.layout.conflicts import minimal
from logic.layout.program import TooMany
from logic.layout.relaxed import Relaxed, Statement

MOST_LAYOUTS = 400
"""So many layouts are looked at for a smallest conflict; past them a minimal one has to do."""

MOST_CONFLICTS = 10_000
"""So many conflicts may clingo meet for one of these layouts; past them a minimal conflict has to do, too."""

MOST_NAMED = 20
"""So many statements of a given plan are named in a proof; more are one."""

MOST_REFUTED = 60
"""So many layouts are refuted in stage 2 to see whether a statement can be left out; past them it stays."""


def least(question: "Question | AnyOf", statements: Sequence[Statement]) -> list[Statement]:
    """Statements that are impossible together, and possible with any one left out, or not known to be
    impossible after ``MOST_REFUTED``: as few as can be, where stage 2 has no part in it.
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
    """As ``least``; more than ``MOST_NAMED`` of a plan's ``own`` statements become one."""

    def of_plan(some: Sequence[Statement]) -> list[Statement]:
        return [each for each in some if each.reason in own]

    core = question.core(statements)
    if len(of_plan(core)) <= MOST_NAMED:
        return least(question, statements)
    # Where a few of them are impossible, parts of them can be left out whole.
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
    """As ``least`` for a brief alone, whose rules are those of any plan: first of its ``own`` lines, while
    all rules hold, then of the rules. So without any one of the lines the others have a house.
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
    """Whether there is a layout, or it is not soon known that there is none."""
    try:
        return question.possible(some, MOST_REFUTED)
    except TooMany:
        return True


def fewest(statements: Sequence[Statement], relaxed: Relaxed) -> list[Statement] | None:
    """A smallest set of statements that are impossible together; of these one with the fewest shipped rules.

    None where it is not found with ``MOST_LAYOUTS``; raises ``TooMany`` past ``MOST_CONFLICTS``.
    """
    relaxed.prefer(statements)
    hitting = Hitting([str(SHIPPED) in (each.reason.file or "") for each in statements])
    places = {id(each): place for place, each in enumerate(statements)}
    layouts = 0
    while layouts < MOST_LAYOUTS:
        some = smallest = [statements[place] for place in hitting.set()]
        # Correction sets that share no statement say the most about how many are needed.
        while relaxed.model(some, conflicts=MOST_CONFLICTS) is not None:
            layouts += 1
            left_out = relaxed.left_out(statements)
            hitting.add(places[id(each)] for each in left_out)
            some = [*some, *left_out]
        if some is smallest:
            return smallest
    return None


class Hitting:
    """A smallest set of things, by their places, that has one of each set that was added."""

    def __init__(self, dear: Sequence[bool]) -> None:
        """Choose among as many things: where several sets would do, with the fewest ``dear`` ones, the first
        ones.
        """
        self._control = clingo.Control(["--opt-strategy=usc"])
        with self._control.backend() as backend:
            self._atoms = [backend.add_atom() for _ in dear]
            backend.add_rule(self._atoms, choice=True)
            backend.add_minimize(2, [(atom, 1) for atom in self._atoms])
            backend.add_minimize(1, [(self._atoms[place], 1) for place, each in enumerate(dear) if each])
            backend.add_minimize(0, [(atom, place) for place, atom in enumerate(self._atoms)])

    def add(self, some: Iterable[int]) -> None:
        """One of these is to be in the set."""
        with self._control.backend() as backend:
            backend.add_rule([], [-self._atoms[place] for place in some])

    def set(self) -> list[int]:
        """The cheapest set."""
        best: list[int] = []
        with self._control.solve(yield_=True) as handle:
            for model in handle:
                best = [place for place, atom in enumerate(self._atoms) if model.is_true(atom)]
        return best


class AnyOf:
    """Whether there is a layout in any of several questions, of which each has the same statements."""

    def __init__(self, questions: Sequence[Question], statements: Sequence[Sequence[Statement]]) -> None:
        """Know the questions, and the statements of each; asked with those of the first."""
        self._questions, self._statements = questions, statements
        self._places = {id(each): place for place, each in enumerate(statements[0])}

    def _of(self, number: int, some: Sequence[Statement]) -> list[Statement]:
        return [self._statements[number][self._places[id(each)]] for each in some]

    def possible(self, some: Sequence[Statement], most: float = math.inf) -> bool:
        """Whether these have a layout; raises as ``Question.layout``."""
        asked = enumerate(self._questions)
        return any(question.possible(self._of(number, some), most) for number, question in asked)

    def core(self, some: Sequence[Statement]) -> list[Statement]:
        """Some of these, which have no layout, that have none by themselves."""
        found = set[int]()
        for number, question in enumerate(self._questions):
            core = {id(each) for each in question.core(self._of(number, some))}
            found |= {place for place, each in enumerate(self._statements[number]) if id(each) in core}
        return [each for each in some if self._places[id(each)] in found]
