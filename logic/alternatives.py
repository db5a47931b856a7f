"""What could be in a house instead: other values, all other choices as they are, or what forbids them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile

from clingo import Function, Symbol

from logic.errors import Reason
from logic.explain import Relaxed, Statement, minimal, preferred
from logic.why import Alternative, Choice


@dataclass(frozen=True)
class Chosen:
    """The choices of a layout: what each variable picks (one value or several), and what it may pick."""

    picks: Mapping[Symbol, Sequence[Symbol]]
    options: Mapping[Symbol, Sequence[Symbol]]


class Search:
    """Tries other values of the choices that made a layout."""

    def __init__(
        self,
        relaxed: Relaxed,
        statements: Sequence[Statement],
        possible: Callable[[Sequence[Statement]], bool],
        chosen: Chosen,
        layout: Iterable[Symbol],
        most: int | None = None,
    ) -> None:
        """Know a relaxed program, its statements, a test of them, and the choices that made this layout.

        With ``most`` choices depend on each other as those of a plan do: conflicts are then of few rules and
        many choices, and no more than ``most`` others are named that would have to change too.
        """
        self._most = most
        self._relaxed, self._statements, self._possible = relaxed, statements, possible
        self._chosen, self._layout = chosen, set(layout)
        self._kept = {
            (variable, value): relaxed.choice(Reason(f"{variable} = {value}"), [_pick(variable, value)])
            for variable, values in chosen.picks.items()
            for value in values
        }

    def choices(self, variables: Iterable[Symbol]) -> list[Choice]:
        """These variables, each of which picks one value, with their other values.

        Without those that make no difference: values that give the same layout, variables with no other.
        """
        found = []
        for variable in variables:
            (value,) = self._chosen.picks[variable]
            others = [each for each in self._chosen.options[variable] if each != value]
            tried = [self._try(str(other), _pick(variable, other), variable) for other in others]
            instead = tuple(each for each in tried if each is not None)
            if instead or not others:
                found.append(Choice(str(variable), str(value), instead))
        return found

    def of_atom(self, atom: Symbol, others: Iterable[Symbol]) -> Choice:
        """An atom that holds by several picks, and others that could instead: the last term differs."""
        *subject, value = atom.arguments
        tried = [self._try(str(each.arguments[-1]), each, atom) for each in sorted(others) if each != atom]
        name = Function(atom.name, subject)
        return Choice(str(name), str(value), tuple(each for each in tried if each is not None))

    def _try(self, value: str, atom: Symbol, variable: Symbol) -> Alternative | None:
        """Whether an atom could hold where all picks but the variable's stay; None if nothing changes."""
        asked = self._relaxed.choice(Reason(str(atom)), [atom])
        hard, kept = [*self._statements, asked], {}
        for key, pick in self._kept.items():
            if _depends(variable, key[0]):  # A piece that is not there stands anywhere.
                hard.append(pick)
            elif key[0] != variable:
                kept[key] = pick
        layout = self._relaxed.model([*hard, *kept.values()])
        if layout is not None and set(layout) == self._layout:
            return None
        if self._possible([*hard, *kept.values()]):
            return Alternative(value, True)
        able = self._possible(hard)
        if self._most is None:
            needed = minimal([*hard, *kept.values()], self._possible, self._relaxed.core)
        else:
            picks = kept.values() if able else ()
            needed = preferred([*picks, *hard], self._possible, self._relaxed.core)
        because = tuple(dict.fromkeys(each.reason for each in needed if each is not asked))
        if not able:
            return Alternative(value, False, (), because)
        if self._most is not None:
            return Alternative(value, False, self._fewest(hard, kept), because)
        given_up: list[tuple[Symbol, Symbol]] = []
        while not self._possible([*hard, *kept.values()]):
            core = self._relaxed.core([*hard, *kept.values()])
            culprits = [key for key, pick in kept.items() if pick in core]
            given_up.append(max(culprits, key=lambda key: _kinship(key[0], variable)))
            del kept[given_up[-1]]
        for key in given_up[-2::-1]:  # The last one is needed.
            if self._possible([*hard, *kept.values(), self._kept[key]]):
                kept[key] = self._kept[key]
        also = tuple(dict.fromkeys(str(key[0]) for key in given_up if key not in kept))
        return Alternative(value, False, also, because)

    def _fewest(
        self, hard: Sequence[Statement], picks: Mapping[tuple[Symbol, Symbol], Statement]
    ) -> tuple[str, ...]:
        """The fewest variables of these picks of which others make the rest possible."""
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
    """Whether a variable is about a part of what another is about, as ``place(bed,1)`` of ``count(bed)``."""
    most = len(other.arguments)
    return 0 < most < len(variable.arguments) and variable.arguments[:most] == other.arguments


def _kinship(variable: Symbol, other: Symbol) -> int:
    """How much two variables are about the same thing: that is the first to change."""
    pairs = zip(variable.arguments, other.arguments, strict=False)
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
