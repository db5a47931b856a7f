"""Explanations of parts of a house by a brief: the lines of the brief that bind, and no internal errors."""

from time import monotonic
from typing import Any

import pytest

from tests.logic.workers import in_process
from vitruvius.logic.house.part_names import doors_by_name
from vitruvius.logic.request.brief import read_brief
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.answer import Why
from vitruvius.logic.why.witness import Witness
from vitruvius.logic.why.witnesses import witness_of

WANTED: dict[str, Any] = {
    "rooms": [
        {"name": "Hall", "area": [4, 8]},
        {"name": "Living room", "area": 24, "outside": ["south"], "size": [[3, 9], [3, 9]]},
        {"name": "Kitchen", "area": 9},
        {"name": "Bath", "area": 5},
    ],
    "doors": [["Hall", "Living room"], ["Hall", "Bath"], ["Living room", "Kitchen"]],
    "next_to": [["Kitchen", "Bath"]],
    "entrance": "Hall",
}

ROOMS = [room["name"] for room in WANTED["rooms"]]


@pytest.fixture(scope="module")
def witness() -> Witness:
    builder = in_process.builder("plain")
    house = builder.house(HouseRequest(4, brief=read_brief(WANTED)), 1, 0)
    return witness_of(builder, house)


def answer(witness: Witness, target: str) -> Why:
    """Return the whole answer that is found in a second."""
    first, *more = witness.parts(target, until=monotonic() + 1)
    for part in more:
        first = first.joined(part)
    return first


def test_every_part_has_an_answer_with_what_could_be_instead(witness: Witness) -> None:
    named = {name: answer(witness, name) for name in [*ROOMS, *doors_by_name(witness._house)]}
    assert "entrance" in named
    assert all(each.about for each in named.values())
    assert any(each.choices for each in named.values())


def test_the_lines_of_the_brief_are_among_the_bounds_of_a_room(witness: Witness) -> None:
    (width, height) = answer(witness, "Living room").lengths
    line = "brief: Living room measures 3 to 9 m by 3 to 9 m"
    assert line in {reason.text for reason in width.no_less}
    assert line in {reason.text for reason in height.no_less}
