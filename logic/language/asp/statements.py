"""The statements of ``.lp`` files, each with the ``#program`` that it belongs to."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from clingo.ast import ASTType

from logic.errors import GrammarError
from logic.grammar import TYPICAL
from logic.layout.messages import clingo_error
from logic.layout.reading import parse


class Statement(NamedTuple):
    """A node of clingo's syntax tree and the program's name."""

    node: Any
    program: str

    def error(self, text: str) -> GrammarError:
        """Something wrong with this statement."""
        return error_at(self.node, text)


def read(files: Sequence[Path]) -> list[Statement]:
    """Return all statements of these files and of included files, in order; typical ones are of the house.

    Raises ``GrammarError`` for the first syntax error.
    """
    found: list[Statement] = []
    remarks: list[str] = []
    program = "base"

    def take(node: Any) -> None:
        nonlocal program
        if node.ast_type == ASTType.Program:
            program = "house" if node.name == TYPICAL else node.name
        found.append(Statement(node, program))

    try:
        parse(files, take, lambda _, text: remarks.append(text))
    except RuntimeError as error:
        raise clingo_error(remarks, str(error)) from None
    return sorted(found, key=lambda each: place(each.node))


def place(node: Any) -> tuple[str, int, int]:
    """File, line and column at which a node begins."""
    begin = node.location.begin
    return begin.filename, begin.line, begin.column


def error_at(node: Any, text: str) -> GrammarError:
    """Something wrong with what stands at a node's place."""
    return GrammarError(text, *place(node))
