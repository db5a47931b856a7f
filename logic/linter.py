"""The mistakes in a grammar that clingo and SWI-Prolog pass over, by file, line and column."""

from collections.abc import Iterable, Iterator
from itertools import chain, zip_longest
from pathlib import Path
from typing import Any

from logic.audit import UNITS
from logic.errors import Finding, GrammarError, Reason
from logic.explain import Relaxed, Source
from logic.grammar import Grammar
from logic.loaded import LoadedGrammar
from logic.looks import DEFAULT, NAME, read_looks, unused

SIZES = (6, 8, 4, 3, 2, 1)
"""Numbers of rooms for which a rule is looked for to bind, in this order."""

BUILDINGS = (16,)
"""The same of houses of units."""

Ground = tuple[dict[str, Any], str]
"""Constants and the program that is ground with them."""


def findings(grammar: Grammar) -> list[Finding]:
    """All that is wrong with a grammar: errors, or else warnings."""
    loaded = LoadedGrammar(grammar)
    return errors(grammar, loaded) or all_warnings(grammar, loaded)


def errors(grammar: Grammar, loaded: LoadedGrammar) -> list[Finding]:
    """For which ``generate`` refuses a grammar, and ``draw`` its looks."""
    looks = grammar.directory / NAME
    wrong = read_looks(looks, DEFAULT)[1] if looks.exists() else []
    return _findings("error", [*loaded.errors, *wrong], grammar)


def all_warnings(grammar: Grammar, loaded: LoadedGrammar) -> list[Finding]:
    """What is of no use in the rules and the looks of a grammar without errors."""
    return warnings(grammar, loaded) + _findings(
        "warning", _unseen(grammar.directory / NAME, loaded), grammar
    )


def _unseen(looks: Path, loaded: LoadedGrammar) -> Iterator[GrammarError]:
    """Types that a grammar's looks name and its rules do not."""
    if looks.exists():
        pieces = {piece for pieces in loaded.furniture.values() for piece in pieces}
        yield from unused(looks, map(str, loaded.types), pieces)


def warnings(grammar: Grammar, loaded: LoadedGrammar) -> list[Finding]:
    """What is of no use in rules without errors."""
    programs: list[Ground] = [({"rooms": rooms}, UNITS) for rooms in BUILDINGS if loaded.depths]
    programs += [({"rooms": rooms}, "house") for rooms in SIZES]
    furnished: list[Ground] = [({"this_room": str(type_)}, "room") for type_ in loaded.types]
    return _findings("warning", [*loaded.warnings, *_idle(grammar, programs, furnished)], grammar)


def _findings(severity: str, found: Iterable[GrammarError], grammar: Grammar) -> list[Finding]:
    """Findings of one severity; what has no place is of the grammar's directory."""
    return [
        Finding(severity, str(each.file or grammar.directory), each.line or 1, each.column or 1, each.message)
        for each in found
    ]


def _idle(grammar: Grammar, houses: Iterable[Ground], furnished: Iterable[Ground]) -> list[GrammarError]:
    """Rules that bind in no house of the usual sizes and in no type of room."""
    unbound: dict[Reason, None] | None = None
    source = Source(grammar.asp)
    for constants, stage in filter(None, chain.from_iterable(zip_longest(houses, furnished))):
        program = Relaxed(source, constants, [(stage, [])], counts=True)
        idle = {each.reason for each in program.statements if not program.binds(each)}
        every = unbound or dict.fromkeys(each.reason for each in program.statements)
        unbound = {reason: None for reason in every if reason in idle}
        if not unbound:
            break
    return [
        GrammarError(f"this rule never binds: {reason.text}", reason.file, reason.line, reason.column)
        for reason in unbound or ()
    ]
