"""Edits of rule files at the places that clingo and SWI-Prolog give for each part."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

from clingo.ast import AST, ASTType, Location, parse_string
from clingo.symbol import SymbolType

from vitruvius.logic.errors import MissingProgram

POSITIONS = Path(__file__).with_name("positions.pl")

TURNED = {
    b"<": ("<=", ">"),
    b"<=": ("<", ">="),
    b">": (">=", "<"),
    b">=": (">", "<="),
    b"=": ("!=",),
    b"!=": ("=",),
}
"""Replacements of each comparison of clingo: off by one, and reversed."""

SIGN = re.compile(rb"[<>!=]+")


def lp_edits(content: bytes) -> Iterator[tuple[str, int, int, str]]:
    """Yield the edits of an ``.lp`` file: a rule or a literal dropped, a comparison or a number changed."""
    starts, statements = [0], list[Any]()
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def place(location: Location) -> tuple[int, int]:
        begin, end = location.begin, location.end
        return starts[begin.line - 1] + begin.column - 1, starts[end.line - 1] + end.column - 1

    # An included file has its own mutants.
    text = content.replace(b"#include", b"%include")
    parse_string(text.decode(), statements.append)
    for statement in statements:
        if statement.ast_type is ASTType.Rule:
            yield "rule", *place(statement.location), ""
            for literal in statement.body:
                yield "literal", *place(literal.location), "#true"
        if statement.ast_type in (ASTType.Rule, ASTType.Minimize, ASTType.Definition):
            for node in _nodes(statement):
                if node.ast_type is ASTType.Comparison:
                    left = node.term
                    for guard in node.guards:
                        # Between two terms are the operator, spaces and parentheses.
                        begin, end = place(left.location)[1], place(guard.term.location)[0]
                        sign = SIGN.search(content, begin, end)
                        assert sign
                        for other in TURNED[sign.group()]:
                            yield "comparison", *sign.span(), other
                        left = guard.term
                elif node.ast_type is ASTType.SymbolicTerm and node.symbol.type is SymbolType.Number:
                    number = node.symbol.number
                    yield "number", *place(node.location), str(number + max(1, round(abs(number) / 100)))


def _nodes(node: Any) -> Iterator[Any]:
    """Yield a node and all below it."""
    yield node
    for value in node.values():
        for child in value if hasattr(value, "__iter__") and not isinstance(value, str) else [value]:
            if isinstance(child, AST):
                yield from _nodes(child)


def pl_edits(content: bytes) -> Iterator[tuple[str, int, int, str]]:
    """Yield the edits of a ``.pl`` file: a clause or a goal dropped, a comparison or a number changed."""
    with NamedTemporaryFile(suffix=".pl") as file:
        file.write(content)
        file.flush()
        command = ["swipl", "-g", "main", "-t", "halt(1)", str(POSITIONS), "--", file.name]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=True)
        except FileNotFoundError:
            raise MissingProgram("SWI-Prolog is not installed: see ./run") from None
    text = content.decode()
    for line in done.stdout.splitlines():
        operator, start, end, after = line.split("\t")
        yield operator, len(text[: int(start)].encode()), len(text[: int(end)].encode()), after
