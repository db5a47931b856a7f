"""Proofs that there is no house: least sets of the user's own statements and choices, with their places."""

import json
import re
import shutil
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from tests.logic.proofs.conflicts import CASES
from tests.logic.workers import in_process
from vitruvius.cli import main
from vitruvius.logic import House, Unsatisfiable
from vitruvius.logic.errors import Reason
from vitruvius.logic.grammar import SHIPPED

Case = tuple[Path, dict[str, Any], list[str], Unsatisfiable]

WISHES = {"--type": "types", "--piece": "furniture"}

LEAST = {
    r":- .*": "",
    r"may\((\w+),(\w+),\d+,\d+\)\.": r"may(\1,\2,0,4).",
    r"(around|beside)\((\w+),(\w+),\d+,(\d+)\)\.": r"\1(\2,\3,0,\4).",
    r"basic\(.*\)\.": "basic(hall).",
    r"(\w+)\([0-9.]+\)\.": r"\1(0.01).",
    r"(\w+_size\(\w+, +)[^,]+, [^,)]+(.*\))( :- .*|\.)": (
        r"\1L, D\2 :- { L >= 0.01, L =< 90, D >= 0.01, D =< 90 }."
    ),
}
"""Replacements of a fact or a clause with which it requires the least."""

FILLED = """#program room.
:- busy(S), not end(S).
:- on(desk,K,_,_), not joined(desk,K)."""


@pytest.fixture(scope="module", params=CASES, ids=lambda name: name.replace(" ", "-"))
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Return a case. Cases with family's own files share a builder, which has read the files once."""
    edits, asked, expected = CASES[request.param]
    if not edits:
        return SHIPPED / "family", asked, expected, proof(SHIPPED / "family", asked)
    folder = tmp_path_factory.mktemp("case") / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    for file, (old, new) in edits.items():
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new, 1))
    return folder, asked, expected, proof(folder, asked)


def proof(folder: Path, asked: dict) -> Unsatisfiable:
    with pytest.raises(Unsatisfiable) as caught:
        next(in_process.generate(**asked, grammar=folder))
    return caught.value


def test_a_conflict_names_every_statement_by_its_place(case: Case) -> None:
    _, _, expected, found = case
    named = [f"{Path(r.file).name}: {r.text}" if r.file else r.text for r in found.reasons]
    assert sorted(named) == sorted(expected)
    for reason in found.reasons:
        if reason.file and reason.line and reason.column:
            line = Path(reason.file).read_text().split("\n")[reason.line - 1]
            assert line[reason.column - 1 :].startswith(reason.text.split()[0][:8])


@pytest.mark.second_part("without each")
def test_without_any_one_statement_of_a_conflict_there_is_a_house(case: Case, tmp_path: Path) -> None:
    """Each of the reasons is actually removed: a rule or choice left out, a fact or clause relaxed."""
    folder, asked, _, found = case
    for reason in found.reasons:
        changed, rules = deepcopy(asked), folder
        option, _, name = reason.text.partition("=")[0].partition(" ")
        if option in WISHES:
            del changed[WISHES[option]][name]
        elif option == "--rooms":
            changed["rooms"] = int(re.findall(r"with --rooms (\d+)", found.advice)[0])
        else:
            rules = tmp_path / "changed"
            shutil.copytree(folder, rules, dirs_exist_ok=True)
            take_away(rules, reason)
        assert is_possible(rules, changed), reason


def take_away(folder: Path, reason: Reason) -> None:
    """Replace a statement by one that requires the least."""
    assert reason.file
    rules = folder / Path(reason.file).name
    laxer = [re.sub(old, new, reason.text) for old, new in LEAST.items() if re.fullmatch(old, reason.text)]
    stated = r"\s+".join(map(re.escape, reason.text.split()))
    text, count = re.subn(stated, lambda _: laxer[0], rules.read_text(), count=1)
    assert count == 1
    rules.write_text(text)


def is_possible(grammar: Path, asked: dict) -> bool:
    try:
        return isinstance(next(in_process.generate(**asked, grammar=grammar)), House)
    except Unsatisfiable:
        return False


def test_another_number_of_rooms_is_advised() -> None:
    found = proof(SHIPPED / "family", {"rooms": 3, "types": {"kitchen": 0}})
    assert found.advice == "There is a house with --rooms 2, or without --type kitchen=0."


def test_what_is_advised_has_a_house() -> None:
    """Two rooms need a room that cannot be furnished, though not a kitchen; one room does not."""
    asked = {"rooms": 3, "types": {"kitchen": 0}, "furniture": {"bedroom.bed": 0, "bathroom.toilet": 0}}
    found = proof(SHIPPED / "family", asked)
    assert found.advice == "There is a house with --rooms 1."
    assert is_possible(SHIPPED / "family", asked | {"rooms": 1})
    assert not is_possible(SHIPPED / "family", asked | {"rooms": 2})


def test_a_conflict_that_only_a_grid_makes_is_named(tmp_path: Path) -> None:
    """A desk of half its wall's length does not fill the wall, but may fill another one in the same range."""
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    for file, old, new in (
        ("furniture.lp", "may(kitchen,desk,1,3).       may(kitchen,table,0,1).", "may(kitchen,desk,1,1)."),
        ("furniture.lp", "stands(table,     middle).                       around(table,chair,1,4).", ""),
        ("arrangement.lp", "#program room.", FILLED),
        ("sizes.pl", "L >= 0.7*Wall, L =< Wall", "L = 0.5*Wall"),
        ("sizes.pl", "{ W >= 3.0, W =< 4.6, D >= 3.0, D =< 4.6 }", "{ W >= 2.4, W =< 6, D >= 2.4, D =< 6 }"),
        ("sizes.pl", "piece_size(table,     L, D, _) :- { L >= 0.8,  L =< 1.6, D >= 0.7,  D =< 1.0 }.", ""),
    ):
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new, 1))
    for cell in (0.0, 0.3):
        with pytest.raises(Unsatisfiable) as caught:
            next(in_process.generate(rooms=1, types={"kitchen": 1}, grammar=folder, cell=cell))
        assert caught.value.unfurnishable == ("kitchen",)
        text = "".join(reason.text for reason in caught.value.reasons)
        assert all(word in text for word in ("--type kitchen=1", "busy(S)", "joined(desk,K)", "0.5*Wall"))


@pytest.fixture
def explained(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    def run(*arguments: str) -> tuple[int, str]:
        with pytest.raises(SystemExit) as end:
            main(list(arguments))
        return int(end.value.code or 0), capsys.readouterr().out

    return run


def test_explain_answers_in_words_or_in_json(explained: Callable[..., tuple[int, str]]) -> None:
    code, words = explained("explain", "--rooms", "3", "--type", "bathroom=9")
    assert (code, words.count("\n")) == (0, 4)
    assert "--type bathroom=9" in words
    code, record = explained("explain", "--rooms", "3", "--type", "kitchen=0", "--json")
    assert code == 0
    assert [reason["line"] for reason in json.loads(record)["answer"]["reasons"]] == [None, 4, 10, None]


def test_explain_says_so_where_there_are_houses(explained: Callable[..., tuple[int, str]]) -> None:
    request = "--rooms", "3", "--type", "bathroom=1..2", "--piece", "bed=1"
    code, words = explained("explain", *request)
    assert (code, words) == (1, f"There are such houses: vitruvius generate {' '.join(request)}\n")
