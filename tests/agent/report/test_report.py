"""A report has everything in its folder, and prints one line if there is nothing to report."""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import msgspec
import numpy as np
import pytest

from benchmarks import SECTIONS
from tests.agent.evaluation.cases import result, scores
from tests.agent.report.conftest import HOUSE
from tests.benchmarks.reports import report as timed
from tests.benchmarks.reports import simulator_report
from vitruvius.agent.banks import bank_hash, benchmark
from vitruvius.agent.evaluation.scores import ScoredBank, ScoreFile, modes_of
from vitruvius.agent.recording import trace
from vitruvius.agent.recording.trace import Trace, TraceError
from vitruvius.agent.report import plans
from vitruvius.agent.report.folder import describe, report, write_report
from vitruvius.agent.report.html import ReportError
from vitruvius.agent.report.measured import section as measured_section
from vitruvius.agent.report.plots import Axis, DataSeries, line_plot, some
from vitruvius.commands.report import Report
from vitruvius.logic import House, HouseFileError, save

LINE = {
    "steps": 1000,
    "seconds": 2.0,
    "fraction": 0.5,
    "targets": 7.5,
    "loss": 0.01,
    "epsilon": 0.1,
    "overruled": 0.05,
    "simulator": 1e6,
    "learner": 2e4,
}


def metrics(folder: Path, *lines: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "metrics.jsonl").write_text("\n".join(lines))


def measured(folder: Path, houses: Sequence[House] = ()) -> None:
    """Write scores in two houses: these, or houses that nobody has."""
    one = result(scores([5, 8]), others={"explorer": scores([6, 10])})
    bank = ScoredBank(bank_hash(houses) if houses else "abc", "b.jsonl", 2)
    (folder / "evaluation.json").write_bytes(ScoreFile(bank, 0, modes_of([one])).json())


@pytest.fixture
def run(tmp_path, mapped) -> Path:
    """Return a folder with files of every kind."""
    metrics(tmp_path / "training", json.dumps(LINE), json.dumps(LINE | {"steps": 2000, "fraction": 1.0}))
    measured(tmp_path)
    save([HOUSE, HOUSE], tmp_path / "houses.jsonl")
    trace.save(mapped, tmp_path / "e.trace.json")
    (tmp_path / "generator.json").write_text(json.dumps(timed()))
    (tmp_path / "simulator.json").write_text(json.dumps(simulator_report()))
    (tmp_path / "homes.json").write_text('[{"rooms": 4, "unfurnished": [0.1, 0.2], "whole": [0.3, 0.4]}]')
    describe(tmp_path, "A <run>", "It was **good**: `x < y`.")
    return tmp_path


