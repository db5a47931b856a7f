"""The studies of random inputs keep the inputs that fail, and count the answers."""

from pathlib import Path

import pytest

from benchmarks.reliability import fuzz
from benchmarks.reliability.environments import Calls
from benchmarks.reliability.fuzz import Fuzz, FuzzTrial
from benchmarks.reliability.grammars import RandomGrammars
from benchmarks.reliability.readers import FuzzReader, begin
from vitruvius.logic.errors import RequestError, VitruviusError

pytestmark = pytest.mark.second_part("each study is run in small")


def broken(path: Path) -> None:
    content = path.read_bytes()
    if content.startswith(b"two"):
        raise VitruviusError("an error without an exit code")
    if content.startswith(b"odd"):
        raise KeyError("odd")


def test_the_smallest_content_of_each_kind_of_failure_is_kept(tmp_path, monkeypatch):
    monkeypatch.setitem(fuzz.READERS, "broken", FuzzReader("mine.txt", broken))
    out, folder = tmp_path / "out", tmp_path / "in"
    out.mkdir()
    folder.mkdir()
    trial = FuzzTrial("broken", out, folder)
    for content in (b"right", b"odd one", b"odd", b"odd other", b"two"):
        trial(content)
    assert trial.figures.answers == {"read": 1, "failed": 4}
    kept = {Path(each).read_bytes() for each in trial.figures.failures.values()}
    assert kept == {b"odd", b"two"}


def test_the_study_tries_more_contents_than_a_reader_begins_with(tmp_path, capsys):
    assert Fuzz(2, ("promises",), out=tmp_path / "out").run() == 0
    [line] = capsys.readouterr().out.splitlines()
    runs = int(line.split()[1].replace(",", ""))
    assert runs > len(begin("promises"))
    with pytest.raises(RequestError, match="there is no reader promise"):
        Fuzz(2, ("promise",), out=tmp_path / "other").run()


def test_a_random_grammar_gives_one_of_the_four_answers_twice(tmp_path, capsys):
    assert RandomGrammars(4, out=tmp_path / "out").run() == 0
    assert capsys.readouterr().out.startswith("grammars: ")


def test_calls_of_environments_are_counted_by_kind_and_mode(capsys):
    assert Calls(2, ("grid",)).run() == 0
    *modes, last = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in modes] == [
        "grid, NextStep",
        "grid, SameStep",
        "grid, Disabled",
    ]
    assert last.endswith(": 0 failures")
