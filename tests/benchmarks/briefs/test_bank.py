"""The frozen briefs, the reading of briefs from plans, and their study, with tiny numbers."""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from benchmarks.briefs import bank
from benchmarks.briefs.attempts import Attempt
from benchmarks.briefs.bank import frozen, save_entries
from benchmarks.briefs.boxes import area, around, cover
from benchmarks.briefs.make import IMPOSSIBLE, REASONS, BriefEntry, proven, read_off
from benchmarks.briefs.plans import dissected, of_dissection
from benchmarks.briefs.proofs import needed
from benchmarks.briefs.run import BriefStudy
from vitruvius.logic import HouseFileError
from vitruvius.logic.request.brief import Brief, BriefRoom
from vitruvius.logic.request.brief_lines import requirements

pytestmark = pytest.mark.second_part("each study is run in small")


def test_the_bank_is_five_hundred_briefs_that_can_be_read_each_with_its_name() -> None:
    entries = frozen()
    assert len(entries) == len({entry.name for entry in entries}) == 500
    assert all(entry.read.names for entry in entries)
    answers = Counter((entry.kind, entry.answer) for entry in entries)
    assert {kind for kind, answer in answers if answer == "house"} == {"house", "dissection"}
    assert answers["impossible", "impossible"] == len(REASONS) * sum(IMPOSSIBLE.values())


def test_a_bank_with_another_brief_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries = frozen()
    monkeypatch.setattr(bank, "FILE", tmp_path / "bank.jsonl.gz")
    assert save_entries(entries, bank.FILE) == bank.HASH
    frozen()
    save_entries(entries[1:], bank.FILE)
    with pytest.raises(HouseFileError, match="not the held-out set"):
        frozen()


def test_random_dissections_tile_their_box_and_some_have_no_cut_from_side_to_side() -> None:
    rng, uncut = np.random.default_rng(0), 0
    whole = (0.0, 0.0, 12.0, 10.0)
    for _ in range(30):
        boxes = dissected(whole, 7, rng)
        if boxes is None:
            continue
        assert len(boxes) == 7
        assert around(boxes) == whole
        assert sum(map(area, boxes)) == pytest.approx(area(whole))
        assert not any(cover(one, other) for place, one in enumerate(boxes) for other in boxes[:place])
        cuts = [
            at
            for axis in (0, 1)
            for at in {box[axis] for box in boxes} - {whole[axis]}
            if not any(box[axis] < at < box[axis + 2] for box in boxes)
        ]
        uncut += not cuts
    assert uncut


def test_a_plan_keeps_each_line_of_a_brief_that_is_read_off_it() -> None:
    rng = np.random.default_rng(1)
    for rooms in (5, 9, 13):
        plan = of_dissection(rooms, rng)
        proven(BriefEntry("one", "dissection", "", read_off(plan, rng)), plan)
        other = of_dissection(rooms, rng)
        with pytest.raises(ValueError, match="one: "):
            proven(BriefEntry("one", "dissection", "", read_off(other, rng)), plan)


def test_of_a_proof_those_lines_are_needed_without_which_the_others_have_a_house() -> None:
    brief = Brief(tuple(BriefRoom(name, area=9.0) for name in "abc"), doors=(("a", "b"), ("b", "c")))
    because = [f"brief: {each.words}" for each in requirements(brief)][:3]  # areas
    asked = []

    def tried(fewer: Brief) -> Attempt:
        asked.append([room.name for room in fewer.rooms if room.area])
        assert not fewer.doors
        return [Attempt(1.0, houses=({},)), Attempt(1.0, because=()), Attempt(1.0, limit="late")][
            len(asked) - 1
        ]

    assert needed(brief, [*because, "door_width(0.8)."], tried) == (3, 1, 1)
    assert asked == [["b", "c"], ["a", "c"], ["a", "b"]]


def test_the_study_answers_scores_and_writes_its_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    some = {"kinds": ("dissection", "impossible"), "rooms": (5,), "each": 1}
    peer = f"cat {tmp_path / 'brief-answers.jsonl'}"  # our answers so far
    BriefStudy(**some, out=tmp_path, peer=peer).run()
    assert "Of 1 proofs 1 (100 %) are minimal" in (tmp_path / "brief-bank.md").read_text()
    record = json.loads((tmp_path / "brief.json").read_text())
    assert record["score"]["right"] == 1.0
    assert [len(each) for each in (record["attempts"], record["proofs"], record["peer"])] == [2, 1, 2]
    capsys.readouterr()
    BriefStudy(**some, answers=tmp_path / "brief-answers.jsonl").run()
    assert json.loads(capsys.readouterr().out)["right"] == 1.0
    BriefStudy(**some, briefs=tmp_path / "briefs.jsonl").run()
    told = [json.loads(line) for line in (tmp_path / "briefs.jsonl").read_text().splitlines()]
    assert [each["name"] for each in told] == ["dissection-5-00", "impossible-5-00"]
