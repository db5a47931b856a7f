"""What takes too much time or memory is named soon: rules that do not end, files of any size and kind."""

import os
import resource
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from logic import GrammarError, LimitReached, generate, lint, solver, trial
from logic.grammar import SHIPPED, find

JOIN = "n(1..999).\n:- {}n(X), n(Y), n(Z), X*X-Y*Y*Z*Z*Z = 17.\n"
"""A join of a billion triples, hardly one of which fits."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(solver, "LOADING", 0.5)
    monkeypatch.setattr(solver, "STEP", 0.5)
    return shutil.copytree(SHIPPED / "family", tmp_path / "mine")


def add(file: Path, text: str) -> str:
    """Append to a file; gives the place of the last line."""
    with file.open("a") as rules:
        rules.write(text)
    return f"{file}:{len(file.read_text().splitlines())}:1"


def within(seconds: float, call: Callable[[], object]) -> str:
    """What the error of a call says, to which its processes must come in these seconds of CPU time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with pytest.raises((GrammarError, LimitReached)) as caught:
        call()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < seconds
    return str(caught.value)


def test_a_join_of_very_many_values_is_named(folder: Path) -> None:
    place = add(folder / "rooms.lp", JOIN.format(""))
    said = within(6, lambda: next(generate(rooms=3, grammar=folder)))
    assert said.startswith(f"{place}: to ground this rule takes too much time or memory")
    assert said.endswith("join too many values? :- n(X), n(Y), n(Z), X*X-Y*Y*Z*Z*Z = 17.")


def test_lint_lists_a_recursion_that_starts_at_furniture(folder: Path) -> None:
    place = add(folder / "arrangement.lp", "n(K) :- on(bed,K,_,_).\n:- n(0).\nn(K+1) :- n(K).\n")
    (finding,) = lint(folder)
    assert str(finding).startswith(f"{place}: error: to ground this rule takes too much")


def test_a_join_in_large_houses_alone_is_named_when_the_time_for_a_house_is_over(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solver, "LOADING", 5.0)
    place = add(folder / "rooms.lp", JOIN.format("rooms > 8, "))
    said = within(6, lambda: next(generate(rooms=9, grammar=folder, seconds=1.0)))
    assert said.startswith(f"house 0 reached its limit of 1 seconds: raise it with --seconds: {place}: ")


def test_a_clause_that_computes_for_ever_is_named(folder: Path) -> None:
    """In one inference: no bound of inferences ends it."""
    text = (folder / "sizes.pl").read_text()
    (folder / "sizes.pl").write_text(
        text.replace(
            "piece_size(sofa,      L, D, _) :- {", "piece_size(sofa, L, D, _) :- X is 7**(10**8), X > 0, {"
        )
    )
    line = next(
        n for n, each in enumerate((folder / "sizes.pl").read_text().splitlines(), 1) if "10**8" in each
    )
    said = within(6, lambda: next(generate(rooms=3, grammar=folder)))
    assert said.startswith(
        f"{folder / 'sizes.pl'}:{line}:1: piece_size(sofa, ...) takes too much time or memory"
    )


def test_a_file_that_ends_its_reader_is_named(folder: Path) -> None:
    add(folder / "sizes.pl", f"deep({'f(' * 300_000}1{')' * 300_000}).\n")
    assert str(lint(folder)[0]).startswith(
        f"{folder / 'sizes.pl'}:1:1: error: to read this file takes too much"
    )


def test_a_clause_that_loops_at_some_walls_alone_is_named_when_a_house_meets_one(folder: Path) -> None:
    add(folder / "sizes.pl", "endless :- endless.\n")
    text = (folder / "sizes.pl").read_text()
    old, new = (
        "piece_size(desk,      L, D, Wall) :- {",
        "piece_size(desk, L, D, Wall) :- ( number(Wall) -> endless ; true ), {",
    )
    (folder / "sizes.pl").write_text(text.replace(old, new))
    with pytest.raises(
        GrammarError, match=r"sizes\.pl:\d+:1: piece_size\(desk, L, D, Wall\) recurs without end: endless/0"
    ):
        next(generate(rooms=3, types={"kitchen": 1}, grammar=folder))


def test_a_trial_names_each_rule_and_each_size_and_ends_where_nothing_is_wrong() -> None:
    grammar = find("family")
    named = {(error.file, error.line) for error in trial.steps(grammar, [4])}
    for file in grammar.asp + grammar.prolog:
        lines = enumerate(file.read_text().splitlines(), 1)
        found = {number for number, line in lines if line.startswith((":-", "room_size", "piece_size"))}
        assert found <= {line for where, line in named if str(where) == str(file)}


def sparse(file: Path) -> None:
    with file.open("wb") as made:
        made.truncate(5 << 30)


ODD: dict[str, tuple[Callable[[Path], None], str]] = {
    "a sparse file of 5 GB": (sparse, "holds more than 16 MiB"),
    "an endless device": (
        lambda file: file.symlink_to("/dev/zero"),
        "is a link out of the grammar's directory",
    ),
    "a pipe": (os.mkfifo, "is a device or a pipe"),
    "a link to nothing": (lambda file: file.symlink_to("nowhere"), "cannot be read: No such file"),
    "a link to itself": (lambda file: file.symlink_to(file), "cannot be read: Too many levels"),
}


@pytest.mark.parametrize("name", ["more.lp", "more.pl"])
@pytest.mark.parametrize("odd", ODD)
def test_a_rule_file_of_any_kind_is_answered_at_once_with_little_memory(
    odd: str, name: str, folder: Path
) -> None:
    make, says = ODD[odd]
    make(folder / name)
    began, before = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(GrammarError, match=says) as caught:
        generate(rooms=2, grammar=folder)
    assert caught.value.file == folder / name
    assert time.process_time() - began < 1
    kilobytes = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) >> (
        10 if sys.platform == "darwin" else 0
    )
    assert kilobytes < 100_000


def test_a_folder_named_as_a_rule_file_is_passed_over(folder: Path) -> None:
    before = find(folder)
    (folder / "more.pl").mkdir()
    assert find(folder) == before
