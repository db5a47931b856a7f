"""What may stand in a grammar's .lp files: rules whose layouts can be sampled by picks, and no code."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from clingo.ast import ASTType, parse_files

from logic.errors import GrammarError
from logic.messages import clingo_error

CHOICES = {ASTType.Aggregate, ASTType.HeadAggregate, ASTType.Disjunction, ASTType.TheoryAtom}


def audit(files: Sequence[Path]) -> list[GrammarError]:
    """What would be passed over, or would choose past the picks (``rules/pick.lp``), each by its place."""
    objections = [error for file in files for error in _other_letters(file)]
    if objections:
        return objections
    remarks: list[str] = []
    part = "base"

    def judge(statement: Any) -> None:
        nonlocal part
        if statement.ast_type == ASTType.Program:
            part = statement.name
        elif why := _objection(statement, part):
            begin = statement.location.begin
            objections.append(GrammarError(why, begin.filename, begin.line, begin.column))

    try:
        parse_files([str(file) for file in files], judge, logger=lambda _, text: remarks.append(text))
    except RuntimeError as error:
        return [clingo_error(remarks, str(error))]
    return objections


def _objection(statement: Any, part: str) -> str:
    if statement.ast_type == ASTType.External:
        return "a grammar holds rules: what is #external holds in no house"
    if statement.ast_type == ASTType.Script:
        return "a grammar holds rules, no scripts"
    if statement.ast_type == ASTType.Minimize:
        return "layouts are sampled, not optimised: use weight/2 or a constraint"
    if statement.ast_type == ASTType.Rule:
        if statement.head.ast_type in CHOICES:
            return "a choice is made by option/3, as in option(colour,(red;blue),1): see rules/pick.lp"
        if part == "base" and str(statement.head) == "#false":
            return "say which stage this binds: put #program house. or #program room. before it"
    return ""


def _other_letters(file: Path) -> Iterator[GrammarError]:
    """Other letters than plain ones, outside of comments and strings, end clingo without a word."""
    try:
        text = file.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        yield GrammarError(f"not UTF-8: {error.reason}", file)
        return
    for number, line in enumerate(text.split("\n"), start=1):
        code = re.sub(r'"[^"]*"|%.*', lambda found: " " * len(found[0]), line)
        for column, letter in enumerate(code, start=1):
            if not letter.isascii():
                yield GrammarError(f"{letter}: names are of plain letters", file, number, column)