class Outline(HTMLParser):
    """Sections of a page; creation fails if an element is not closed."""

    VOID = frozenset({"meta", "input", "link", "br"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open, self.sections, self.text = list[str](), list[str](), ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        if tag == "section":
            self.sections.append(dict(attrs)["id"] or "")
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def test_a_report_has_a_section_for_each_kind_of_file(run) -> None:
    outline = Outline(report(run, SECTIONS).decode())
    assert outline.sections == ["episodes", "evaluation", "learning", "scaling", "homes", "plans", "about"]
    assert "A <run>" in outline.text
    assert "x < y" in outline.text
    for said in (
        "0.50",
        "2,000",
        "finished",
        "time ~ size",
        "2 houses in 1 file",
        "Targets in secondary rooms",
    ):
        assert said in outline.text


def test_the_same_run_gives_the_same_bytes_wherever_it_is_and_again_with_its_report_in_it(
    run, tmp_path
) -> None:
    first = report(run, SECTIONS)
    assert write_report(run, studies=SECTIONS) == run / "report.html"
    assert report(run, SECTIONS) == first == (run / "report.html").read_bytes()
    moved = run.rename(tmp_path.parent / "elsewhere")
    assert report(moved, SECTIONS) == first


def test_a_report_names_no_other_place(run) -> None:
    text = report(run, SECTIONS).decode()
    assert not re.findall(r'(?:src|href)="(?!#)', text)
    assert set(re.findall(r"https?://[^\s\"'<]+", text)) <= {"http://www.w3.org/2000/svg"}
    assert "default-src 'none'" in text


def test_of_an_interrupted_training_there_is_what_there_is(tmp_path) -> None:
    metrics(tmp_path, json.dumps(LINE), '{"steps": 20')
    (tmp_path / "config.json").write_text('{"preset": "pqn", "algorithm": "pqn", "config": {"steps": 2000}}')
    assert (
        "stopped at 50%: vitruvius train --resume continues it"
        in Outline(report(tmp_path, SECTIONS).decode()).text
    )
    (tmp_path / "metrics.jsonl").unlink()
    assert "no report yet" in Outline(report(tmp_path, SECTIONS).decode()).text


def test_names_from_files_are_text_in_a_report(run, mapped) -> None:
    evil = "</script><script>alert(1)</script>"
    record = msgspec.to_builtins(mapped) | {"agent": evil}
    trace.save(msgspec.convert(record, Trace), run / "e.trace.json")
    (run / "training" / "config.json").write_text(json.dumps({"preset": evil, "config": {evil: evil}}))
    text = report(run, SECTIONS).decode()
    Outline(text)
    assert text.count("<script>") == 1
    assert "alert(1)" in text


def _no_run(folder: Path) -> Path:
    (folder / "notes.txt").write_text("mine")
    return folder


def _file(folder: Path) -> Path:
    (folder / "x").write_text("mine")
    return folder / "x"


def _newer_trace(folder: Path) -> Path:
    (folder / "x.trace.json").write_text('{"format": "vitruvius-trace-9"}')
    return folder


def _torn_houses(folder: Path) -> Path:
    save([HOUSE, HOUSE], folder / "houses.jsonl")
    content = (folder / "houses.jsonl").read_bytes()
    (folder / "houses.jsonl").write_bytes(content[: len(content) - 40])
    return folder


def _other(name: str, content: str = "[]"):
    def make(folder: Path) -> Path:
        (folder / name).write_text(content)
        return folder

    return make


@pytest.mark.parametrize(
    ("make", "error", "says"),
    [
        (_no_run, ReportError, r": is not a run: it holds none of the"),
        (lambda folder: folder / "absent", ReportError, r"absent: there is no such folder"),
        (_file, ReportError, r"x: is a file. Name the folder of a run"),
        (_newer_trace, TraceError, r"x.trace.json: a trace of version vitruvius-trace-9, not"),
        (_torn_houses, HouseFileError, r"houses.jsonl:2: not a house"),
        (_other("generator.json"), ReportError, r"generator.json: not a report of a study"),
        (_other("homes.json", "{}"), ReportError, r"homes.json: not a file of bench homes"),
        (_other("config.json", "{"), ReportError, "not the configuration of a run"),
        (_other("config.json", "[1]"), ReportError, "not the configuration of a run"),
        (_other("metrics.jsonl", "{}"), ReportError, "is not a run"),
        (_other("config.json", '{"name": "another program"}'), ReportError, "is not a run"),
        (_other("evaluation.json", "{}"), Exception, r"evaluation.json: not scores"),
    ],
)
def test_what_cannot_be_reported_is_said_in_one_line(tmp_path, make, error, says) -> None:
    with pytest.raises(error, match=says) as raised:
        Report(make(tmp_path)).run()
    assert "\n" not in str(raised.value)
    assert raised.value.exit_code == 5
    assert not list(tmp_path.glob("*.html"))


def test_of_scores_in_a_bank_of_the_benchmark_its_houses_are_shown(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(plans, "MAX_PLANS", 20)
    bank = ScoredBank(bank_hash(benchmark()), "test-v1", 256)
    one = result(scores([5] * 256), oracle=[10] * 256, rooms=[2] * 256, shortest=[9] * 256)
    (tmp_path / "evaluation.json").write_bytes(ScoreFile(bank, 0, modes_of([one])).json())
    outline = Outline(report(tmp_path, SECTIONS).decode())
    assert outline.sections == ["evaluation", "plans"]
    assert "256 houses in 1 file. Of each file every 13th house is shown." in outline.text


def test_the_first_sentence_says_how_well_the_best_agent_did(tmp_path) -> None:
    measured(tmp_path)
    said = (
        "In 2 houses, agent collects 6.5 targets in secondary rooms per episode; the best baseline with no "
        "more information, explorer, collects 8.0; the oracle, which knows the house and the target, 15.0."
    )
    assert said in report(tmp_path, SECTIONS).decode()
    mode = '{"task": "object", "piece": "coffeeTable"}'
    one = result(scores([1, 0], first=[30, np.inf]), oracle=(1, 1), mode=mode)
    found = modes_of([replace(one, ends_on_pick_up=True)])
    (tmp_path / "evaluation.json").write_bytes(ScoreFile(ScoredBank("abc", "b.jsonl", 2), 0, found).json())
    page = report(tmp_path, SECTIONS).decode()
    # The SPL is given, too: the fraction of successes alone may equal the oracle's.
    assert (
        "In 2 houses, agent finds a coffee table in 50% of its episodes, at an SPL of 0.50, where 1 means "
        "the shortest path in every episode."
    ) in page
    assert "<h3>Find a coffee table</h3>" in page
    assert "coffeeTable" not in page
    # The houses are of a grammar that calls its worktop so.
    desk = modes_of([replace(one, mode='{"task": "object", "piece": "desk"}', ends_on_pick_up=True)])
    bank = ScoredBank(bank_hash(benchmark()), "test-v1", 2)
    (tmp_path / "evaluation.json").write_bytes(ScoreFile(bank, 0, desk).json())
    assert "<h3>Find a worktop</h3>" in measured_section([tmp_path / "evaluation.json"], tmp_path).html


def test_an_interval_whose_ends_read_the_same_is_left_out(tmp_path) -> None:
    one = result(scores([5, 8]), oracle=(15, 15))
    (tmp_path / "evaluation.json").write_bytes(ScoreFile(ScoredBank("a", "b", 2), 0, modes_of([one])).json())
    html = measured_section([tmp_path / "evaluation.json"], tmp_path).html
    assert "<small>5.0 to 8.0</small>" in html
    assert not re.search(r"<small>([\d.]+) to \1</small>", html)


def test_other_files_of_json_lines_are_passed_over(tmp_path) -> None:
    save([HOUSE], tmp_path / "houses.jsonl")
    (tmp_path / "games.jsonl").write_text('{"format": "vitruvius-game-1"}\n')
    (tmp_path / "empty.jsonl").write_text("")
    assert Outline(report(tmp_path, SECTIONS).decode()).sections == ["plans"]


@pytest.mark.parametrize(("count", "most"), [(0, 5), (1, 5), (5, 5), (6, 5), (299, 30), (300, 30)])
def test_of_many_points_some_are_shown_the_last_among_them(count, most) -> None:
    places = list(some(count, most))
    assert len(places) <= most
    assert len(places) >= min(count, most / 2)
    assert not count or places[-1] == count - 1


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("values", [[0.0], [0.002, 0.002], [1e-9, 1e9], [3.0, -4.0, 0.0], [5.0, 6.0, 7.0]])
def test_a_plot_is_sound_svg_within_its_box_for_any_numbers(log, values) -> None:
    points = list(range(1, len(values) + 1))
    lines = [DataSeries("a < b", points, values, [v - abs(v) / 2 for v in values], [v + 1 for v in values])]
    figure = line_plot("A & B", Axis("x", log), Axis("y", log), lines)
    tree = ElementTree.fromstring(f"<x>{figure}</x>")
    svg = next(tree.iter("svg"))
    _, _, width, height = map(float, svg.attrib["viewBox"].split())
    for line in svg.iter("line"):
        assert all(0 <= float(line.attrib[key]) <= width for key in ("x1", "x2"))
        assert all(0 <= float(line.attrib[key]) <= height for key in ("y1", "y2"))
    assert 2 <= len([line for line in svg.iter("line") if line.attrib["x1"] == line.attrib["x2"]]) <= 12


@pytest.mark.parametrize(
    "lines",
    [
        [LINE | {"steps": 10**400}],
        [LINE | {"targets": 1e99}, LINE | {"targets": -1e99}],
        [LINE | {"loss": 5e-324}],
    ],
    ids=["steps", "targets", "loss"],
)
def test_numbers_of_a_run_that_no_plot_can_show_end_no_report(tmp_path, lines) -> None:
    metrics(tmp_path, json.dumps(LINE), *map(json.dumps, lines))
    assert b"Learning curves" in report(tmp_path, SECTIONS)


@pytest.mark.parametrize("runs", [[], [[1], [1, 2]]], ids=["no runs", "runs of other lengths"])
def test_scores_of_another_program_that_are_not_whole_end_no_report(tmp_path, runs) -> None:
    save([HOUSE, HOUSE], tmp_path / "houses.jsonl")
    measured(tmp_path, [HOUSE, HOUSE])
    path = tmp_path / "evaluation.json"
    content = json.loads(path.read_bytes())
    (mode,) = content["targets"].values()
    run = mode["policies"]["explorer"]["runs"][0]
    mode["policies"]["explorer"]["runs"] = [run | {"targets": each} for each in runs]
    content["targets"]['{"task": "reach", "room": 5}'] = mode
    path.write_text(json.dumps(content))
    assert b"Houses" in report(tmp_path, SECTIONS)
