"""The study of mutants: its changes, its trials, and its continuation after a stop."""

import json
import shutil
from pathlib import Path

import pytest

from benchmarks.reliability import mutant_tests, trial
from benchmarks.reliability import mutants as study
from benchmarks.reliability.changes import Mutant, mutants
from benchmarks.reliability.mutant_tests import MutantRow
from benchmarks.reliability.mutants import Mutants

pytestmark = pytest.mark.second_part("each study is run in small")

PYTHON = '''"""A module."""

LEAST: float = 2.0


def fits(length: float, shown: bool = True) -> bool:
    """Return True if it fits."""
    if not shown and length != 7:
        note(f"{length + 1}")
    return LEAST <= length - 1
'''

LP = """% 5 is no number of the rules.
room(1..3).
:- room(R), not door(R), R < 2.
"""

PL = """% 5 is no number of the rules.
:- use_module(library(clpr)).
fits(X, Y) :- { X + 2.0 =< Y }, !, \\+ wide(X).
wide(7).
"""


def changes(folder: Path, name: str, content: str) -> set[tuple[int, str, str, str]]:
    (folder / name).write_text(content)
    return {(each.line, each.operator, each.before, each.after) for each in mutants(folder, name)}


def test_mutants_of_python_change_all_that_runs_and_no_text(tmp_path: Path) -> None:
    assert changes(tmp_path, "a.py", PYTHON) == {
        (3, "constant", "2.0", "2.02"),
        (6, "constant", "True", "False"),
        (8, "statement", 'if not shown and length != 7:\n        note(f"{length + 1}")', "pass"),
        (8, "condition", "not shown and length != 7", "(not (not shown and length != 7))"),
        (8, "and/or", "not shown and length != 7", "(not shown or length != 7)"),
        (8, "comparison", "length != 7", "(length == 7)"),
        (8, "constant", "7", "8"),
        (9, "statement", 'note(f"{length + 1}")', "pass"),
        (10, "return", "return LEAST <= length - 1", "return not (LEAST <= length - 1)"),
        (10, "comparison", "LEAST <= length - 1", "(LEAST < length - 1)"),
        (10, "comparison", "LEAST <= length - 1", "(LEAST >= length - 1)"),
        (10, "operands", "length - 1", "(1 - length)"),
        (10, "constant", "1", "2"),
    }
    assert ("constant", "1") not in {each[1:3] for each in changes(tmp_path, "b.py", "a.reshape(-1, 4)\n")}
    assert changes(tmp_path, "kernel.py", "@ti.func\ndef f(x):\n    return x + 1\n") == set()


def test_mutants_of_rules_lose_a_rule_or_a_literal_or_have_another_comparison_or_number(
    tmp_path: Path,
) -> None:
    assert changes(tmp_path, "a.lp", LP) == {
        (2, "rule", "room(1..3).", ""),
        (2, "number", "1", "2"),
        (2, "number", "3", "4"),
        (3, "rule", ":- room(R), not door(R), R < 2.", ""),
        (3, "literal", "room(R)", "#true"),
        (3, "literal", "not door(R)", "#true"),
        (3, "literal", "R < 2", "#true"),
        (3, "comparison", "<", "<="),
        (3, "comparison", "<", ">"),
        (3, "number", "2", "3"),
    }
    assert changes(tmp_path, "a.pl", PL) == {
        (3, "clause", "fits(X, Y) :- { X + 2.0 =< Y }, !, \\+ wide(X).", ""),
        (3, "goal", "{ X + 2.0 =< Y }", "true"),
        (3, "number", "2.0", "2.02"),
        (3, "comparison", "=<", "<"),
        (3, "comparison", "=<", ">="),
        (3, "goal", "\\+ wide(X)", "true"),
        (4, "clause", "wide(7).", ""),
        (4, "number", "7", "8"),
    }


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a tiny checkout of two functions, with tests that notice mistakes in one function alone."""
    root = tmp_path / "checkout"
    files = {
        "pyproject.toml": "[tool.pytest.ini_options]\naddopts = '--import-mode=importlib'\n",
        "logic/__init__.py": "",
        "vitruvius/__init__.py": "",
        "logic/lengths.py": (
            "ONE = 1\n\n\ndef twice(x):\n    return x * 2\n\n\ndef less(x):\n    return x - ONE\n"
        ),
        "benchmarks/__init__.py": "",
        "benchmarks/reliability/__init__.py": "",
        "tests/test_lengths.py": (
            "from vitruvius.logic.lengths import less, twice\n\n\n"
            "def test_twice():\n    assert twice(3) == 6\n\n\n"
            "def test_less():\n    less(3)\n"
        ),
    }
    for name, content in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(content)
    (root / "vitruvius" / "logic").symlink_to("../logic")
    shutil.copy(Path(trial.__file__), root / "benchmarks" / "reliability")
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setattr(study, "ROOT", root)
    monkeypatch.setattr(study, "KINDS", {"tiny": ("logic/*.py",)})
    monkeypatch.setattr(mutant_tests, "ROOT", root)
    monkeypatch.setattr(mutant_tests, "BELONGING", {"logic/*": ("test_lengths.py",)})
    return root


def test_a_study_tries_no_mutant_twice_though_lines_move_above_it(
    checkout: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    again = Mutants(kinds=("tiny",), each=9, out=tmp_path)
    again.run()
    lines = (tmp_path / "rows.jsonl").read_text().splitlines()
    assert {row["mutant"]["code"]: row["by"] for row in map(json.loads, lines)} == {
        "ONE = 1": "",
        "return x * 2": "tests/test_lengths.py::test_twice",
        "return x - ONE": "",
    }
    assert (checkout / "logic" / "lengths.py").read_text().startswith("ONE = 1\n")
    assert "| tiny | 3 | 1 | 33% (6% to 79%) | 0 | 2 |" in capsys.readouterr().out
    (tmp_path / "rows.jsonl").write_text("\n".join(lines[:2]))
    file = checkout / "logic" / "lengths.py"
    file.write_text(f'"""A module."""\n\n{file.read_text()}')
    study.sample.cache_clear()
    tried = []

    class Noted:
        def __init__(self, *_: object) -> None: ...
        def close(self) -> None: ...
        def tried(self, kind: str, mutant: Mutant, _: float) -> MutantRow:
            tried.append(mutant.code)
            return MutantRow(kind=kind, mutant=mutant)

    monkeypatch.setattr(study, "MutantTests", Noted)
    again.run()
    assert tried == [json.loads(lines[2])["mutant"]["code"]]
    rows = map(json.loads, (tmp_path / "rows.jsonl").read_text().splitlines())
    assert {row["mutant"]["line"] for row in rows} == {3, 7, 11}
