"""Why there is no house: least sets of the user's own statements and choices, each by its place."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from agent.cli import main
from logic import House, Unsatisfiable, generate
from logic.grammar import SHIPPED

BASIC = "rooms.lp: basic(bedroom; bathroom; kitchen)."
EACH = "rooms.lp: :- rooms >= 3, basic(T), not room(_,T)."
TWO = "rooms.lp: :- rooms >= 2, { room(R,T) : basic(T) } < 2."
BED = "furniture.lp: may(bedroom,bed,1,2)."
ALONE = "#program house.\n:- room(_,bedroom), room(_,kitchen)."
HUGE = "sizes.pl: room_size(bathroom, 2.4, 2.4)."

CASES = {
    "too many of a type": (
        {},
        {"rooms": 3, "types": {"bathroom": 9, "kitchen": 1}},
        ["--rooms 3", "--type bathroom=9"],
    ),
    "a basic type is missing": (
        {},
        {"rooms": 3, "types": {"kitchen": 0}},
        ["--rooms 3", BASIC, EACH, "--type kitchen=0"],
    ),
    "no basic types in two rooms": (
        {},
        {"rooms": 2, "types": {"hall": (1, None)}},
        ["--rooms 2", TWO, "--type hall=1.."],
    ),
    "minima add up to too much": (
        {},
        {"rooms": 2, "types": {"bedroom": (2, None), "bathroom": (1, 3)}},
        ["--rooms 2", "--type bathroom=1..3", "--type bedroom=2.."],
    ),
    "all types have maxima": (
        {},
        {"rooms": 9, "types": dict.fromkeys(("bedroom", "bathroom", "kitchen", "hall"), (0, 2))},
        [
            "--rooms 9",
            "--type bathroom=0..2",
            "--type bedroom=0..2",
            "--type hall=0..2",
            "--type kitchen=0..2",
        ],
    ),
    "more beds than a room may have": (
        {},
        {"rooms": 3, "furniture": {"bedroom.bed": (3, None)}},
        ["--rooms 3", BASIC, EACH, "--piece bedroom.bed=3.."],
    ),
    "no bed in a bedroom": (
        {},
        {"rooms": 3, "furniture": {"bed": 0}},
        ["--rooms 3", BASIC, EACH, BED, "--piece bed=0"],
    ),
    "two rules contradict each other": (
        {"rooms.lp": (":- rooms >= 2,", ":- room(_,bedroom).\n:- not room(_,bedroom).\n:- rooms >= 2,")},
        {"rooms": 2},
        ["rooms.lp: :- room(_,bedroom).", "rooms.lp: :- not room(_,bedroom)."],
    ),
    "a rule against the paper's": (
        {"rooms.lp": ("#program house.", ALONE)},
        {"rooms": 3},
        ["--rooms 3", BASIC, ALONE.replace("#program house.\n", "rooms.lp: "), EACH],
    ),
    "a rule of the rooms' furniture": (
        {"arrangement.lp": ("#program room.", "#program room.\n:- on(toilet,_,_,_).")},
        {"rooms": 4},
        [
            "--rooms 4",
            BASIC,
            EACH,
            "arrangement.lp: :- on(toilet,_,_,_).",
            "furniture.lp: may(bathroom,toilet,1,1).",
        ],
    ),
    "a door too wide for the room": (
        {"sizes.pl": ("door_width(0.762)", "door_width(3.9)")},
        {"rooms": 3},
        [
            "--rooms 3",
            BASIC,
            EACH,
            "sizes.pl: door_width(3.9).",
            "sizes.pl: room_size(bathroom, W, D) :- { W >= 2.4, W =< 3.7, D >= 2.4, D =< 3.7 }.",
        ],
    ),
    "a table with no way round it": (
        {
            "sizes.pl": (
                "piece_size(hallTable, L, D, _) :- { L >= 1.0,  L =< 2.0,",
                "piece_size(hallTable, L, D, _) :- { L >= 5.5,  L =< 6.0,",
            ),
            "furniture.lp": ("may(hall,hallTable,0,1)", "may(hall,hallTable,1,1)"),
        },
        {"rooms": 1, "types": {"hall": 1}},
        [
            "--type hall=1",
            "furniture.lp: may(hall,hallTable,1,1).",
            "sizes.pl: passage(0.42).",
            "sizes.pl: room_size(hall, W, D) :- { W >= 4.2, W =< 6.1, D >= 4.2, D =< 6.1 }.",
            "sizes.pl: piece_size(hallTable, L, D, _) :- { L >= 5.5, L =< 6.0, D >= 0.8, D =< 1.2 }.",
        ],
    ),
}


@pytest.fixture(params=CASES, ids=lambda name: name.replace(" ", "-"))
def case(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, dict, list[str]]:
    edits, asked, expected = CASES[request.param]
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    for file, (old, new) in edits.items():
        text = (folder / file).read_text()
        assert old in text
        (folder / file).write_text(text.replace(old, new, 1))
    return folder, asked, expected


def proof(folder: Path, asked: dict) -> Unsatisfiable:
    with pytest.raises(Unsatisfiable) as caught:
        next(generate(**asked, grammar=folder))
    return caught.value


def test_what_clashes_is_named_by_its_place(case: tuple[Path, dict, list[str]]) -> None:
    folder, asked, expected = case
    found = proof(folder, asked)
    told = [f"{Path(r.file).name}: {r.text}" if r.file else r.text for r in found.reasons]
    assert sorted(told) == sorted(expected)
    for reason in found.reasons:
        if reason.file:
            line = Path(reason.file).read_text().split("\n")[reason.line - 1]
            assert line[reason.column - 1 :].startswith(reason.text.split()[0][:8])


def test_without_any_one_of_them_there_is_a_house(case: tuple[Path, dict, list[str]]) -> None:
    """The rules and choices among the reasons, really taken away one at a time."""
    folder, asked, _ = case
    for reason in proof(folder, asked).reasons:
        changed, copy = json.loads(json.dumps(asked)), folder.parent / "changed"
        shutil.copytree(folder, copy, dirs_exist_ok=True)
        if reason.text.startswith("--type "):
            del changed["types"][reason.text.split()[1].split("=")[0]]
        elif reason.text.startswith("--piece "):
            del changed["furniture"][reason.text.split()[1].split("=")[0]]
        elif reason.text.startswith("--rooms "):
            assert any(is_possible(copy, changed | {"rooms": rooms}) for rooms in range(1, 30))
            continue
        elif reason.text.startswith(":-"):
            rules = copy / Path(reason.file or "").name
            rules.write_text(rules.read_text().replace(reason.text, "", 1))
        else:
            continue  # A grammar without a fact or a clause that it needs is another error, not a house.
        assert is_possible(copy, changed), reason


def is_possible(grammar: Path, asked: dict) -> bool:
    try:
        return isinstance(next(generate(**asked, grammar=grammar)), House)
    except Unsatisfiable:
        return False


def test_another_number_of_rooms_is_advised() -> None:
    found = proof(SHIPPED / "family", {"rooms": 3, "types": {"kitchen": 0}})
    assert found.advice == "There is a house with --rooms 2, or without --type kitchen=0."


@pytest.fixture
def told(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    def run(*arguments: str) -> tuple[int, str]:
        with pytest.raises(SystemExit) as end:
            main(list(arguments))
        return int(end.value.code or 0), capsys.readouterr().out

    return run


def test_explain_tells_in_words_and_in_json(told: Callable[..., tuple[int, str]]) -> None:
    code, words = told("explain", "--rooms", "3", "--type", "bathroom=9")
    assert (code, words.count("\n")) == (0, 4)
    assert "--type bathroom=9" in words
    code, record = told("explain", "--rooms", "3", "--type", "kitchen=0", "--json")
    assert code == 0
    assert [reason["line"] for reason in json.loads(record)["reasons"]] == [None, 4, 10, None]


def test_explain_says_that_there_are_houses(told: Callable[..., tuple[int, str]]) -> None:
    code, words = told("explain", "--rooms", "3", "--type", "bathroom=1..2", "--piece", "bed=1")
    assert (code, words) == (1, "There are such houses: vitruvius generate\n")
