"""Changed rules in the playground: houses, proofs and mistakes are those of Python."""

import itertools
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page

from tests.logic.browser.answers import answered
from tests.logic.grammars.test_includes import LP, PL, WRONG
from tests.logic.language.test_own_topology import RULES, SIZES, TOPOLOGIES
from tests.logic.proofs import test_plan_proofs as proofs
from tests.logic.workers import in_process
from vitruvius.logic import GrammarError, Unsatisfiable, check
from vitruvius.logic.browser.playground.bundle import bundle
from vitruvius.logic.errors import RequestError
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.language.linter import findings
from vitruvius.logic.spelling import closest

pytestmark = pytest.mark.second_part("pages are driven in a browser, and solvers are compared")

MISTAKES = {
    "what the core derives": "#program house.\nwindow(R,north) :- room(R,hall).",
    "what the core states": "bounds(x,north,south).",
    "what the core derives for itself": "#program house.\nunfurnished(R,hall) :- room(R,hall).",
    "what the topology states": "#program house.\nouter(R,north) :- room(R,hall).",
    "a choice without a name": "#program house.\noption(X,0,2) :- X = 1..2.",
    "a choice in a head": "#program house.\n{ mine(1) }.\n:- mine(1).",
    "a disjunction": "#program house.\nmine(1); mine(2).\n:- mine(1).",
    "a constant of the request": "#const rooms=3.",
    "a word of the core": "#const north=3.",
    "an external atom": "#external mine(1).",
    "a program of no layout": "#program hose.\n:- room(0,hall).",
    "what is to be least": "#program house.\n:~ room(R,hall). [1,R]",
    "what is shown": "#show room/2.",
    "a script": "#script (lua) x=1 #end.",
    "a theory": "#program house.\n&diff { a - b } <= 1.",
    "another file": '#include "x.lp".',
    "a choice that nobody offers": "#program house.\n:- pick(nothing,1).",
    "a name that nothing derives": "#program house.\n:- rom(0,hall).",
    "a name that nothing uses": "#program house.\nlonely(R) :- room(R,hall).",
    "a misspelt type": "#program house.\n:- room(_,hal).",
    "a misspelt side": "#program house.\n:- window(_,nroth).",
    "a name in no fact": "#program house.\n:- room(0,cellar), room(1,cellar).",
    "a number that is read as another": "#program house.\n:- rooms > 4294967298, room(0,hall).",
    "a type that is no word": "type(3). empty(3). opens(hall,3).",
}


def on_the_command_line(text: str) -> str:
    """Return a reason of the page in Python's words: ``--rooms 3`` for ``rooms: 3``."""
    name, _, count = text.partition(": ")
    return f"--rooms {count}" if name == "rooms" else re.sub(r"^(\w+): (\d.*)$", r"--type \1=\2", text)


def asked(page: Page, files: Mapping[str, str], rooms: int, types: Mapping[str, int]) -> tuple[str, Any]:
    """Return the kind of an answer of the page, and the answer: houses, an error's place, or a proof."""
    request = {"rooms": rooms, "types": types, "furniture": {}, "seed": 1, "count": 1}
    *_, last = answered(page, "home", files, request)
    if "findings" in last:
        found = last["findings"][0]
        return "mistake", f"{found['file']}:{found['line']}:{found['column']}: {found['text']}"
    if "problem" in last:
        return "proof", {on_the_command_line(each["text"]) for each in last["problem"]["reasons"]}
    return "house", last["house"]


def made(folder: Path, files: Mapping[str, str], rooms: int, types: Mapping[str, int]) -> tuple[str, Any]:
    """Return the kind of Python's answer, and the answer."""
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    try:
        [house] = in_process.generate(rooms, types=types, grammar=folder, seed=1)
    except GrammarError as error:
        return "mistake", str(error).removeprefix(f"{folder}/").removeprefix(f"{SHIPPED}/")
    except Unsatisfiable as error:
        return "proof", {reason.text for reason in error.reasons}
    return "house", json.loads(json.dumps(house.converted().to_dict()))


PROOFS = {
    name: (proofs.ROOMS + (f"#program house.\n{rule}\n" if rule else ""), types)
    for name, (rule, types, expected) in proofs.CASES.items()
    if any("is not stated" in each or each.startswith("central") for each in expected)
}
PLANS = (
    "two rows",
    "a courtyard",
    "a courtyard without an order of its walls",
    "a courtyard that rooms enclose",
    "outer walls everywhere",
    "a misspelt outline",
    "a misspelt choice",
    "rooms that face what is none",
    "doors nowhere",
    "a wall too many",
    "walls with no order",
    "turns that are no number",
)


def test_where_a_fact_is_missing_the_page_has_the_proof_of_python(opened, tmp_path):
    for number, (name, (text, types)) in enumerate(PROOFS.items()):
        files = {"rooms.lp": text, "sizes.pl": proofs.SIZES}
        answer = asked(opened, files, 3, types)
        assert answer == made(tmp_path / str(number), files, 3, types), name
        assert answer[0] == "proof"


def test_a_topology_of_the_user_s_makes_the_houses_of_python_or_is_refused_at_the_same_line(opened, tmp_path):
    kinds = []
    for number, name in enumerate(PLANS):
        text, rooms, _ = TOPOLOGIES[name]
        files = {"rooms.lp": RULES, "sizes.pl": SIZES, "mine.lp": text}
        kind, answer = asked(opened, files, rooms, {})
        expected, python = made(tmp_path / str(number), files, rooms, {})
        kinds.append(kind)
        assert kind == expected, name
        if kind == "house":
            assert not check(House.from_dict(answer)), name
            assert answer["rooms"] == python["rooms"], name
        else:
            assert answer == python, name
    assert {*kinds} == {"house", "proof", "mistake"}


