"""Claims about values of any option: an empty value, and a dash for a standard stream."""

import contextlib
import json
import pkgutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks import STUDIES
from vitruvius import settings
from vitruvius.agent import banks
from vitruvius.cli import COMMANDS, main
from vitruvius.logic import House, RequestError, load
from vitruvius.logic.workers.check import promises_by
from vitruvius.options import Option, options_of, require
from vitruvius.sim.environment.arguments import house_list

PLANS = Path(__file__).parents[1] / "fixtures" / "plans.jsonl"

READ = {
    *(("check", name) for name in ("file", "promises")),
    *(("draw", name) for name in ("file", "diff")),
    *(("generate", name) for name in ("plan", "keep", "brief")),
    *(("explain", name) for name in ("file", "plan", "brief")),
    *(("train", name) for name in ("houses", "config")),
    *((name, "houses") for name in ("evaluate", "record", "play")),
    ("convert", "file"),
    ("regenerate", "file"),
    ("train", "held_out"),
}
"""Options for which ``-`` is the standard input, as the content of one file; ``info`` handles it
separately."""

WRITTEN = {("generate", "out"), ("convert", "out")}


def options() -> Iterator[tuple[str, Option]]:
    """Yield all options and arguments of all commands that take a text or a path."""
    for name, (place, _) in COMMANDS.items():
        if name != "bench":
            yield from ((name, option) for option in options_of(pkgutil.resolve_name(place)))
    for name, (place, _) in STUDIES.items():
        yield from ((f"bench {name}", option) for option in options_of(pkgutil.resolve_name(place)))


OPTIONS = [(name, option) for name, option in options() if option.type in (str, Path)]


def refusal(name: str, option: Option, value: str) -> str:
    """Return the message for a value, in one line."""
    words = [value] if option.positional else [f"{option.flag}={value}"]
    with pytest.raises(RequestError) as refused:
        require(f"vitruvius {name}", words, [option])
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_no_option_of_any_command_takes_an_empty_value() -> None:
    assert len(OPTIONS) > 100
    for name, option in OPTIONS:
        for value in ("", " "):
            assert "is empty: give " in refusal(name, option, value)


def test_a_dash_is_a_standard_stream_or_refused_with_what_to_give() -> None:
    streams = READ | WRITTEN
    for name, option in OPTIONS:
        if (name, option.name) in streams:
            assert option.dash
        elif option.type is Path:
            said = refusal(name, option, "-")
            assert "standard output" in said if option.name == "out" else "standard input" in said
            assert "give a path" in said
    assert {(name, option.name) for name, option in OPTIONS if option.dash} == streams


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["explain", str(PLANS), "--why", ""], 2, "--why: is empty"),
        (["train", "--out", ""], 2, "--out: is empty"),
        (["train", "--config", ""], 2, "--config: is empty"),
        (["generate", "--rooms", "1", "--grammar", ""], 2, "--grammar: is empty"),
        (["check", ""], 2, "FILE: is empty"),
        (["lint", "-"], 5, "-: a grammar is a folder"),
        (["draw", str(PLANS), "--out", "-"], 2, "--out -: is not written to standard output"),
        (["convert", str(PLANS), "--to", "geojson", "--out", "-"], 2, "a file for each house"),
        (["check", "-", "--promises", "-"], 2, ": standard input can be read only"),
        (["record", "pqn", "-", "--out", "-"], 2, "--out -"),
        (["bench", "odds", "--houses", ""], 2, "--houses"),
    ],
    ids=str,
)
def test_what_is_refused_is_one_line_and_makes_nothing(
    words: list[str], code: int, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main(words)
    said = capsys.readouterr().err
    assert (ended.value.code, said.count("\n"), says in said) == (code, 1, True), said
    assert not list(tmp_path.iterdir())


@pytest.fixture
def given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a context manager that gives content on the standard input."""
    monkeypatch.chdir(tmp_path)

    @contextlib.contextmanager
    def give(content: bytes) -> Iterator[None]:
        Path(".given").write_bytes(content)
        with open(".given", encoding="utf-8") as stdin:
            monkeypatch.setattr(sys, "stdin", stdin)
            yield

    return give


def test_what_comes_by_the_standard_input_is_read_as_the_file_is(given) -> None:
    """Commands that train, evaluate, record and play read houses through these two functions."""
    for read in (banks.named, house_list):
        with given(PLANS.read_bytes()):
            assert read("-") == load(PLANS)
    with given(b'{"passage": 9.0}'):
        assert promises_by("-")(load(PLANS)[0]).passage == 9
    with given(b'preset = "pqn"\nlearning_rate = 0.5\n'):
        _, config, _ = settings.read(Path("-"))
    assert config.learning_rate == 0.5
    assert not Path("-").exists()


def test_converted_houses_go_to_the_standard_output(given, capsys: pytest.CaptureFixture[str]) -> None:
    with given(PLANS.read_bytes()), pytest.raises(SystemExit, match="0"):
        main(["convert", "-", "--out", "-"])
    lines = capsys.readouterr().out.splitlines()
    houses = [House.from_dict(json.loads(line)) for line in lines]
    assert houses == [house.converted() for house in load(PLANS)]
    assert not Path("-").exists()


def test_rooms_of_a_house_by_the_standard_input_are_kept(given, capsys: pytest.CaptureFixture[str]) -> None:
    with given(json.dumps(load(PLANS)[0].to_dict()).encode()), pytest.raises(SystemExit):
        main(["generate", "--grammar", "home", "--keep", "-", "--keep-rooms", "none"])
    assert "--keep-rooms" in capsys.readouterr().err
