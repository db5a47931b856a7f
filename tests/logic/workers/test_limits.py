"""Steps that take too much time or memory are named soon: endless rules, files of any size and kind."""

import os
import re
import resource
import shutil
import sys
import time
from collections.abc import Callable
from itertools import takewhile
from pathlib import Path

import pytest

from tests.logic.workers import in_process
from vitruvius.logic import GrammarError, LimitReached, count_layouts, generate, lint
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.language import trial
from vitruvius.logic.workers import solver

LATE = 10.0
"""Seconds that an answer may take beyond its limit on a busy machine. Without the limit it takes minutes."""

JOIN = "n(1..999).\n:- {}n(X), n(Y), n(Z), X*X-Y*Y*Z*Z*Z = 17.\n"
"""Join of a billion triples, hardly any of which satisfies it."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(solver, "LOADING", 0.5)
    monkeypatch.setattr(solver, "STEP", 0.5)
    return shutil.copytree(SHIPPED / "family", tmp_path / "mine")


def add(file: Path, text: str) -> str:
    """Append a text to a file, and return the place of its last line."""
    with file.open("a") as rules:
        rules.write(text)
    return f"{file}:{len(file.read_text().splitlines())}:1"


def within(seconds: float, call: Callable[[], object]) -> str:
    """Return the error of a call, whose processes must finish within these seconds of CPU time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with pytest.raises((GrammarError, LimitReached)) as caught:
        call()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < seconds
    return str(caught.value)


@pytest.mark.second_part("limits are waited for")
def test_a_join_of_very_many_values_is_named(folder: Path) -> None:
    place = add(folder / "rooms.lp", JOIN.format(""))
    said = within(6, lambda: next(generate(rooms=3, grammar=folder)))
    assert said.startswith(f"{place}: to ground this rule takes too much time or memory")
    assert said.endswith("join too many values? :- n(X), n(Y), n(Z), X*X-Y*Y*Z*Z*Z = 17.")


@pytest.mark.second_part("limits are waited for")
def test_lint_lists_a_recursion_that_starts_at_furniture(folder: Path) -> None:
    place = add(folder / "arrangement.lp", "n(K) :- on(bed,K,_,_).\n:- n(0).\nn(K+1) :- n(K).\n")
    (finding,) = lint(folder)
    assert str(finding).startswith(f"{place}: error: to ground this rule takes too much")


@pytest.mark.second_part("it is waited for")
def test_a_join_in_large_houses_alone_is_named_when_the_time_for_a_house_is_over(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solver, "LOADING", 5.0)
    place, said = add(folder / "rooms.lp", JOIN.format("rooms > 8, ")), ""
    for seconds in (4, 20, 60):  # Another process finds it meanwhile, and starts later under load.
        with pytest.raises(LimitReached) as caught:
            next(generate(rooms=9, grammar=folder, seconds=float(seconds)))
        said = str(caught.value)
        if place in said:
            break
    assert said.startswith(
        f"house 0 reached its limit of {seconds} seconds: raise it with --seconds: {place}: "
    )


@pytest.mark.second_part("limits are waited for")
def test_a_clause_that_computes_for_ever_is_named(folder: Path) -> None:
    """The clause computes in one inference, so that no limit on inferences ends it."""
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
        GrammarError, match=r"sizes\.pl:\d+:1: piece_size\(desk, L, D, Wall\) never ends: endless/0"
    ):
        next(generate(rooms=3, types={"kitchen": 1}, grammar=folder))


@pytest.mark.parametrize("grammar", ["home", "apartments"])
def test_a_trial_names_no_shared_rule(grammar: str) -> None:
    grounding = takewhile(lambda error: ".pl" not in str(error.file), trial.steps(find(grammar), [5]))
    steps = [error for error in grounding if error.line]
    assert steps
    assert {Path(str(error.file)) for error in steps} <= set(find(grammar).own)


TIGHT = (("house_size(W, D) :- { W =< 2.2*D, D =< 2.2*W }.", "house_size(W, D) :- { W =< 8.5, D =< 8.5 }."),)
"""Bounds with which no plan of twelve rooms is found in a minute, and none is proved impossible."""


