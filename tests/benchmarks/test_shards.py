"""The study of sets under kills, in small."""

import json
from pathlib import Path

import pytest

from benchmarks.generator.shards import Shards

pytestmark = pytest.mark.second_part("each study is run in small")


def test_a_set_under_kills_is_compared_with_one_without(tmp_path: Path) -> None:
    study = Shards("family", rooms=1, houses=240, shards=12, workers=1, kills=2, seed=22, out=tmp_path)
    assert study.run() == 0
    figures = json.loads((tmp_path / "shards.json").read_text())
    assert (figures["houses"], figures["limits"], figures["same_bytes"]) == (240, 0, True)
    assert figures["kills"] == {"driver": 1, "worker": 1}
    assert "| same bytes | True |" in (tmp_path / "shards.md").read_text()
