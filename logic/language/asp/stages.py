"""The ``#program`` in which a rule of a grammar acts, by the words that it uses and derives.

A layout comes from two programs, house and room, with base in both. An atom of one program does not hold in
the other. A topology with units has a third program, units, before them. The core itself tells in which
programs its words are known.
"""

from collections.abc import Container, Iterable, Iterator
from typing import NamedTuple

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.language.asp.audit import STAGES, UNITS
from vitruvius.logic.language.asp.statements import Statement, error_at, place
from vitruvius.logic.language.asp.vocabulary import Signature, Use, Words, core_words, stages

PARTS = {"plan": "room"}
"""Programs of the core that belong to another one, if rooms share walls."""

EVERY = frozenset({"base", UNITS, *STAGES})


class Word(NamedTuple):
    """Word of a rule, and the programs in which it has a meaning."""

    name: str
    use: Use
    programs: frozenset[str]


def misplaced(own: Words, refused: Container[int]) -> Iterator[GrammarError]:
    """Yield errors for rules that do not act as they read in their program.

    ``refused`` holds the ids of nodes that have another error. Rules of a file before any ``#program`` that
    belong after the same one give one error, at the first of them.
    """
    together: dict[tuple[str, str], list[GrammarError]] = {}
    for statement, put, error in _misplaced(own, refused):
        if put and statement.program == "base":
            # An atom derived in the first stage may serve both.
            together.setdefault((str(error.file), put.partition(" or ")[0]), []).append(error)
        else:
            yield error
    for errors in together.values():
        first = min(errors, key=lambda error: (error.line or 0, error.column or 0))
        more = f" ({len(errors) - 1} more of this file too)" if len(errors) > 1 else ""
        yield GrammarError(f"{first.message}{more}", first.file, first.line, first.column)


def _misplaced(own: Words, refused: Container[int]) -> Iterator[tuple[Statement, str, GrammarError]]:
    """Yield each of these rules with its error, and with a remedy if the rule belongs elsewhere."""
    every = frozenset({"base", *stages(own.core or core_words())})
    rules: dict[int, tuple[Statement, list[Word]]] = {}
    for word in _words(own):
        statement = word.use.statement
        rules.setdefault(id(statement.node), (statement, []))[1].append(word)
    for node, (statement, used) in rules.items():
        found = [word for word in used if word.programs]  # Otherwise another error reports the word.
        if node in refused or statement.program not in every:
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
            yield statement, put, statement.error(f"say which stage this binds: {put}")
        elif fits:
            yield statement, put, error_at(bad.use.node, f"{_where(bad)}: {put}")
        else:
            other = next(word for word in found if not word.programs & bad.programs)
            meant = _with_other_arity(bad, statement.program, own)
            hint = f"did you mean {meant}?" if meant else "no rule sees both"
            error = error_at(bad.use.node, f"{_where(bad)}, and {_where(other)}: {hint}")
            yield statement, "", error


def _with_other_arity(word: Word, program: str, own: Words) -> str:
    """Return a predicate with this name and another arity that a program knows, or an empty text."""
    core = own.core or core_words()
    name = word.name.split("/")[0]
    others = {each for each in {*core.derived, *own.derived} if each[0] == name and _name(each) != word.name}
    known = sorted(each for each in others if program in _known(each, own, core))
    return _name(known[0]) if known else ""


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
    """Return the programs in which a predicate may hold: all programs if nothing derives it."""
    programs = _programs(own.derived.get(signature, ())) | _programs(core.derived.get(signature, ()))
    if any(use.statement.program not in {*EVERY, "pick"} for use in core.derived.get(signature, ())):
        # A part that a request or the lengths add to the stage whose rules use it.
        programs |= _programs(core.used.get(signature, ()))
    if programs and not programs & {*EVERY, "pick"} and signature in own.derived:
        return EVERY  # In a misspelt program.
    return EVERY if not programs or programs & {"base", "pick"} else programs & EVERY


def _needed(signature: Signature, own: Words, core: Words) -> frozenset[str]:
    """Return the programs in which deriving a predicate has an effect: all if the core does not use it."""
    readers = _programs(core.used.get(signature, ()))
    if "pick" in readers or not readers & EVERY:  # Every program includes the picks.
        return EVERY
    # The program house reads the grammar's statements and finds mistakes in them.
    return frozenset({"base"} if readers & {"room", UNITS} else {"base", "house"})


def _programs(uses: Iterable[Use]) -> frozenset[str]:
    return frozenset(PARTS.get(use.statement.program, use.statement.program) for use in uses)


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
