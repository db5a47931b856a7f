"""Causes of a slow search for layouts: the user's rules and choices are named, never a shipped file."""

import shutil
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.proofs.easing import easing
from vitruvius.logic.request.house_request import HouseRequest

HARD: dict[str, tuple[str, str, str, dict[str, Any]]] = {
    "more rooms than keys": (
        "family",
        "option(key(R),1..rooms-1,1) :- R = 0..rooms-1.",
        ":- pick(key(R),K), pick(key(Q),K), R < Q.",
        {"rooms": 13},
    ),
    "five bedrooms each beside all others": (
        "home",
        "",
        ":- room(R,bedroom), room(Q,bedroom), R < Q, not adjacent(R,Q).",
        {"rooms": 10, "types": {"bedroom": 5}},
    ),
    "more rooms than four teams may have": (
        "clinic",
        "option(team(R),1..4,1) :- R = 0..rooms-1.",
        ":- #count{ R : pick(team(R),T) } > 3, T = 1..4.",
        {"rooms": 14},
    ),
}


def asked(folder: Path | str, request: dict[str, Any], most: int = 3) -> list[str]:
    wanted = HouseRequest.read({"types": {}, "furniture": {}, "cell": 0.0, **request})
    return list(islice(easing(Builder(find(folder)), wanted), most))


@pytest.mark.parametrize("title", HARD)
def test_the_rule_that_makes_layouts_hard_to_find_is_named_by_its_place(title: str, tmp_path: Path) -> None:
    grammar, choice, rule, request = HARD[title]
    folder = shutil.copytree(SHIPPED / grammar, tmp_path / "mine")
    (folder / "more.lp").write_text(f"#program house.\n{choice}\n{rule}\n")
    assert asked(folder, request, most=1) == [f"without {folder / 'more.lp'}:3:1: {rule}"]


@pytest.mark.parametrize(
    ("grammar", "request_", "found"),
    [
        ("family", {"rooms": 3, "types": {"bathroom": 9}}, "without --type bathroom=9"),
        ("home", {"rooms": 5, "types": {"wc": 4}}, "without --type wc=4"),
        ("family", {"rooms": 3, "types": {"bathroom": 1}}, ""),
    ],
)
def test_of_a_shipped_grammar_the_requests_own_choices_are_named(
    grammar: str, request_: dict[str, Any], found: str
) -> None:
    assert asked(grammar, request_) == ([found] if found else [])
