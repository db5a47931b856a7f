"""The study of speed, in small."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from benchmarks.speed.run import HEAD, Speed, SpeedRow, row
from benchmarks.speed.worker import PARTS, measured
from vitruvius.agent.runs.checkpoint import CheckpointError
from vitruvius.logic.errors import RequestError

pytestmark = pytest.mark.second_part("each study is run in small")


@pytest.mark.parametrize("part", PARTS)
def test_each_part_of_the_work_makes_steps(part: str) -> None:
    of = {"play": "explorer", "train": "pqn"}.get(part, "continuous")
    found = measured(PARTS[part](of, "cpu", 2), "cpu", 1e-4)
    assert found["steps"] % 2 == 0
    assert min(found.values()) > 0


@pytest.mark.skipif(len(os.sched_getaffinity(0)) < 2, reason="one core")
def test_processes_that_train_as_ranks_of_one_run_are_timed(tmp_path: Path, capsys) -> None:
    study = Speed(
        ("train",), environments=(2,), processes=(2,), seconds=0.01, rounds=1, out=tmp_path / "speed"
    )
    study.run()
    page = (study.out / "speed.md").read_text()
    assert capsys.readouterr().out.strip() == page.strip()
    [line] = page.split(HEAD)[1].strip().splitlines()
    assert line.startswith("| train | pqn | cpu | 2 | 2 | ")
    record = json.loads((study.out / "speed.json").read_text())
    assert [each["processes"] for each in record] == [2]


def test_processes_are_compared_with_one_within_each_round() -> None:
    found = {
        SpeedRow("step", "free", "cpu", 4, count): [
            {"steps": steps * count, "seconds": 1.0, "processor_seconds": count} for steps in each
        ]
        for count, each in ((1, (10, 40, 20)), (2, (5, 40, 40)))
    }
    assert row(SpeedRow("step", "free", "cpu", 4, 2), found)[5:7] == ["80 (10 to 80)", "1.00 (0.50 to 2.00)"]


@pytest.mark.parametrize(
    ("wrong", "error", "says"),
    [
        ({"rounds": 0}, RequestError, "--rounds"),
        ({"seconds": 0}, RequestError, "--seconds"),
        ({"processes": (4096,)}, RequestError, "--processes x --cores is 4096"),
        ({"preset": ("pqm",)}, RequestError, "--preset pqm: none of"),
        ({"preset": ("dqn",), "processes": (2,), "cores": 1}, RequestError, "--preset dqn|is 2"),
        ({"agent": ("explorers",)}, CheckpointError, "there is no agent explorers"),
    ],
)
def test_a_speed_that_cannot_be_measured_is_refused(
    wrong: Any, error: Any, says: str, tmp_path: Path
) -> None:
    with pytest.raises(error, match=says):
        Speed(**{"out": tmp_path, **wrong}).run()
