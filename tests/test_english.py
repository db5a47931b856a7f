"""Docstrings begin as NumPy's do: functions with a verb, everything else with a noun phrase."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

FOLDERS = ("logic", "sim", "agent", "vitruvius", "benchmarks", "examples", "docs", "tests")

CLAUSE = re.compile(r"(What|Whether|Where|Which|Who|How|Of|That|If|Why|When|So many|All that)\b")
"""Opening of a docstring that is a clause or a fragment of one."""


def docstrings(file: Path) -> Iterator[tuple[int, str]]:
    """Yield the line and text of each docstring: of modules, classes, functions, constants and fields."""
    for node in ast.walk(ast.parse(file.read_text())):
        for statement in getattr(node, "body", ()) if not isinstance(node, ast.Lambda | ast.IfExp) else ():
            value = statement.value if isinstance(statement, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield statement.lineno, value.value


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_docstring_opens_with_a_clause(folder: str) -> None:
    found = [
        f"{file.relative_to(ROOT)}:{line}: {text.partition(chr(10))[0]}"
        for file in sorted((ROOT / folder).rglob("*.py"))
        for line, text in docstrings(file)
        if CLAUSE.match(text)
    ]
    assert found == []
