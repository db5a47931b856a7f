# clingo.ast leaves the attributes of its nodes untyped.
# pyright: reportAttributeAccessIssue=false, reportOptionalMemberAccess=false
"""Rules under conditions: each rule of the user holds if ``stated(N)`` does, which may hold or not.

Without a fact its bounds and permissions are wider, and a fact that is absent can be added
(``why/left_out.lp``). Therefore a fact that is stated, or absent, can be among the reasons.
"""

import itertools
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from clingo import Function, Number, Symbol, SymbolType, ast

from vitruvius.logic.errors import Reason
from vitruvius.logic.grammar import RULES, TYPICAL, Places
from vitruvius.logic.layout.messages import written
from vitruvius.logic.layout.program import CORE
from vitruvius.logic.layout.reading import parse

BEGIN = ast.Position("<explanation>", 1, 1)
HERE = ast.Location(BEGIN, BEGIN)

LEFT_OUT = RULES / "why" / "left_out.lp"
"""Rules for the effect of facts that are left out or added."""

Signature = tuple[str, int]

ABSENT = " is not stated"
"""Words after a fact that a grammar lacks, placed at the first fact with the same first argument, or kind."""

LONGEST_MM = 1_000_000
"""Millimetres, more than any length; small enough for sums in clingo."""


class Source:
    """Rule files, parsed once for all programs that are made from them."""

    def __init__(self, files: Sequence[Path], left_out: Places = frozenset()) -> None:
        """Keep the files, without the typical rules at ``left_out``; the core is added when needed."""
        self.files, self._left_out = tuple(files), left_out
        self._read: dict[tuple[Any, ...], Conditional] = {}

    def conditional(self, files: Sequence[Path], laws: bool) -> "Conditional":
        """Return the statements of some files, each rule with its condition.

        With ``laws``, add those of the core's rules that require something.
        """
        key = tuple(files), laws
        if key not in self._read:
            self._read[key] = _conditional((CORE, *files) if laws else files, laws, self._left_out)
        return self._read[key]


class Conditional(NamedTuple):
    """Rules with conditions, and a reason for each condition.

    ``first`` has the place of the first fact of some kinds, by the fact's name, and by its name with its
    first argument, as in ``opens(hall``.
    """

    rules: list[ast.AST]
    reasons: list[Reason]
    first: dict[str, Reason]


def _conditional(files: Sequence[Path], laws: bool, left_out: Places) -> Conditional:
    """Return the result of ``Source.conditional``."""
    found = Conditional([ast.Program(HERE, "base", [])], [], {})
    kinds, program = left_out_facts(), ""

    def take(statement: ast.AST) -> None:
        nonlocal program
        if statement.ast_type == ast.ASTType.Program:
            program = statement.name
        begin: Any = statement.location.begin
        own = RULES not in Path(begin.filename).parents
        if statement.ast_type == ast.ASTType.Rule and (own or (laws and str(statement.head) == "#false")):
            condition = stated(len(found.reasons))
            place = begin.filename, begin.line, begin.column
            found.reasons.append(Reason(written(statement), *place, typical=program == TYPICAL))
            if (signature := _signature(statement.head)) in kinds:
                for name in (signature[0], _beginning(statement.head)):
                    found.first.setdefault(name, found.reasons[-1])
                found.rules.append(_about("listed'", statement, []))
                found.rules.append(_about("without'", statement, [literal(condition, ast.Sign.Negation)]))
            statement = statement.update(body=[*statement.body, literal(condition)])
        found.rules.append(statement)

    for file in files:
        parse([file], take, left_out=left_out)
    return found


@cache
def left_out_facts() -> set[Signature]:
    """Return the facts that ``rules/why/left_out.lp`` uses."""
    found = set[Signature]()

    def take(statement: ast.AST) -> None:
        for each in statement.body if statement.ast_type == ast.ASTType.Rule else ():
            if _signature(each) in {("listed'", 1), ("without'", 1)}:
                fact = each.atom.symbol.arguments[0]
                found.add((fact.name, len(fact.arguments)))

    ast.parse_files([str(LEFT_OUT)], take)
    return found


def _signature(found: ast.AST) -> Signature | None:
    """Return the signature of an atom, or of all atoms in a pool such as ``lit(hall;study)``, or None."""
    if found.ast_type != ast.ASTType.Literal or found.atom.ast_type != ast.ASTType.SymbolicAtom:
        return None
    symbol = found.atom.symbol
    one = symbol.arguments[0] if symbol.ast_type == ast.ASTType.Pool else symbol
    return (one.name, len(one.arguments)) if one.ast_type == ast.ASTType.Function else None


def _beginning(head: ast.AST) -> str:
    """Return the beginning of a fact up to its first argument, as in ``opens(hall``."""
    return str(head).partition(",")[0]


def _about(name: str, rule: ast.AST, conditions: Sequence[ast.AST]) -> ast.AST:
    """Return the rule with its head as a term of an atom with this name, under more conditions."""
    atom = ast.SymbolicAtom(ast.Function(HERE, name, [rule.head.atom.symbol], False))
    return rule.update(head=literal(atom), body=[*rule.body, *conditions])


@cache
def stated(number: int) -> ast.AST:
    """Return the condition of a statement by its number.

    It is cached, as a proof needs each a dozen times.
    """
    return atom_of(stated_symbol(number))


@cache
def free(number: int) -> ast.AST:
    """Return the rule by which this condition may hold or not."""
    choice = ast.ConditionalLiteral(HERE, literal(stated(number)), [])
    return ast.Rule(HERE, ast.Aggregate(HERE, None, [choice], None), [])


@cache
def stated_symbol(number: int) -> Symbol:
    """Return the condition as a symbol."""
    return Function("stated", [Number(number)])


def atom_of(symbol: Symbol) -> ast.AST:
    """Return a symbol as an atom in a rule."""
    terms = [ast.SymbolicTerm(HERE, argument) for argument in symbol.arguments]
    return ast.SymbolicAtom(ast.Function(HERE, symbol.name, terms, False))


def unbound(length: Symbol) -> Symbol:
    """Return the fact of an unknown length, whose numbers are least and greatest lengths in turn."""
    bounds = itertools.cycle([Number(0), Number(LONGEST_MM)])
    numbers = [a if a.type != SymbolType.Number else next(bounds) for a in length.arguments]
    return Function(length.name, numbers)


def literal(atom: ast.AST, sign: ast.Sign = ast.Sign.NoSign) -> ast.AST:
    """Return an atom, or its negation, as a literal in a rule."""
    return ast.Literal(HERE, sign, atom)
