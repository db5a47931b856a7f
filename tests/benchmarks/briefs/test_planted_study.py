"""The study of briefs that known plans keep at their limits, with tiny numbers."""

from pathlib import Path

import msgspec

from benchmarks.briefs.attempts import Attempt
from benchmarks.briefs.planted import PLANTED, PlantedRow, PlantedStudy, planted, row_of


def test_a_study_that_was_killed_goes_on_where_it_ended(tmp_path: Path) -> None:
    path = tmp_path / PLANTED
    assert PlantedStudy(briefs=2, houses=0, boxes=(2, 3), out=tmp_path).run() == 0
    first, second = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(first + second[:20])
    assert PlantedStudy(briefs=3, houses=1, boxes=(2, 3), out=tmp_path).run() == 0
    rows = path.read_bytes().splitlines(keepends=True)
    assert rows[0] == first
    answers = [msgspec.json.decode(row, type=PlantedRow) for row in rows]
    assert [answer.number for answer in answers] == [0, 1, 2, 0, 0]
    assert [answer.kind for answer in answers[3:]] == ["grammar", "plan"]


def test_a_proof_is_false_and_so_is_a_house_that_breaks_a_line() -> None:
    entry = planted(0)
    proof = row_of(0, entry, Attempt(0.1, because=("brief: ...",)))
    house = row_of(0, entry, Attempt(0.1, houses=({"rooms": []},)))
    limit = row_of(0, entry, Attempt(0.1, limit="2 arrangements could not be decided"))
    assert [row.said for row in (proof, house, limit)] == ["false proof", "wrong house", "undecided"]
    assert [row.wrong for row in (proof, house, limit)] == [True, True, False]
