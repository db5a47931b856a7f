"""Heads that a grammar may have: none of the core's, whose picks alone make a layout."""

from collections.abc import Iterator
from typing import Any

from clingo.ast import ASTType

from vitruvius.logic.grammar import STATED, Grammar
from vitruvius.logic.language.asp.audit import STAGES, UNITS
from vitruvius.logic.language.asp.statements import Statement, place
from vitruvius.logic.language.asp.vocabulary import Signature, Use, Words, core_words
from vitruvius.logic.layout.messages import written
from vitruvius.logic.spelling import closest

CHOICES = {("option", 3), ("picks", 2)}
"""Predicates whose first argument names a choice."""

NAMES = {ASTType.Function, ASTType.SymbolicTerm}
UNNAMED = "name the choice by a word, as in option(mine(X),..): what stands here may be a choice of the core"
TAKEN = "the core picks {name} itself: state a constraint, or name another choice"
MOVED = "the topology states {name}: move this to {topology}.lp"
ELSEWHERE = (
    "the topology states {name}, here {topology}: one of your own is a file NAME.lp that topology(NAME) names"
)
BY_CONSTRAINT = "require it by a constraint, which has no head: it says what never holds"
"""Messages for these heads."""


def closed_heads(own: Words, grammar: Grammar) -> Iterator[tuple[Statement, str]]:
    """Yield statements that derive or rename words of the core or of the topology, each with a remedy."""
    core = own.core or core_words()
    yield from _of_topology(own, core, grammar)
    forbidden = closed(core)
    for signature, uses in own.derived.items():
        if signature in forbidden:
            for use in uses:
                yield use.statement, _instead(signature, use, own, core)
    for name, use in own.defined.items():
        if name in core.defined:
            yield use.statement, f"{name} comes from the request: leave #const {name} out"
        elif name in core.constants:
            yield use.statement, f"{name} is a word of the core: choose another name"
    taken = choices(core)
    for signature in CHOICES:
        for use in own.derived.get(signature, ()):
            if use.node.arguments[0].ast_type not in NAMES:
                yield use.statement, UNNAMED
            elif name := _taken(use, taken):
                yield use.statement, TAKEN.format(name=name)


def _taken(use: Use, taken: dict[Signature, set[str]]) -> str:
    """Return the choice of an option, if the core makes it, too, in a program that is read with it."""
    choice = _functor(use.node.arguments[0])
    if not any(_meet(use.statement.program, other) for other in taken.get(choice, ())):
        return ""
    return f"{choice[0]}/{choice[1]}" if choice[1] else choice[0]


def _of_topology(own: Words, core: Words, grammar: Grammar) -> Iterator[tuple[Statement, str]]:
    """Yield statements that only the file of the topology may have, and that are elsewhere."""
    name = grammar.topology_name
    mine = [str(file) for file in grammar.own if file.stem == name]
    for signature, opened in core.opened.items():
        if place(opened.node)[0] != str(STATED):
            continue
        for use in own.derived.get(signature, ()):
            if place(use.node)[0] not in mine:
                said = MOVED if mine else ELSEWHERE
                yield use.statement, said.format(name=f"{signature[0]}/{signature[1]}", topology=name)


def closed(core: Words) -> set[Signature]:
    """Return the predicates that no grammar may derive."""
    return core.derived.keys() - core.opened.keys()


def choices(core: Words) -> dict[Signature, set[str]]:
    """Return the names of the core's choices, each with the programs in which the core makes the choice."""
    found: dict[Signature, set[str]] = {}
    for use in (use for each in CHOICES for use in core.derived.get(each, ())):
        found.setdefault(_functor(use.node.arguments[0]), set()).add(use.statement.program)
    return found


def _meet(program: str, other: str) -> bool:
    """Return True if statements of both programs may be read together, unlike those of two stages."""
    return program == other or not {program, other} <= {*STAGES, UNITS}


def why_closed(signature: Signature, core: Words) -> tuple[str, list[str]]:
    """Return the reason why no grammar derives a predicate, and programs for a constraint instead."""
    name = f"{signature[0]}/{signature[1]}"
    origins = [origin.statement for origin in core.derived[signature]]
    programs = {origin.program for origin in origins}
    stages = [stage for stage in STAGES if programs & {stage, "pick"}]
    if all(_is_fact(origin) for origin in origins):
        return f"the core states all of {name}: use it in bodies, or choose another name", []
    if signature not in core.documented or not stages:
        return f"the core derives {name} for itself: choose another name", []
    return f"the core alone derives {name}", stages


def _instead(signature: Signature, use: Use, own: Words, core: Words) -> str:
    why, stages = why_closed(signature, core)
    if not stages:
        # A statement before any #program may be a slip: units/2 for unit/2.
        inputs = {name for name, arity in core.opened.keys() - own.derived.keys() if arity == signature[1]}
        meant = closest(signature[0], inputs) if use.statement.program == "base" else None
        return f"{why}: did you mean {meant}/{signature[1]}?" if meant else why
    stage = use.statement.program if use.statement.program in stages else stages[0]
    rule = _constraint(use, stage, own)
    where = "" if stage == use.statement.program else f" after #program {stage}."
    other = "choose another name, or " if where else ""
    hint = f"{other}require it{where} by {rule} A constraint has no head: it says what never holds"
    hint = hint if rule else "a choice of yours is made by option/3"
    return f"{why}: {hint}"


def _is_fact(statement: Statement) -> bool:
    node = statement.node
    return not node.body and node.head.ast_type == ASTType.Literal and statement.program in {"base", *STAGES}


def _constraint(use: Use, stage: str, own: Words) -> str:
    """Return the constraint that requires what the head of a rule should state."""
    node = use.statement.node
    head = node.head
    if head.ast_type == ASTType.Aggregate:
        bounded = head.left_guard is not None or head.right_guard is not None
        required = [f"not {written(head)}"] if bounded else []
    elif head.ast_type == ASTType.Disjunction:
        required = [_unless(str(each)) for each in head.elements]
    elif head.ast_type == ASTType.Literal:
        required = [_unless(str(each)) for each in head.unpool()]
    else:
        required = []
    if not required:
        return ""
    parts = [written(literal) for literal in node.body] + required
    if stage == "room" and not node.body and (type_ := _type_of(use, own)):
        parts.insert(0, f"this_room = {type_}")
    return f":- {('; ' if any(':' in part for part in parts) else ', ').join(parts)}."


def _unless(literal: str) -> str:
    return literal.removeprefix("-") if literal.startswith("-") else f"not {literal}"


def _type_of(use: Use, own: Words) -> str:
    """Return a room type that may have a piece in an atom, since a constraint without it binds all types."""
    named = {str(argument) for argument in use.node.arguments}
    return next(
        (
            str(fact.node.arguments[0])
            for fact in own.derived.get(("may", 4), ())
            if str(fact.node.arguments[1]) in named
        ),
        "",
    )


def _functor(term: Any) -> Signature:
    if term.ast_type == ASTType.Function:
        return term.name, len(term.arguments)
    return str(term), 0
