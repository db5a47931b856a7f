"""Mistakes in a grammar that clingo and SWI-Prolog ignore, by file, line and column."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import chain, zip_longest
from pathlib import Path
from typing import Any

from vitruvius.logic.errors import Finding, GrammarError, Reason
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.language.absent import absent
from vitruvius.logic.language.asp.audit import UNITS
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.language.unread import unread
from vitruvius.logic.layout.account import GROUNDING
from vitruvius.logic.layout.conditional import Source
from vitruvius.logic.layout.program import HOUSE, Part
from vitruvius.logic.layout.programs import GIVEN_ROOM_CONSTANTS
from vitruvius.logic.layout.relaxed import Relaxed
from vitruvius.logic.looks.looks import DEFAULT, FILE_NAME, read_looks, unused
from vitruvius.logic.placement.lengths import typical_lengths

ROOMS_TESTED = (6, 8, 4, 3, 2, 1)
"""Numbers of rooms of the houses in which lint tests if a rule binds, in this order."""

ROOMS_OF_UNITS_TESTED = (16,)
"""Numbers of rooms of houses of units for the same tests."""

MORE_ROOMS_TESTED = (5, 7, 10, 12, 14, 16, 20, 27, 40, 53, 64, 90, 128)
"""Further numbers for rules that bind in none of these houses, if the topology permits them."""

ROOMS_SEARCHED = (6, 8, 3, 1, 10, 14)
"""Numbers of rooms of the houses that ``lint`` searches for, in this order."""

MOST_INSTANCES = 1_500_000
"""Largest number of ground rules that are examined, in three seconds; shipped grammars have 100,000."""

Ground = tuple[dict[str, Any], list[Part]]
"""Constants, and the parts of the program that are ground with them."""


def findings(grammar: Grammar) -> list[Finding]:
    """Return all findings about a grammar: errors, or else warnings."""
    loaded = LoadedGrammar(grammar)
    return errors(grammar, loaded) or all_warnings(grammar, loaded)


def errors(grammar: Grammar, loaded: LoadedGrammar) -> list[Finding]:
    """Return the errors for which ``generate`` refuses a grammar, and ``draw`` its looks."""
    looks = grammar.directory / FILE_NAME
    wrong = read_looks(looks, DEFAULT)[1] if looks.exists() else []
    return _findings("error", [*(loaded.errors or _beside_typical(grammar, loaded)), *wrong], grammar)


def _beside_typical(grammar: Grammar, loaded: LoadedGrammar) -> list[GrammarError]:
    """Return the errors of the limits that replace typical lengths when these give way."""
    typical = typical_lengths(loaded.placer, loaded.furniture).values()
    if not typical:
        return []
    found = LoadedGrammar(replace(grammar, gave_way=tuple(typical)), loaded.placer.cell, remarks=False)
    loaded.placer.load()
    return found.errors


def all_warnings(grammar: Grammar, loaded: LoadedGrammar) -> list[Finding]:
    """Return warnings for useless parts of the rules and the looks of a grammar without errors."""
    sizes = [number for number in ROOMS_SEARCHED if number <= loaded.most_rooms]
    others = [*absent(loaded, sizes), *_unseen(grammar.directory / FILE_NAME, loaded)]
    return warnings(grammar, loaded) + _findings("warning", others, grammar)


def _unseen(looks: Path, loaded: LoadedGrammar) -> Iterator[GrammarError]:
    """Yield warnings for types that a grammar's looks name and its rules do not."""
    if looks.exists():
        pieces = {piece for pieces in loaded.furniture.values() for piece in pieces}
        yield from unused(looks, map(str, loaded.types), pieces)


def warnings(grammar: Grammar, loaded: LoadedGrammar, rooms: int | None = None) -> list[Finding]:
    """Return warnings for useless rules without errors, in houses of ``rooms`` rooms if given."""
    found = [*unread(grammar.directory), *loaded.warnings, *_idle(grammar, loaded, rooms)]
    return _findings("warning", found, grammar)


