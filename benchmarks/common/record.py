"""Plugin of pytest that writes the results of pytest-benchmark as it runs, and prints the remaining time.

``pytest -p benchmarks.common.record --report FILE.json``: after each measurement, FILE.json is the report so
far, in the final form of pytest-benchmark, and FILE.csv has a line for each measurement. So a stopped study
keeps its measurements.
"""

import csv
import io
import json
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pytest

from benchmarks.common.pages import milliseconds
from benchmarks.common.processes import say
from benchmarks.common.series import axis_of, name_of
from vitruvius.logic.files.writing import write_whole

COLUMNS = ("measurement", "axis", "size", "rounds", "mean", "median", "q1", "q3", "p95", "min", "max")
"""Columns of the CSV file; the last seven are in seconds."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option for the report's file."""
    parser.addoption("--report", type=Path, required=True)


def pytest_configure(config: pytest.Config) -> None:
    """Record the measurements of this run."""
    config.pluginmanager.register(ReportRecorder(config))


class ReportRecorder:
    """Recorder of measurements and their times."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.file: Path = config.getoption("report")  # pyright: ignore[reportAttributeAccessIssue]
        self.machine: Any = None
        self.last = monotonic()
        self.left: dict[str, tuple[str, float]] = {}
        self.seconds, self.work = defaultdict[str, float](float), defaultdict[str, float](float)

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Count the measurements, and start the clock."""
        self.left = {item.nodeid: _work(item) for item in session.items}
        self.last, self.count = monotonic(), len(self.left)

    @pytest.hookimpl(tryfirst=True)
    def pytest_report_teststatus(self, report: pytest.TestReport) -> tuple[str, str, str] | None:
        """Print no dot, because a line says more."""
        return ("passed" if report.when == "call" else "", "", "") if report.passed else None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Write the measurements so far, and print the progress."""
        if report.when != "call":
            return
        now = monotonic()
        kind, work = self.left.pop(report.nodeid)
        self.seconds[kind] += now - self.last
        self.work[kind] += work
        self.last = now
        if report.passed:
            entry = self.write()
            took = f"{milliseconds(entry['stats']['median'])} ms"
            done = f"{self.count - len(self.left)} of {self.count}"
            left = time_left(self.seconds, self.work, self.left.values())
            say(f"{entry['name'].removeprefix('test_')}: {took}, {done}, about {left:.0f} s left")

    def write(self) -> dict[str, Any]:
        """Write the report and the CSV file. Return the last measurement."""
        session: Any = self.config._benchmarksession  # pyright: ignore[reportAttributeAccessIssue]
        self.machine = self.machine or session.get_machine_info()
        report = self.config.hook.pytest_benchmark_generate_json(
            config=self.config,
            benchmarks=session.benchmarks,
            include_data=True,
            machine_info=self.machine,
            commit_info=None,
        )
        report["measured"], report["of"] = len(report["benchmarks"]), self.count
        write_whole(self.file, json.dumps(report, indent=1, default=str).encode())
        write_whole(self.file.with_suffix(".csv"), table(report).encode())
        return report["benchmarks"][-1]


def time_left(
    seconds: Mapping[str, float], work: Mapping[str, float], left: Iterable[tuple[str, float]]
) -> float:
    """Return the seconds for the remaining work, each kind at its own rate, or at that of all kinds."""
    mean = sum(seconds.values()) / sum(work.values())
    rate = {kind: seconds[kind] / work[kind] for kind in work}
    return sum(more * rate.get(kind, mean) for kind, more in left)


def table(report: dict[str, Any]) -> str:
    """Return a report as CSV, a line for each measurement."""
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(COLUMNS)
    for entry in report["benchmarks"]:
        axis, stats = axis_of(entry) or "", entry["stats"]
        found = stats | {"p95": float(np.percentile(stats["data"], 95))}
        size = entry["extra_info"].get(axis, "")
        lines.writerow([name_of(entry), axis, size, *(found[column] for column in COLUMNS[3:])])
    return text.getvalue()


def _work(item: pytest.Item) -> tuple[str, float]:
    """Return a measurement's name and its amount of work: the number of its size parameter."""
    parameters = getattr(item, "callspec", None)
    sizes = [each for each in parameters.params.values() if isinstance(each, int)] if parameters else []
    return item.name.partition("[")[0], float(max(sizes, default=1))
