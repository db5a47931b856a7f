"""The study of sets under kills, in small."""

import json
from pathlib import Path

from benchmarks.generator.shards import Shards


def test_a_set_under_kills_is_compared_with_one_without(tmp_path: Path) -> None:
    study = Shards("family", rooms=1, houses=24, shards=6, workers=1, kills=1, out=tmp_path)
    assert study.run() == 0
    figures = json.loads((tmp_path / "shards.json").read_text())
    assert (figures["houses"], figures["limits"], figures["same_bytes"]) == (24, 0, True)
    assert "| same bytes | True |" in (tmp_path / "shards.md").read_text()
