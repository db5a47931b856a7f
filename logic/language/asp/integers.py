"""Whole numbers of .lp files: clingo's have 32 bits, and wrap around past the greatest."""

# clingo.ast leaves the attributes of its nodes untyped.
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from clingo import SymbolType
from clingo.ast import AST, ASTSequence, ASTType, BinaryOperator, UnaryOperator

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.language.asp.statements import Statement, error_at
from vitruvius.logic.layout.messages import written
from vitruvius.logic.layout.reading import children

LEAST, GREATEST = -(2**31), 2**31 - 1

MOST_DIGITS = 40
"""Number of digits above that of any number of 32 bits, in any base."""

_ARITHMETIC = re.compile(r"[+*]|(?<!:)-")
"""Operators of statements whose numbers can leave the range, which few other statements have."""

_LITERAL = re.compile(r"((?<![\w)])-\s*)?(?<![\w'])(0x[0-9a-fA-F]+|0o[0-7]+|0b[01]+|\d+)(?![\w'])")
"""A sign that is no subtraction, and a number."""


def too_large(code: str, file: Path) -> Iterator[GrammarError]:
    """Yield an error for each number that clingo misreads, in a file's text without comments and strings."""
    for found in _LITERAL.finditer(code):
        sign, number = found.groups()
        base = {"0x": 16, "0o": 8, "0b": 2}.get(number[:2], 10)
        # Python itself refuses to read thousands of digits.
        if len(number.lstrip("0")) > MOST_DIGITS or int(number, base) > GREATEST + bool(sign):
            lines = code[: found.start(2)].split("\n")
            why = f"{_short(number)}: a whole number is {GREATEST} at most"
            yield GrammarError(why, file, len(lines), len(lines[-1]) + 1)


def overflowing(statements: Iterable[Statement]) -> Iterator[GrammarError]:
    """Yield an error for each sum, product or power of known numbers that clingo computes wrong."""
    found = list(statements)
    constants = {
        each.node.name: each.node.value for each in found if each.node.ast_type == ASTType.Definition
    }
    for statement in found:
        if _ARITHMETIC.search(str(statement.node)):
            yield from _overflowing(statement.node, constants)


def _overflowing(node: Any, constants: Mapping[str, Any]) -> Iterator[GrammarError]:
    if isinstance(node, ASTSequence | list | tuple):
        for part in node:
            yield from _overflowing(part, constants)
    elif isinstance(node, AST):
        inner = [error for child in children(node) for error in _overflowing(child, constants)]
        yield from inner
        value = None if inner else _value(node, constants, frozenset())
        if value is not None and not LEAST <= value <= GREATEST:
            yield error_at(
                node, f"{written(node)} is {_short(str(value))}: a whole number is {GREATEST} at most"
            )


def _value(node: Any, constants: Mapping[str, Any], within: frozenset[str]) -> int | None:
    """Return the number that a term is, or None if it is none or unknown."""
    kind, value = node.ast_type, None
    if kind == ASTType.SymbolicTerm and node.symbol.type == SymbolType.Number:
        value = node.symbol.number
    elif kind in (ASTType.SymbolicTerm, ASTType.Function):
        name = str(node)
        if name in constants and name not in within:
            value = _value(constants[name], constants, within | {name})
    elif kind == ASTType.UnaryOperation:
        inner = _value(node.argument, constants, within)
        if inner is not None and node.operator_type == UnaryOperator.Minus:
            value = LEAST if inner == LEAST else -inner  # -2147483648 is read as minus 2147483648.
    elif kind == ASTType.BinaryOperation and node.operator_type in OPERATORS:
        left, right = (_value(each, constants, within) for each in (node.left, node.right))
        if left is not None and right is not None:
            value = OPERATORS[node.operator_type](left, right)
    return value


OPERATORS: dict[int, Callable[[int, int], int | None]] = {
    BinaryOperator.Plus: lambda left, right: left + right,
    BinaryOperator.Minus: lambda left, right: left - right,
    BinaryOperator.Multiplication: lambda left, right: left * right,
    BinaryOperator.Power: lambda left, right: left ** min(right, 64) if right >= 0 else None,
}
"""Operators whose results can leave the range."""


def _short(number: str) -> str:
    return number if len(number) <= 24 else f"{number[:20]}..."
