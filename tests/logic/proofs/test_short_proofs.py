"""A proof that a plan is impossible has as few statements as suffice."""

from typing import Any

import pytest

from logic import Unsatisfiable
from logic.generation.builder import Builder
from tests.logic.generation.test_shared_walls import builder
from tests.logic.request.test_given_plan import BOXES, Box, geojson, made

TYPED = {"hall": "hall", "living": "living", "kitchen": "kitchen", "bath": "bathroom", "bedroom": "bedroom"}

CASES: dict[str, tuple[dict[str, Box], dict[str, str], dict[str, Any], list[str]]] = {
    "a hall too narrow": (
        {"living": (0, 0, 5.1, 4), "hall": (5.1, 0, 6, 4)},
        {},
        {},
        ["plan: hall is 0.90", "plan: hall is of type hall", "room_size(hall,"],
    ),
    "a bathroom too thin": (
        {"bath": (6, 3, 8.4, 4)},
        {},
        {},
        ["plan: bath is 2.40", "plan: bath is of type bathroom", "room_size(bathroom,"],
    ),
    "a kitchen too small in area": (
        {"kitchen": (6, 1, 8.9, 3)},
        {},
        {},
        ["plan: kitchen is 2.90", "plan: kitchen is of type kitchen", "room_area(kitchen,"],
    ),
    "a room that is no living room": (
        {},
        {"bath": "living"},
        {},
        ["plan: bath is of type living", "plan: living is of type living", ":- { room(R,living) } != 1."],
    ),
    "a count against the plan": (
        {},
        {},
        {"types": {"bedroom": 2}},
        ["--type bedroom=2", *(f"plan: {room} is of type" for room in ("hall", "living", "kitchen", "bath"))],
    ),
}


@pytest.fixture(scope="module")
def home() -> Builder:
    return builder("home")


@pytest.mark.parametrize("title", CASES)
def test_a_proof_has_as_few_lines_as_suffice(title: str, home: Builder) -> None:
    boxes, types, request, lines = CASES[title]
    with pytest.raises(Unsatisfiable) as caught:
        made(home, geojson(BOXES | boxes, **(TYPED | types)), **request)
    found = [each.text for each in caught.value.reasons]
    assert len(found) == len(lines), found
    assert all(any(line in text for text in found) for line in lines), found
