"""Processes of a study stay on one processor each, and their failures are recorded."""

import sys
from pathlib import Path

import pytest

from benchmarks.common.processes import Job, run_all

pytestmark = pytest.mark.second_part("each study is run in small")


def job(folder: Path, script: str) -> Job:
    return Job(folder.name, (sys.executable, "-c", script), folder)


def test_each_process_keeps_to_one_processor(tmp_path: Path) -> None:
    script = "import os; print(len(os.sched_getaffinity(0)), os.environ['OMP_NUM_THREADS'])"
    run_all([job(tmp_path / str(k), script) for k in range(3)], 2)
    assert [(tmp_path / str(k) / "log.txt").read_text() for k in range(3)] == ["1 1\n"] * 3


def test_a_failure_is_noted_until_the_next_try(tmp_path: Path) -> None:
    run_all([job(tmp_path / "a", "raise SystemExit('no good')"), job(tmp_path / "b", "")], 1)
    assert (tmp_path / "a" / "failed.txt").read_text() == "failed, exit code 1: no good"
    assert not (tmp_path / "b" / "failed.txt").exists()
    run_all([job(tmp_path / "a", "import os; os.abort()")], 1)
    assert (tmp_path / "a" / "failed.txt").read_text() == "failed, ended by signal 6"
    run_all([job(tmp_path / "a", "")], 1)
    assert not (tmp_path / "a" / "failed.txt").exists()
