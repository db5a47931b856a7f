"""The mistakes in a grammar that clingo and SWI-Prolog pass over, by file, line and column."""

from collections.abc import Iterable

from logic.errors import Finding, GrammarError, Reason
from logic.explain import Relaxed
from logic.grammar import Grammar
from logic.loaded import LoadedGrammar

SIZES = (1, 2, 3, 4, 6, 8)
"""Numbers of rooms for which a rule is looked for to bind."""


def findings(grammar: Grammar) -> list[Finding]:
    """All that is wrong with a grammar: errors, for which ``generate`` refuses it, and then warnings."""
    loaded = LoadedGrammar(grammar)
    errors, warnings = loaded.errors, []
    if not errors:
        warnings = [*loaded.warnings, *_warnings(grammar, map(str, loaded.types))]
        try:
            loaded.programs.refuse_remarks()
        except GrammarError as error:
            errors = [error]
    return [
        Finding(severity, str(each.file or grammar.directory), each.line or 1, each.column or 1, each.message)
        for severity, found in (("error", errors), ("warning", warnings))
        for each in found
    ]


def _warnings(grammar: Grammar, types: Iterable[str]) -> list[GrammarError]:
    """Rules that bind in no house of the usual sizes and in no type of room."""
    programs = [Relaxed(grammar.asp, {"rooms": rooms}, [("house", [])]) for rooms in SIZES]
    programs += [Relaxed(grammar.asp, {"this_room": type_}, [("room", [])]) for type_ in types]
    bound: dict[Reason, bool] = {}
    for program in programs:
        for statement in program.statements:
            bound[statement.reason] = bound.get(statement.reason, False) or program.binds(statement)
    return [
        GrammarError(f"this rule never binds: {reason.text}", reason.file, reason.line, reason.column)
        for reason, binds in bound.items()
        if not binds
    ]