def _findings(severity: str, found: Iterable[GrammarError], grammar: Grammar) -> list[Finding]:
    """Return findings of one severity. An error without a place gets the grammar's directory."""
    return [
        Finding(severity, str(each.file or grammar.directory), each.line or 1, each.column or 1, each.message)
        for each in found
    ]


def _idle(grammar: Grammar, loaded: LoadedGrammar, rooms: int | None) -> list[GrammarError]:
    """Return warnings for rules that bind in no examined house of the topology and in no type of room."""
    unbound: dict[Reason, None] = {}
    program_of = loaded.rules.program_of
    source, left, most = Source(grammar.asp), MOST_INSTANCES, 0
    limit = ""
    for constants, parts in _programs(loaded, rooms, unbound):
        ground = {"base", *(name for name, _ in parts)}
        if most and all(program_of[each.file, each.line, each.column] not in ground for each in unbound):
            continue  # None of the remaining rules is in it.
        named = ", ".join(
            f"{name} = {value}" for name, value in constants.items() if name not in GIVEN_ROOM_CONSTANTS
        )
        loaded.placer.account.at(GROUNDING, f"which rules bind where {named} (clingo)")
        program = Relaxed(source, constants, parts, most=left)
        left -= program.instances
        bound = {each.reason for each in program.statements if program.binds(each)}
        if not most:
            unbound |= dict.fromkeys(each.reason for each in program.statements)
        for reason in bound & unbound.keys():
            del unbound[reason]
        if left < 0:
            limit = f" in houses of up to {most} rooms"
        if left < 0 or not unbound:
            break
        most = max(most, constants.get("rooms", 0))
    return [
        GrammarError(f"this rule never binds{limit}: {reason.text}", reason.file, reason.line, reason.column)
        for reason in (unbound if most else ())
        if not grammar.borrows(Path(str(reason.file)))
    ]


def _programs(loaded: LoadedGrammar, rooms: int | None, unbound: Iterable[Reason]) -> Iterator[Ground]:
    """Yield programs in which a rule may bind, those in which most rules bind first.

    The last programs have the numbers of rooms that the ``unbound`` rules, at that time, mention.
    """
    stages = [("house", loaded.most_rooms)]
    if loaded.depths:
        stages = [(UNITS, loaded.most_rooms), ("house", loaded.most_in_unit)]

    def houses(some: Iterable[int], stage: str, most: int) -> list[Ground]:
        numbers = (number for number in dict.fromkeys(some) if 0 < number <= most)
        parts: list[Part] = [(UNITS, [])] if stage == UNITS else [*HOUSE]
        return [({"rooms": number}, parts) for number in numbers]

    usual = [
        houses([rooms or 0, *(ROOMS_OF_UNITS_TESTED if stage == UNITS else ROOMS_TESTED)], stage, most)
        for stage, most in stages
    ]
    yield from filter(None, chain.from_iterable(zip_longest(*usual, _furniture(loaded))))
    for stage, most in stages:
        named = [number + by for number in _numbers(unbound, loaded) for by in (0, 1, -1)]
        yield from houses([*named, *MORE_ROOMS_TESTED, most], stage, most)


def _furniture(loaded: LoadedGrammar) -> Iterator[Ground]:
    """Yield the programs of furniture of each type, also with any doors if rooms share walls."""
    types = [*map(str, loaded.types)]
    for type_ in types:
        yield {"this_room": type_}, [("room", [])]
    for type_ in types if loaded.grammar.shares_walls else ():
        yield {"this_room": type_, **GIVEN_ROOM_CONSTANTS}, [("room", []), ("plan", []), ("doorways", [])]


def _numbers(rules: Iterable[Reason], loaded: LoadedGrammar) -> list[int]:
    """Return the numbers in some rules, and in all constants that the grammar defines."""
    texts = [*(reason.text for reason in rules), *loaded.rules.constants]
    return sorted({int(number) for text in texts for number in re.findall(r"\b\d{1,3}\b", text)})
