"""A proof that a plan is impossible has as few statements as suffice."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.logic.request.test_given_plan import BOXES, Box, geojson, made
from vitruvius.logic import House, Unsatisfiable
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find

TYPED = {"hall": "hall", "living": "living", "kitchen": "kitchen", "bath": "bathroom", "bedroom": "bedroom"}

CASES: dict[str, tuple[dict[str, Box], dict[str, str], dict[str, Any], list[str]]] = {
    "a hall too narrow": (
        {"living": (0, 0, 5.2, 4), "hall": (5.2, 0, 6, 4)},
        {},
        {},
        ["plan: hall is 0.80", "plan: hall is of type hall", "room_size(hall,"],
    ),
    "a bathroom too thin": (
        {"bath": (6, 3, 8.4, 4)},
        {},
        {},
        ["plan: bath is 2.40", "plan: bath is of type bathroom", "room_size(bathroom,"],
    ),
    "a kitchen too small in area": (
        {"kitchen": (6, 1.2, 7.6, 3)},
        {},
        {},
        ["plan: kitchen is 1.60", "plan: kitchen is of type kitchen", "room_area(kitchen,"],
    ),
    "a room that is no living room": (
        {},
        {"bath": "living"},
        {},
        ["plan: bath is 2.40", "plan: bath is of type living", "room_size(living,"],
    ),
    "a count against the plan": (
        {},
        {},
        {"types": {"bedroom": 2}},
        ["--type bedroom=2", *(f"plan: {room} is of type" for room in ("hall", "living", "kitchen", "bath"))],
    ),
}


@pytest.mark.parametrize("title", CASES)
def test_a_proof_has_as_few_lines_as_suffice(title: str, home: Builder) -> None:
    boxes, types, request, lines = CASES[title]
    with pytest.raises(Unsatisfiable) as caught:
        made(home, geojson(BOXES | boxes, **(TYPED | types)), **request)
    found = [each.text for each in caught.value.reasons]
    assert len(found) == len(lines), found
    assert all(any(line in text for text in found) for line in lines), found


HOTEL = Path(__file__).parents[3] / "examples" / "hotel"

FURNISHED: dict[str, tuple[Path, str, str, dict[str, Box], dict[str, str], list[str]]] = {
    "a wardrobe longer than its room": (
        SHIPPED / "home",
        "piece_size(wardrobe, L, D, _) :- {",
        "L >= 4.1, L =< 4.3, D >= 0.58, D =< 0.65 }.",
        BOXES,
        TYPED,
        ["plan: bedroom is 4.00 by 3.50", "plan: bedroom is of type bedroom", "may(bedroom,wardrobe,"],
    ),
    "a washbasin for a school": (
        SHIPPED / "home",
        "piece_size(sink, L, D, _) :- {",
        "L >= 2.5, L =< 2.6, D = 0.5 }.",
        BOXES,
        TYPED,
        ["plan: bath is 2.40 by 2.20", "plan: bath is of type bathroom", "may(bathroom,sink,"],
    ),
    "a stove for a canteen": (
        SHIPPED / "home",
        "piece_size(stove, L, D, _) :- {",
        "L = 2.9, D = 2.8 }.",
        BOXES,
        TYPED,
        ["plan: kitchen is 3.00 by 3.00", "plan: kitchen is of type kitchen", "may(kitchen,stove,"],
    ),
    "a basin for a surgery": (
        SHIPPED / "clinic",
        "piece_size(basin, L, D, _) :- {",
        "L = 2.3, D = 2.0 }.",
        {"desk": (0, 0, 5, 5), "doctor": (5, 0, 9.8, 5), "wc": (0, 5, 2.2, 7.4)},
        {"desk": "reception", "doctor": "consulting", "wc": "washroom"},
        ["plan: wc is 2.20 by 2.40", "plan: wc is of type washroom", "may(washroom,basin,"],
    ),
    "a shower for a team": (
        HOTEL,
        "piece_size(shower, L, D, _) :- {",
        "L >= 2.1, L =< 2.2, D = L }.",
        {
            "floor": (0, 0, 10, 1.5),
            **{f"room {n}": (5 * n, 1.5, 5 * n + 3, 5.5) for n in (0, 1)},
            **{f"bath {n}": (5 * n + 3, 1.5, 5 * n + 5, 5.5) for n in (0, 1)},
        },
        {"floor": "corridor"}
        | {f"{name} {n}": type_ for n in (0, 1) for name, type_ in (("room", "guest"), ("bath", "bath"))},
        ["plan: bath 0 is 2.00 by 4.00", "plan: bath 0 is of type bath", "may(bath,shower,"],
    ),
}
"""A grammar, a clause to edit, a plan, and the proof's lines besides that clause and clearances."""

