"""Studies keep their measurements, during the run and after Ctrl-C."""

import csv
import json
from pathlib import Path

import pytest

from benchmarks.common.measure import study
from benchmarks.common.record import time_left

pytestmark = pytest.mark.second_part("each study is run in small")

STUDY = """
import pytest

@pytest.mark.parametrize("rooms", [1, 2, 4])
def test_house(benchmark, rooms):
    benchmark.extra_info["rooms"] = rooms
    benchmark.pedantic(lambda: None, rounds=3)
    if rooms == 4:
        raise KeyboardInterrupt

def test_other(benchmark):
    benchmark(int)
"""


def test_what_was_measured_before_ctrl_c_stays_and_its_page_says_that_it_is_partial(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Benchmarks measure nothing while tests run in parallel, which these tests may do.
    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)
    script, out = tmp_path / "test_tiny.py", tmp_path / "out"
    script.write_text(STUDY)

    def page(report: dict) -> str:
        return f"# Tiny\n{len(report['benchmarks'])} measured\n"

    with pytest.raises(KeyboardInterrupt):
        study(script, out, page, parts=["house"])
    report = json.loads((out / "tiny.json").read_text())
    assert [entry["extra_info"]["rooms"] for entry in report["benchmarks"]] == [1, 2]
    rows = list(csv.DictReader((out / "tiny.csv").open()))
    assert [(row["measurement"], row["axis"], row["size"], row["rounds"]) for row in rows] == [
        ("house", "rooms", "1", "3"),
        ("house", "rooms", "2", "3"),
    ]
    assert 0 < float(rows[0]["min"]) <= float(rows[0]["median"]) <= float(rows[0]["p95"])
    assert (out / "tiny.md").read_text() == "# Tiny\n\n**Partial: 2 of 3 measurements.**\n2 measured\n"
    assert (out / "tiny.png").stat().st_size

    script.write_text("raise KeyboardInterrupt")
    with pytest.raises(KeyboardInterrupt):
        study(script, out, page)
    assert json.loads((out / "tiny.json").read_text()) == report  # no measurement replaced it


def test_the_time_left_follows_sizes_of_the_same_measurement_and_else_the_mean() -> None:
    seconds, work = {"house": 3.0, "loading": 1.0}, {"house": 3.0, "loading": 5.0}
    assert time_left(seconds, work, [("house", 4.0), ("other", 2.0)]) == 4 * 1.0 + 2 * 0.5
