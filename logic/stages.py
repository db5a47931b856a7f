"""Which ``#program`` a rule of a grammar acts in, by the words that it uses and derives.

A layout is made in two programs, house and room, with base in both: what holds in one of them does not hold
in the other. Where a topology has units, a third one, units, comes before them. Where a word of the core is
known is read from the core itself.
"""

from collections.abc import Container, Iterable, Iterator
from typing import NamedTuple

from logic.audit import STAGES, UNITS
from logic.errors import GrammarError
from logic.statements import Statement, error_at, place
from logic.vocabulary import Signature, Use, Words, core_words, stages

EVERY = frozenset({"base", UNITS, *STAGES})


class Word(NamedTuple):
    """A word of a rule, and the programs in which it has a meaning."""

    name: str
    use: Use
    programs: frozenset[str]


def misplaced(own: Words, refused: Container[int]) -> Iterator[GrammarError]:
    """Rules that do not act as they read in the program in which they stand.

    ``refused`` holds the ids of nodes of which something else is said.
    """
    every = frozenset({"base", *stages(own.core or core_words())})
    rules: dict[int, tuple[Statement, list[Word]]] = {}
    for word in _words(own):
        statement = word.use.statement
        rules.setdefault(id(statement.node), (statement, []))[1].append(word)
    for node, (statement, found) in rules.items():
        if node in refused:
            continue
        found.sort(key=lambda word: place(word.use.node))
        fits = every.intersection(*(word.programs for word in found))
        if _is_constraint(statement):
            fits -= {"base"}
        if statement.program in fits:
            continue
        put = f"put it after {' or '.join(f'#program {each}.' for each in sorted(fits))}"
        bad = next((word for word in found if statement.program not in word.programs), None)
        if bad is None:
            yield statement.error(f"say which stage this binds: {put}")
        elif fits:
            yield error_at(bad.use.node, f"{_where(bad)}: {put}")
        else:
            other = next(word for word in found if not word.programs & bad.programs)
            yield error_at(bad.use.node, f"{_where(bad)}, and {_where(other)}: no rule sees both")


def _words(own: Words) -> Iterator[Word]:
    core = own.core or core_words()
    for signature, uses in own.used.items():
        for use in uses:
            yield Word(_name(signature), use, _known(signature, own, core))
    for signature, uses in own.derived.items():
        for use in uses:
            yield Word(_name(signature), use, _needed(signature, own, core))
    for name, definition in core.defined.items():
        for use in own.constants.get(name, ()):
            yield Word(name, use, frozenset({definition.statement.program}))


def _known(signature: Signature, own: Words, core: Words) -> frozenset[str]:
    """The programs in which a predicate may hold; all where nothing derives it."""
    programs = _programs(own.derived.get(signature, ())) | _programs(core.derived.get(signature, ()))
    if any(use.statement.program not in {*EVERY, "pick"} for use in core.derived.get(signature, ())):
        # A part that a request or the lengths add, to the stage whose rules use it.
        programs |= _programs(core.used.get(signature, ()))
    return EVERY if not programs or programs & {"base", "pick"} else programs & EVERY


def _needed(signature: Signature, own: Words, core: Words) -> frozenset[str]:
    """The programs in which it is of use to derive a predicate: all, where the core does not use it."""
    readers = _programs(core.used.get(signature, ())) & EVERY
    if not readers:
        return EVERY
    # What a grammar states is read, and found wrong, in the program house.
    return frozenset({"base"} if readers & {"room", UNITS} else {"base", "house"})


def _programs(uses: Iterable[Use]) -> frozenset[str]:
    return frozenset(use.statement.program for use in uses)


def _is_constraint(statement: Statement) -> bool:
    return str(statement.node.head) == "#false" or str(statement.node.head).startswith("not ")


def _where(word: Word) -> str:
    if word.programs == {"base"}:
        return f"{word.name} is read in both stages"
    return (
        f"{word.name} is known in {' and '.join(f'#program {each}' for each in sorted(word.programs))} alone"
    )


def _name(signature: Signature) -> str:
    return f"{signature[0]}/{signature[1]}"
