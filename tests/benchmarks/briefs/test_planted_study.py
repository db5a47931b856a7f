"""The study of briefs that known plans keep at their limits, with tiny numbers."""

import os
import signal
from pathlib import Path

import pytest
from msgspec.structs import replace

from benchmarks.briefs.at_limits import planted
from benchmarks.briefs.attempts import INTERRUPTED, Attempt, within
from benchmarks.briefs.planted import PLANTED, PlantedRow, PlantedStudy, row_of
from benchmarks.common.rows import read_rows, write_rows

pytestmark = pytest.mark.second_part("each study is run in small")


def test_a_study_repeats_no_answer_but_an_interrupted_one(tmp_path: Path) -> None:
    path = tmp_path / PLANTED
    assert PlantedStudy(briefs=2, houses=1, boxes=(2, 3), out=tmp_path).run() == 0
    first, second, grammar, plan = read_rows(path, PlantedRow)
    assert [first.of, second.of, grammar.of, plan.of] == [
        ("brief", 0), ("brief", 1), ("grammar", 0), ("plan", 0),
    ]  # fmt: skip
    marked = replace(first, seconds=999.0)
    write_rows(path, [marked, replace(second, said=INTERRUPTED), grammar])
    assert PlantedStudy(briefs=2, houses=1, boxes=(2, 3), out=tmp_path).run() == 0
    rows = read_rows(path, PlantedRow)
    assert rows[:2] == [marked, grammar]
    assert [(row.of, row.said) for row in rows[2:]] == [(second.of, "house"), (plan.of, "house")]


def killed() -> Attempt:
    os.kill(os.getpid(), signal.SIGTERM)
    raise AssertionError


def late() -> Attempt:
    while True:
        pass


def test_an_attempt_that_a_signal_ends_is_interrupted_and_one_without_end_reaches_its_limit() -> None:
    assert within(60, killed).limit == INTERRUPTED
    assert within(1, late).limit == "1 s of processor time"


def test_a_proof_is_false_and_so_is_a_house_that_breaks_a_line() -> None:
    entry = planted(0)
    proof = row_of(0, entry, Attempt(0.1, because=("brief: ...",)))
    house = row_of(0, entry, Attempt(0.1, houses=({"rooms": []},)))
    limit = row_of(0, entry, Attempt(0.1, limit="2 arrangements could not be decided"))
    assert [row.said for row in (proof, house, limit)] == ["false proof", "wrong house", "undecided"]
    assert [row.wrong for row in (proof, house, limit)] == [True, True, False]
