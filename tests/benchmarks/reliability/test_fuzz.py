"""The study of readers finds what fails, and keeps it."""

from pathlib import Path

import pytest

from benchmarks.reliability import fuzz
from benchmarks.reliability.environments import Calls
from benchmarks.reliability.fuzz import Fuzz, FuzzTrial
from benchmarks.reliability.grammars import RandomGrammars
from benchmarks.reliability.readers import FuzzReader, begin
from logic.errors import RequestError, VitruviusError


def broken(path: Path) -> None:
    content = path.read_bytes()
    if content.startswith(b"two"):
        raise VitruviusError("an error without an exit code")
    if content.startswith(b"odd"):
        raise KeyError("odd")


def test_a_content_that_fails_is_kept_the_smallest_of_its_kind(tmp_path, monkeypatch):
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


def test_readers_are_fuzzed_in_processes_of_their_own(tmp_path, capsys):
    assert Fuzz(2, ("promises",), out=tmp_path / "out").run() == 0
    [line] = capsys.readouterr().out.splitlines()
    runs = int(line.split()[1].replace(",", ""))
    assert runs > len(begin("promises"))
    with pytest.raises(RequestError, match="there is no reader promise"):
        Fuzz(2, ("promise",), out=tmp_path / "other").run()


def test_random_grammars_have_one_of_the_four_answers_twice(tmp_path, capsys):
    assert RandomGrammars(4, out=tmp_path / "out").run() == 0
    assert " grammars: " in capsys.readouterr().out


def test_calls_of_environments_are_counted_by_kind_and_mode(capsys):
    assert Calls(2, ("grid",)).run() == 0
    *modes, last = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in modes] == [
        "grid, NextStep",
        "grid, SameStep",
        "grid, Disabled",
    ]
    assert last.endswith(": 0 failures")
