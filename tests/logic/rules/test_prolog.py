"""Tests of rules in Prolog: one case for each file of ``tests/logic/rules``."""

from pathlib import Path

import pytest

from tests.programs import finished

FILES = sorted(Path(__file__).parent.glob("*.plt"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_prolog(file: Path) -> None:
    done = finished(["swipl", "-g", "run_tests", "-t", "halt", file])
    # Choice points appear as warnings: a relation of the rules that leaves one slows every house down.
    assert done.returncode == 0, done.stderr
    assert "choicepoint" not in done.stderr
    assert "Warning" not in done.stderr, done.stderr


def test_there_are_files() -> None:
    assert len(FILES) >= 3
