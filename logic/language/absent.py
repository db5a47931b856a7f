"""Warnings for room types that no house of a grammar has, and for grammars without a house."""

from collections.abc import Iterator, Sequence

from vitruvius.logic.errors import GrammarError, Reason
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.conditional import Source
from vitruvius.logic.layout.conflicts import minimal
from vitruvius.logic.layout.program import HOUSE
from vitruvius.logic.layout.relaxed import Relaxed, Statement, TooMany
from vitruvius.logic.layout.terms import granted, parts, requirements
from vitruvius.logic.spelling import listed

MAX_CONFLICTS = 2_000
"""Number of conflicts of clingo in each search; a search that needs more reports nothing."""

MAX_BLAMED = 3
"""Number of rules that a warning lists."""


def absent(loaded: LoadedGrammar, sizes: Sequence[int]) -> Iterator[GrammarError]:
    """Yield a warning for each type that no house of these numbers of rooms has, or one if there is no house.

    The search ignores lengths, and skips grammars of units.
    """
    if loaded.depths:
        return
    source, types, any_house = Source(loaded.grammar.asp), dict.fromkeys(map(str, loaded.types)), False
    last: dict[str, tuple[Relaxed, list[Statement]]] = {}
    for rooms in sizes:
        asked = requirements("among", dict.fromkeys(types, (1, None)))
        relaxed = Relaxed(source, {"rooms": rooms}, [*HOUSE, *parts(asked)])
        if not _possible(relaxed, relaxed.statements):
            if not any_house:
                last[""] = relaxed, []
            continue
        any_house = True
        for atom in asked:
            type_ = atom.arguments[0].name
            choice = relaxed.choice(Reason(""), [granted(atom)])
            if _possible(relaxed, [*relaxed.statements, choice]):
                del types[type_]
            else:
                last[type_] = relaxed, [choice]
        if not types:
            return
    *fewer, most = sorted(sizes)
    none = f"no house of {f'{listed([*map(str, fewer)])} or ' if fewer else ''}{most} rooms"
    if not any_house:
        yield _warning(*last[""], none)
        return
    for type_ in types:
        yield _warning(*last[type_], f"{none} has a room of the type {type_}")


def _possible(relaxed: Relaxed, some: Sequence[Statement]) -> bool:
    """Return True if there is a layout, or if the search reaches its limit."""
    try:
        return relaxed.model(some, conflicts=MAX_CONFLICTS) is not None
    except TooMany:
        return True


def _warning(relaxed: Relaxed, choices: Sequence[Statement], what: str) -> GrammarError:
    """Return a warning at the last rule of a conflict with these choices; the text names the other rules."""

    def core(some: Sequence[Statement]) -> list[Statement]:
        found = relaxed.core([*some, *choices])
        return [each for each in some if each in found]

    blamed = minimal(relaxed.statements, lambda some: _possible(relaxed, [*some, *choices]), core)
    reasons = sorted((each.reason for each in blamed), key=lambda each: (":-" in each.text, each.line or 0))
    *others, last = reasons or [Reason("what the core requires")]
    beside = [str(each) for each in others[:MAX_BLAMED]] + ["..."] * (len(others) > MAX_BLAMED)
    by = f" with {', '.join(beside)}" if beside else ""
    rule = f"this rule{by}: {last.text}"
    verb = "keeps" if not choices else "by"
    return GrammarError(f"{what} {verb} {rule}", last.file, last.line, last.column)
