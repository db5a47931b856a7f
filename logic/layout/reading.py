"""Reader of rule files by clingo, each by itself, since clingo must not follow a grammar's includes."""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from itertools import groupby
from pathlib import Path
from typing import Any

from clingo import Control, MessageCode
from clingo.ast import (
    AST,
    ASTSequence,
    ASTType,
    Location,
    Position,
    ProgramBuilder,
    parse_files,
    parse_string,
)

from vitruvius.logic.grammar import RULES, TYPICAL, Places
from vitruvius.logic.includes import below, height

Logger = Callable[[MessageCode, str], None]

MESSAGES = 1000
"""Largest number of remarks that are passed on."""


def parse(
    files: Sequence[Path],
    take: Callable[[AST], None],
    logger: Logger = lambda *_: None,
    left_out: Places = frozenset(),
) -> None:
    """Pass the statements of these files to ``take``, in order, except the typical rules at ``left_out``.

    Raises ``RuntimeError`` as ``parse_files`` does.
    """
    take = _without(left_out, take) if left_out else take
    for includes, some in groupby(files, _includes):
        if not includes:
            parse_files([str(file) for file in some], take, logger=logger, message_limit=MESSAGES)
            continue
        for file in some:
            _parse(file, take, logger)


def load(control: Control, files: Sequence[Path], logger: Logger, left_out: Places = frozenset()) -> None:
    """Load these files without the typical rules at ``left_out``."""
    changed = {file for file, *_ in left_out}
    for file in files:
        if not (_includes(file) or str(file) in changed):
            control.load(str(file))
            continue
        with ProgramBuilder(control) as builder:
            _parse(file, _without(left_out, builder.add), logger)


def _without(left_out: Places, take: Callable[[AST], None]) -> Callable[[AST], None]:
    """Return a function that passes statements to ``take``, except the typical rules at ``left_out``."""
    program = ""

    def taken(statement: AST) -> None:
        nonlocal program
        if statement.ast_type == ASTType.Program:
            program = statement.name
        begin = statement.location.begin
        is_rule = statement.ast_type == ASTType.Rule and program == TYPICAL
        if not (is_rule and (begin.filename, begin.line, begin.column) in left_out):
            take(statement)

    return taken


def _includes(file: Path) -> bool:
    """Return True if a grammar's file has includes. clingo itself follows those of the core."""
    return RULES not in file.parents and height(_text(file), file.suffix) > 0


def _text(file: Path) -> str:
    return file.read_text("utf-8", "replace")


def _parse(file: Path, take: Callable[[AST], None], logger: Logger) -> None:
    """Pass on the statements below a file's includes."""
    statements, remarks, error = _statements(str(file), below(_text(file), file.suffix))
    for code, remark in remarks:
        logger(code, remark)
    if error:
        raise error
    for statement in statements:
        take(statement)


@lru_cache
def _statements(file: str, text: str) -> tuple[list[AST], list[tuple[MessageCode, str]], RuntimeError | None]:
    """Return the statements of a text with their places in this file, clingo's remarks, and a final error.

    They are cached, because a process makes a dozen programs of the same text.
    """
    found: list[AST] = []
    remarks: list[tuple[MessageCode, str]] = []

    def remark(code: MessageCode, said: str) -> None:
        remarks.append((code, said.replace("<string>:", f"{file}:")))

    try:
        parse_string(text, found.append, logger=remark, message_limit=MESSAGES)
    except RuntimeError as error:
        return found, remarks, error
    for statement in found:
        _place(statement, file)
    return found, remarks, None


def _place(node: AST, file: str) -> None:
    """Set the file of a statement and of all its parts."""
    if "location" in node.keys():  # noqa: SIM118 (a node is no mapping)
        begin, end = node.location.begin, node.location.end
        node.location = Location(
            Position(file, begin.line, begin.column), Position(file, end.line, end.column)
        )
    for child in children(node):
        for part in child if isinstance(child, ASTSequence) else [child]:
            if isinstance(part, AST):
                _place(part, file)


def children(node: AST) -> Iterator[Any]:
    """Return the children of a node: nodes, sequences of nodes, or None for absent ones."""
    kind = node.ast_type
    if kind not in _CHILDREN:
        _CHILDREN[kind] = node.child_keys
    return (getattr(node, key) for key in _CHILDREN[kind])


_CHILDREN: dict[ASTType, list[str]] = {}
"""Names of the children of each kind of node, cached since asking each node takes longer than reading it."""