CLEARANCES = ("passage(", "door_clearance(", "door_width(")


def edited(folder: Path, pattern: str, text: str) -> None:
    """Replace a text that occurs once in the rules of a folder, with any spaces."""
    spaced = r"\s*".join(map(re.escape, re.findall(r"\w+|[^\w\s]", pattern)))
    changed = 0
    for file in (*folder.glob("*.pl"), *folder.glob("*.lp")):
        rules, count = re.subn(spaced, lambda _: text, file.read_text())
        file.write_text(rules)
        changed += count
    assert changed == 1, pattern


def test_where_the_shortest_proof_takes_too_long_another_one_is_found(
    home: Builder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The proof is irreducible, too: the search for the shortest ends at its first conflict."""
    monkeypatch.setattr("vitruvius.logic.proofs.least.MOST_CONFLICTS", 1)
    boxes, types, request, lines = CASES["a room that is no living room"]
    with pytest.raises(Unsatisfiable) as caught:
        made(home, geojson(BOXES | boxes, **(TYPED | types)), **request)
    found = [each.text for each in caught.value.reasons]
    assert all(any(line in text for text in found) for line in lines), found


@pytest.mark.second_part("a large plan")
def test_a_plan_of_far_more_rooms_than_there_can_be_is_proved_impossible_in_few_lines(home: Builder) -> None:
    """Each room is needed, since any of them could be the living room if it were larger."""
    boxes = {f"{x} {y}": (1.9 * x, 1.9 * y, 1.9 * x + 1.9, 1.9 * y + 1.9) for x in range(5) for y in range(6)}
    with pytest.raises(Unsatisfiable) as caught:
        made(home, geojson(boxes))
    plan, *rules = [each.text for each in caught.value.reasons]
    assert re.fullmatch(r"plan: \d \d is 1.90 by 1.90 m at .*, and \d\d more that it says of its rooms", plan)
    assert 2 <= len(rules) <= 5


def test_of_the_statements_of_a_large_plan_those_are_named_that_matter_if_they_are_few(
    home: Builder, monkeypatch: pytest.MonkeyPatch
) -> None:
    boxes, types, request, lines = CASES["a hall too narrow"]
    plan = geojson(BOXES | boxes, **(TYPED | types))
    for most, expected in ((2, lines[:2]), (1, ["and 1 more that it says of its rooms"])):
        monkeypatch.setattr("vitruvius.logic.proofs.least.MOST_NAMED", most)
        with pytest.raises(Unsatisfiable) as caught:
            made(home, plan, **request)
        found = [each.text for each in caught.value.reasons if each.text.startswith("plan:")]
        assert len(found) == len(expected), found
        assert all(line in text for line, text in zip(expected, found, strict=True)), found


# Last, because it loads other grammars than `home` into this process.
@pytest.mark.second_part("many proofs")
@pytest.mark.parametrize("title", FURNISHED)
def test_a_proof_that_a_room_is_too_small_for_its_furniture_is_of_that_room_alone(
    title: str, tmp_path: Path
) -> None:
    """The proof names the piece's size and necessity, the room's size and type, and free zones in it."""
    grammar, size, body, boxes, types, lines = FURNISHED[title]
    folder = shutil.copytree(grammar, tmp_path / "mine")
    edited(folder, size, f"{size} {body} %")
    plan = geojson(boxes, **types)
    with pytest.raises(Unsatisfiable) as caught:
        made(Builder(find(folder)), plan)
    found = [each.text for each in caught.value.reasons]
    known = (*lines, size.partition(" :-")[0])
    assert all(any(text.startswith(line) for text in found) for line in known), found
    assert all(text.startswith((*known, *CLEARANCES)) for text in found), found
    edited(folder, f"{lines[2]}1,", f"{lines[2]}0,")
    assert isinstance(made(Builder(find(folder)), plan), House)
