# clingo.ast leaves the attributes of its nodes untyped.
# pyright: reportAttributeAccessIssue=false
"""Loading of a grammar step by step, to find the step that takes too much time or memory.

clingo grounds all rules in one call, which cannot be interrupted. Therefore the process has limits, and
before each step it sends the error to report if the step does not end. Rules with a body join the facts one
by one. Then each constraint is a ``#program`` part, which is ground once the atoms that it joins are known.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import clingo
from clingo import Function, ast
from clingo.ast import ASTType

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import Grammar
from vitruvius.logic.language.asp.audit import audit, unreadable
from vitruvius.logic.language.asp.statements import Statement, read
from vitruvius.logic.language.asp.stratification import unstratified
from vitruvius.logic.language.asp.vocabulary import words
from vitruvius.logic.language.linter import ROOMS_TESTED
from vitruvius.logic.language.loaded import furniture_of
from vitruvius.logic.layout.conditional import HERE
from vitruvius.logic.layout.differences import STATING
from vitruvius.logic.layout.messages import written
from vitruvius.logic.layout.program import CORE, HOUSE, Part, Program
from vitruvius.logic.layout.terms import length_facts, parts
from vitruvius.logic.placement.lengths import stated_lengths
from vitruvius.logic.placement.placer import Placer

TOO_MUCH = "takes too much time or memory"


def steps(grammar: Grammar, sizes: Sequence[int]) -> Iterator[GrammarError]:
    """Load a grammar, or ground houses of these numbers of rooms. Yield the error for each step before it.

    The error is to be reported if the step does not end. The steps stop at any other error of the grammar.
    """
    try:
        if not sizes:
            yield from _reading(grammar)
        for rooms in sizes or ROOMS_TESTED:
            yield from _grounding(grammar, {"rooms": rooms}, [("house", [])])
        placer = Placer(grammar)
        pieces = {} if placer.problems else furniture_of(Program(grammar.asp, {"rooms": 1}, HOUSE))
        for type_, each in pieces.items():
            for names in [[], *([piece] for piece in each)]:
                yield _clause(placer, type_, *names)
                stated_lengths(placer, {type_: names})
        extremes, wrong, absent = stated_lengths(placer, pieces)
        for type_, facts in {}.items() if wrong or absent else length_facts(extremes).items():
            room = [("room", []), *parts(fact for fact, _ in facts)]
            yield from _grounding(grammar, {"this_room": type_}, room)
    except GrammarError:
        return


def _reading(grammar: Grammar) -> Iterator[GrammarError]:
    for file in grammar.asp:
        yield GrammarError(f"to read this file {TOO_MUCH}", file, 1, 1)
        statements = [] if any(unreadable(file)) else read([file])
        words(statements)
        list(audit(statements))
        list(unstratified(statements))
    for file in grammar.prolog:
        yield GrammarError(f"to read this file {TOO_MUCH}", file, 1, 1)
        Placer(replace(grammar, prolog=(file,)))


def _clause(placer: Placer, type_: str, *piece: str) -> GrammarError:
    """Return the error for the sizes of a room or a piece if they take too long."""
    clause = Function("size", [Function(name) for name in (type_, *piece)])
    file, line = placer.origins([clause]).get(clause, (None, None))
    head = f"piece_size({piece[0]}, ...)" if piece else f"room_size({type_}, ...)"
    return GrammarError(f"{head} {TOO_MUCH}: does it try too many ways?", file, line, line and 1)


def _grounding(
    grammar: Grammar, constants: Mapping[str, object], parts: Sequence[Part]
) -> Iterator[GrammarError]:
    """Ground these parts of the core and the grammar's files."""
    # Differences restrict the ground rules, and add few.
    core = _by_kind(read([file for file in grammar.topology if file not in STATING]))
    given, derived, constraints = _by_kind(read(grammar.own))
    given = [*core[0], *core[1], *given]
    for number in range(len(derived) + 1):
        yield _slow(derived[number - 1]) if number else _large(grammar)
        control = clingo.Control([f"-c{name}={value}" for name, value in constants.items()], logger=_silent)
        control.load(str(CORE))
        with ast.ProgramBuilder(control) as builder:
            for each in given + derived[:number]:
                _add(builder, each.node, each.program)
            for place, each in enumerate(core[2] + constraints):
                name = f"constraint_{max(0, place + 1 - len(core[2]))}"
                _add(builder, each.node, f"{name}_{each.program}")
        control.ground([("base", []), *parts, ("pick", [])])
        if number == len(derived):
            programs = {"base", *(name for name, _ in parts)}
            yield _large(grammar)
            control.ground([(f"constraint_0_{program}", []) for program in sorted(programs)])
            for place, each in enumerate(constraints, start=1):
                if each.program in programs:
                    yield _slow(each)
                    control.ground([(f"constraint_{place}_{each.program}", [])])


def _by_kind(statements: Iterable[Statement]) -> tuple[list[Statement], list[Statement], list[Statement]]:
    """Return facts and definitions, then rules that derive several atoms, then constraints."""
    given: list[Statement] = []
    derived: list[Statement] = []
    constraints: list[Statement] = []
    for each in statements:
        kind = each.node.ast_type
        if kind == ASTType.Rule and str(each.node.head) == "#false":
            constraints.append(each)
        elif kind == ASTType.Rule and (each.node.body or ".." in str(each.node)):
            derived.append(each)
        elif kind not in {ASTType.Program, ASTType.Comment}:
            given.append(each)
    return given, derived, constraints


def _add(builder: ast.ProgramBuilder, node: ast.AST, program: str) -> None:
    builder.add(ast.Program(HERE, program, []))
    builder.add(node)


def _large(grammar: Grammar) -> GrammarError:
    """Return the error for shared rules that take too long with the facts of the grammar."""
    why = f"to ground the shared rules with what this grammar states {TOO_MUCH}"
    return GrammarError(f"{why}: ask for fewer rooms, or state fewer types and pieces", grammar.directory)


def _slow(rule: Statement) -> GrammarError:
    why = "does it recur without end, or join too many values?"
    return rule.error(f"to ground this rule {TOO_MUCH}: {why} {written(rule.node)}")


def _silent(code: clingo.MessageCode, text: str) -> None:
    """Ignore clingo's remarks, which are reported when the grammar is loaded."""