def tight(folder: Path) -> Path:
    made = shutil.copytree(SHIPPED / "home", folder / "tight")
    text = (made / "lengths.pl").read_text()
    for old, new in TIGHT:
        assert text.count(old) == 1
        text = text.replace(old, new)
    (made / "lengths.pl").write_text(text)
    return made


@pytest.mark.second_part("limits are waited for")
def test_a_limit_names_the_stage_and_what_refuted_most_and_is_kept(tmp_path: Path) -> None:
    made = tight(tmp_path)
    next(generate(rooms=4, grammar=made))  # So that rules are loaded.
    began = time.monotonic()
    with pytest.raises(LimitReached) as caught:
        next(generate(rooms=12, grammar=made, seconds=4.0))
    assert 4.0 <= time.monotonic() - began < 4.0 + solver.GRACE + LATE
    said = str(caught.value)
    late = "house 0 reached its limit of 4 seconds: raise it with --seconds."
    assert said.startswith(f"{late} The last step was")
    refuted = re.search(
        r"(\d+) of (\d+) layouts of the rooms were refuted\. "
        r"(?:\d+ layouts? of furniture w\w+ refuted\. )?Most were refuted by\n +(\d+) times",
        said,
    )
    assert refuted, said
    assert 0 < int(refuted[3]) <= int(refuted[1]) <= int(refuted[2])
    lines = (made / "lengths.pl").read_text().splitlines()
    assert f"{made / 'lengths.pl'}:{lines.index(TIGHT[0][1]) + 1}:1: {TIGHT[0][1]}" in said
    assert "To make it easier, ask for fewer rooms, or give" in said
    assert "logic/rules" not in said


@pytest.mark.second_part("waited for")
def test_a_limit_of_a_search_names_the_rule_without_which_a_layout_is_found_and_is_kept(
    tmp_path: Path,
) -> None:
    """Another process finds the rule meanwhile. The process has to start, which takes longer under load.

    Refuting sixteen rooms with fifteen keys takes clingo hours, thirteen with twelve a quarter of a minute.
    """
    made = shutil.copytree(SHIPPED / "family", tmp_path / "mine")
    choice, rule = "option(key(R),1..15,1) :- R = 0..rooms-1.", ":- pick(key(R),K), pick(key(Q),K), R < Q."
    place, said = add(made / "rooms.lp", f"{choice}\n{rule}\n"), ""
    for seconds in (4.0, 16.0, 64.0):
        next(generate(rooms=3, grammar=made))  # To load the rules.
        began = time.monotonic()
        with pytest.raises(LimitReached) as caught:
            next(generate(rooms=16, grammar=made, seconds=seconds))
        assert seconds <= time.monotonic() - began < seconds + solver.GRACE + LATE
        said = str(caught.value)
        if place in said:
            break
    assert "The last step was the types and sides of the rooms (clingo)." in said
    assert said.endswith(f"\nA layout is soon found\n  without {place}: {rule}")


@pytest.mark.parametrize(
    ("grammar", "rooms", "inferences", "stage"),
    [
        ("home", 4, 20_000, "the lengths of walls (CLP(R))"),
        ("clinic", 3, 30_000, "the lengths of the furniture of a "),
        ("family", 9, 12_345, "the lengths of the rooms and of their furniture (CLP(R))"),
    ],
)
def test_a_limit_of_inferences_is_the_one_that_was_set_and_names_the_stage(
    grammar: str, rooms: int, inferences: int, stage: str
) -> None:
    with pytest.raises(LimitReached) as caught:
        next(in_process.generate(rooms=rooms, grammar=grammar, inferences=inferences))
    late = f"house 0 reached its limit of {inferences} inferences: raise it with --inferences"
    assert str(caught.value).startswith(f"{late}. The last step was {stage}")


def test_counting_takes_no_more_than_its_seconds() -> None:
    began = time.monotonic()
    counted = list(count_layouts(9, grammar="family", seconds=1.0))
    assert len(counted) == 5  # The rooms, and the furniture of each of four types.
    assert not all(exact for *_, exact in counted)
    assert time.monotonic() - began < 1.0 + solver.START_UP  # Without a limit it would take days.


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
