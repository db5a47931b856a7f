"""Statements of ``.lp`` files, each with its ``#program``."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from clingo.ast import ASTType

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.grammar import TYPICAL
from vitruvius.logic.layout.messages import clingo_error
from vitruvius.logic.layout.reading import parse


class Statement(NamedTuple):
    """Node of clingo's syntax tree and the name of its program."""

    node: Any
    program: str

    def error(self, text: str) -> GrammarError:
        """Return an error at this statement."""
        return error_at(self.node, text)


def read(files: Sequence[Path]) -> list[Statement]:
    """Return all statements of these files and of included files, in order. Typical ones belong to the house.

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
    """Return the file, line and column at which a node begins."""
    begin = node.location.begin
    return begin.filename, begin.line, begin.column


def error_at(node: Any, text: str) -> GrammarError:
    """Return an error at a node's place."""
    return GrammarError(text, *place(node))