STARS: tuple[tuple[int, dict[str, int]], ...] = (
    (3, {"bathroom": 2}),
    (2, {"kitchen": 3}),
    (4, {"hall": 4}),
)
"""Rooms and types for which `family` has no house; the last has several conflicts, one of them smallest."""


def test_proofs_of_stars_have_the_fewest_reasons_as_those_of_python(opened, tmp_path):
    files = {file.name: file.read_text() for file in (SHIPPED / "family").glob("*.[lp][lp]")}
    for number, (rooms, types) in enumerate(STARS):
        assert asked(opened, files, rooms, types) == made(tmp_path / str(number), files, rooms, types)


def test_the_area_of_a_star_is_what_python_makes_of_it(opened, tmp_path):
    files = {file.name: file.read_text() for file in (SHIPPED / "family").glob("*.[lp][lp]")}
    files["area.pl"] = "house_area(60.0, 61.0)."
    kind, answer = asked(opened, files, 3, {})
    assert (kind, answer["rooms"]) == ("house", made(tmp_path / "mine", files, 3, {})[1]["rooms"])


UNKNOWN: tuple[dict[str, dict[str, int]], ...] = (
    {"types": {"kitchn": 1}, "furniture": {}},
    {"types": {}, "furniture": {"bedroom.bd": 1}},
    {"types": {}, "furniture": {"kitchn.table": 1}},
    {"types": {}, "furniture": {"sofaa": 1}},
)


def test_names_in_a_link_that_the_grammar_does_not_have_are_refused_in_words(opened):
    files = {file.name: file.read_text() for file in (SHIPPED / "family").glob("*.[lp][lp]")}
    for counts in UNKNOWN:
        request = {"rooms": 2, "seed": 0, "count": 1, **counts}
        *_, last = answered(opened, "family", files, request)
        with pytest.raises(RequestError) as refused:
            next(
                in_process.generate(2, grammar="family", types=counts["types"], furniture=counts["furniture"])
            )
        assert last["problem"]["message"] == str(refused.value)


def test_what_python_refuses_to_load_makes_no_house_in_the_page(opened, tmp_path):
    for number, (name, rule) in enumerate(MISTAKES.items()):
        files = {"rooms.lp": f"{proofs.ROOMS}{rule}\n", "sizes.pl": proofs.SIZES}
        kind, answer = asked(opened, files, 3, {})
        folder = tmp_path / str(number)
        folder.mkdir()
        for file, text in files.items():
            (folder / file).write_text(text)
        python = [f"{error.line}:{error.column}: {error.text}" for error in findings(find(folder))]
        assert kind == "mistake", name
        said = re.sub(r"a constraint, which has no head.*", "", answer)  # Python prints which one.
        assert any(f"rooms.lp:{each}".startswith(said) for each in python), (name, answer, python)


def test_names_are_taken_for_those_that_python_takes_them_for(opened):
    topologies = bundle()["topologies"]
    assert isinstance(topologies, dict)
    names = sorted({each.split("/")[0] for each in topologies["ring"]["known"]})
    misspelt = [name[:place] + name[place + 1 :] for name in names for place in (0, len(name) // 2)]
    misspelt += [one[:3] + other[-3:] for one, other in itertools.pairwise(names)]
    found = opened.evaluate(
        """async ([misspelt, names]) => {
            const { closest } = await import("./solver/spelling.js");
            return misspelt.map((name) => closest(name, names));
        }""",
        [misspelt, names],
    )
    assert found == [closest(name, names) or "" for name in misspelt]


def test_files_that_include_others_are_read_in_the_page_as_by_python(opened, tmp_path):
    family = {
        "rooms.lp": "".join(
            f"{LP.format(f'family/{name}.lp')}\n" for name in ("rooms", "furniture", "arrangement")
        ),
        "sizes.pl": f"% nothing else\n{PL.format('family/sizes.pl')}",
    }
    cases = {
        title: {"rooms.lp": proofs.ROOMS, "sizes.pl": proofs.SIZES} | files
        for title, (files, *_) in WRONG.items()
        if "/" not in "".join(files)
    }
    cases["a mistake below an include"] = family | {
        "rooms.lp": f"{family['rooms.lp']}#program house.\n:- rom(0,hall).\n"
    }
    cases["a mistake of syntax below an include"] = family | {
        "rooms.lp": f"{family['rooms.lp']}mine(1)).\nmine(2).\n"
    }
    cases["a mistake of lengths below an include"] = family | {
        "sizes.pl": f"{family['sizes.pl']}\n  mine(1).\n"
    }
    cases["a fact that contradicts a shipped file"] = family | {"a.lp": "may(bedroom,bed,3,4)."}
    cases["a length that contradicts a shipped file"] = family | {"a.pl": "\nroom_gap(9.0)."}
    for number, (title, files) in enumerate(cases.items()):
        if not all(text.isprintable() for text in "".join(files.values()).split("\n")):
            continue  # The page shows such text unescaped.
        answer = asked(opened, files, 3, {})
        assert answer == made(tmp_path / str(number), files, 3, {}), title
        assert answer[0] == "mistake"
    kind, house = asked(opened, family, 3, {})
    expected = made(tmp_path / "family", family, 3, {})
    assert kind == "house"
    assert house["provenance"]["grammar_hash"] == find(tmp_path / "family").hash
    assert house["rooms"] == expected[1]["rooms"]
