"""Briefs, grammars and plans read off a house, at its limits, have a house, so a proof would be false."""

from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from benchmarks.briefs.at_limits import planted
from benchmarks.briefs.attempts import attempt
from benchmarks.briefs.planted import row_of
from benchmarks.briefs.tightened import tightened
from tests.logic.workers import in_process
from vitruvius.logic.house.house import House
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.brief import alone, read_brief
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

BRIEFS, INFERENCES = range(36), 10_000_000


def test_a_brief_that_a_plan_keeps_at_its_limits_has_a_house_that_keeps_it() -> None:
    builder = in_process.builder("plain")
    for number in BRIEFS:
        entry = planted(number, most=4)
        row = row_of(number, entry, attempt(builder, alone(entry.read)))
        assert row.said == "house", row


TERRACE = {
    "rooms": [
        {"name": "Hall", "size": [[1.0, 1.2], [3.0, 4.5]]},
        {"name": "Lounge", "size": [3.6, 4.2], "outside": ["north"], "windows": ["north"]},
        {"name": "Dining", "size": [3.6, 3.6]},
        {"name": "Kitchen", "size": [2.4, 3.4], "outside": ["south"], "windows": ["south"]},
    ],
    "doors": [["Hall", "Lounge"], ["Hall", "Dining"], ["Dining", "Kitchen"]],
    "entrance": {"room": "Hall", "side": "north"},
    "outline": {
        "width": [4.6, 5.2],
        "voids": [{"corner": "south-west", "width": [1, 3], "depth": [3, 8]}],
    },
}
"""Sizes only: a linear system that CLP(R) refutes and CLP(Q) solves."""

HALVES = {
    "rooms": [{"name": name, "area": [13.5, 20]} for name in "AB"],
    "outline": {"width": 3, "depth": 9},
}
"""Two rooms that need exactly the available area."""


@pytest.mark.parametrize("brief", [TERRACE, HALVES])
def test_of_exact_sizes_no_house_is_left_undecided(brief: dict[str, Any]) -> None:
    builder = in_process.builder("plain")
    assert attempt(builder, alone(read_brief(brief))).houses


@pytest.mark.parametrize(("base", "rooms"), [("home", 5), ("plain", 3)])
def test_a_grammar_that_a_house_keeps_at_its_limits_has_a_house_and_so_has_its_plan(
    base: str, rooms: int, tmp_path: Path
) -> None:
    builder = in_process.builder(base)
    house = builder.house(HouseRequest(rooms, inferences=INFERENCES), 7, 0)
    strict = in_process.builder(tightened(builder, house, tmp_path / "mine"))
    types = {type_: (times, times) for type_, times in Counter(types_of(house)).items()}
    for request in (HouseRequest(rooms, types), HouseRequest(rooms, plan=read_plan(house))):
        again = house_or_proof(strict, replace(request, inferences=INFERENCES), 0, 0)
        assert sorted(types_of(again)) == sorted(types_of(house))


def types_of(house: House) -> list[str]:
    """Return the type of each room."""
    return [room.type for room in house.rooms]
