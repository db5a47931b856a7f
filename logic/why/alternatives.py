"""Alternatives in a house: other values of a choice with all others fixed, or reasons against them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from time import monotonic
from typing import Any

from clingo import Function, Symbol

from vitruvius.logic.errors import Reason
from vitruvius.logic.generation.question import Question
from vitruvius.logic.layout.conflicts import minimal, preferred
from vitruvius.logic.layout.relaxed import Late, Statement
from vitruvius.logic.why.answer import Alternative, Choice

OTHERS = "other choices"
"""Name for other choices that the search did not find in time."""


@dataclass(frozen=True)
class Chosen:
    """Choices of a layout: what each variable picks (one value or several), and what it may pick."""

    picks: Mapping[Symbol, Sequence[Symbol]]
    options: Mapping[Symbol, Sequence[Symbol]]


Tried = tuple[Choice | None, int]
"""Finding about a choice, if any, and the number of other values that it covers."""


class Search:
    """Search for other values of the choices that made a layout."""

    def __init__(
        self,
        question: Question,
        statements: Sequence[Statement],
        chosen: Chosen,
        layout: Iterable[Symbol],
        most: int | None = None,
    ) -> None:
        """Set the question about these statements, and the choices that made this layout.

        With ``most`` choices depend on each other as those of a plan do. Conflicts then have few rules and
        many choices, and the result names at most ``most`` other choices that would have to change, too.
        """
        self._most = most
        self._relaxed, self._statements, self._possible = question.relaxed, statements, question.possible
        self._chosen, self._layout = chosen, set(layout)
        self._kept = {
            (variable, value): self._relaxed.choice(Reason(f"{variable} = {value}"), [_pick(variable, value)])
            for variable, values in chosen.picks.items()
            for value in values
        }

    def others(self, variables: Iterable[Symbol]) -> int:
        """Return the number of other values of these variables."""
        return sum(len(self._chosen.options[each]) - 1 for each in variables)

    def choices(self, variables: Iterable[Symbol], until: float) -> Iterator[Tried]:
        """Yield these variables, each of which picks one value, with their other values as they are found.

        For each variable the possible values come first, then the others one by one. Values that give the
        same layout are left out, and so are variables without other values. The search for reasons against
        values shares the time until ``until``, of ``time.monotonic``.
        """
        asked = list(variables)
        left = self.others(asked)
        for variable in asked:
            (value,) = self._chosen.picks[variable]
            others = [each for each in self._chosen.options[variable] if each != value]
            wanted = [(str(other), _pick(variable, other)) for other in others]
            yield from self._instead(str(variable), str(value), variable, wanted, until, left)
            left -= len(others)

    def of_atom(self, atom: Symbol, others: Iterable[Symbol], until: float) -> Iterator[Tried]:
        """Yield an atom that holds by several picks, and others that could replace it.

        The last term differs.
        """
        *subject, value = atom.arguments
        wanted = [(str(each.arguments[-1]), each) for each in sorted(others) if each != atom]
        name = str(Function(atom.name, subject))
        yield from self._instead(name, str(value), atom, wanted, until, len(wanted))

    def _instead(
        self,
        name: str,
        value: str,
        variable: Symbol,
        wanted: Sequence[tuple[str, Symbol]],
        until: float,
        left: int,
    ) -> Iterator[Tried]:
        """Yield a choice with the atoms that could replace it.

        ``left`` values share the time until ``until``.
        """
        able, rest, same = [], [], 0
        for other, atom in wanted:
            self._relaxed.until = until
            try:
                kind = self._kind(atom, variable)
            except Late:
                return
            if kind is None:
                same += 1
                continue
            (able if kind else rest).append((other, atom))
        shown = Choice(name, value, tuple(Alternative(other, True) for other, _ in able))
        yield shown if able or rest or not wanted else None, len(able) + same
        for place, (other, atom) in enumerate(rest):
            now = monotonic()
            self._relaxed.until = now + max(0.0, until - now) / max(1, left - len(able) - same - place)
            yield Choice(name, value, (self._forbidden(other, atom, variable),)), 1

    def _posed(
        self, atom: Symbol, variable: Symbol
    ) -> tuple[Statement, list[Statement], dict[Any, Statement]]:
        """Return the wish that an atom holds, the statements that must hold, too, and the picks to keep."""
        asked = self._relaxed.choice(Reason(str(atom)), [atom])
        hard, kept = [*self._statements, asked], {}
        for key, pick in self._kept.items():
            if _depends(variable, key[0]):  # A piece that does not exist may stand anywhere.
                hard.append(pick)
            elif key[0] != variable:
                kept[key] = pick
        return asked, hard, kept

    def _kind(self, atom: Symbol, variable: Symbol) -> bool | None:
        """Return True if an atom could hold with all picks but the variable's; None if nothing changes."""
        _, hard, kept = self._posed(atom, variable)
        layout = self._relaxed.model([*hard, *kept.values()])
        if layout is not None and set(layout) == self._layout:
            return None
        return layout is not None and self._possible([*hard, *kept.values()])

    def _forbidden(self, value: str, atom: Symbol, variable: Symbol) -> Alternative:
        """Return the reasons why an atom cannot hold with all other picks, as far as found in time."""
        asked, hard, kept = self._posed(atom, variable)
        because: tuple[Reason, ...] = ()
        able = None
        try:
            able = self._possible(hard)
            if self._most is None:
                needed = minimal([*hard, *kept.values()], self._possible, self._relaxed.core)
            else:
                picks = kept.values() if able else ()
                needed = preferred([*picks, *hard], self._possible, self._relaxed.core)
            because = tuple(dict.fromkeys(each.reason for each in needed if each is not asked))
            if not able:
                return Alternative(value, False, (), because)
            also = self._fewest(hard, kept) if self._most is not None else self._changed(hard, kept, variable)
        except Late:
            return Alternative(value, False, (OTHERS,) if able else (), because, known=False)
        return Alternative(value, False, also, because)

    def _changed(
        self, hard: Sequence[Statement], kept: dict[tuple[Symbol, Symbol], Statement], variable: Symbol
    ) -> tuple[str, ...]:
        """Return variables whose change makes the rest possible, and none of which can keep its value.

        Variables about the same thing come first.
        """
        given_up: list[tuple[Symbol, Symbol]] = []
        while not self._possible([*hard, *kept.values()]):
            core = self._relaxed.core([*hard, *kept.values()])
            culprits = [key for key, pick in kept.items() if pick in core]
            given_up.append(max(culprits, key=lambda key: _kinship(key[0], variable)))
            del kept[given_up[-1]]
        for key in given_up[-2::-1]:  # The last one is needed.
            if self._possible([*hard, *kept.values(), self._kept[key]]):
                kept[key] = self._kept[key]
        return tuple(dict.fromkeys(str(key[0]) for key in given_up if key not in kept))

    def _fewest(
        self, hard: Sequence[Statement], picks: Mapping[tuple[Symbol, Symbol], Statement]
    ) -> tuple[str, ...]:
        """Return the fewest variables of these picks whose change makes the rest possible."""
        assert self._most is not None
        for number in range(1, self._most + 1):
            kept = [*hard, self._relaxed.at_most(number, picks.values())]
            if self._possible(kept):
                changed = []
                for (variable, _), pick in picks.items():
                    if self._possible([*kept, pick]):
                        kept.append(pick)
                    else:
                        changed.append(str(variable))
                return tuple(dict.fromkeys(changed))
        return (f"more than {self._most} other choices",)


def _pick(variable: Symbol, value: Symbol) -> Symbol:
    return Function("pick", [variable, value])


def _depends(variable: Symbol, other: Symbol) -> bool:
    """Return True if a variable is about a part of another's subject: ``place(bed,1)`` of ``count(bed)``."""
    most = len(other.arguments)
    return 0 < most < len(variable.arguments) and variable.arguments[:most] == other.arguments


def _kinship(variable: Symbol, other: Symbol) -> int:
    """Return the number of common first arguments of two variables. The most related one changes first."""
    pairs = zip(variable.arguments, other.arguments, strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
