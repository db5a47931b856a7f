"""Typical rules of a grammar give way to the user's statements about rooms; the others do not."""

import warnings
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from tests.logic.generation.test_shared_walls import copied
from tests.logic.request.test_given_plan import BOXES, Box, geojson
from tests.logic.workers.in_process import builder, generate
from vitruvius.logic import GrammarWarning, Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.language.linter import findings
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.proofs.giving_way import without
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.witnesses import witness_of

pytestmark = pytest.mark.second_part("many flats are furnished")

ROOMS = {"hall": "hall", "living": "living", "kitchen": "kitchen", "bath": "bathroom", "bedroom": "bedroom"}
"""Types of the rooms of ``BOXES``."""


def brief(doors: str, **rooms: Any) -> dict[str, Any]:
    """Return a brief of rooms, each with its type and its area or two sides, and pairs with doors."""
    wanted = []
    for name, (type_, *measures) in rooms.items():
        size = {"size": measures} if len(measures) == 2 else {"area": measures[0]}
        wanted.append({"name": name, "type": type_, **size})
    first = next(iter(rooms))
    return {"rooms": wanted, "doors": [pair.split("-") for pair in doors.split()], "entrance": first}


def made(home: Builder, stated: dict[str, Any]) -> House:
    return house_or_proof(home, HouseRequest.read({"rooms": len(stated["rooms"]), "brief": stated}), 0, 0)


ONE_BEDROOM = brief(
    "hall-living hall-bedroom hall-bath hall-store living-kitchen",
    hall=("hall", (4, 7)),
    living=("living", (17, 20)),
    kitchen=("kitchen", (6, 8)),
    bedroom=("bedroom", (11.5, 14)),
    bath=("bathroom", (4.4, 5.5)),
    store=("storage", (1.5, 2.5)),
)
FLATS: dict[str, tuple[dict[str, Any], set[str]]] = {
    "a long hall with five doors": (
        brief(
            "hall-living hall-kitchen hall-main hall-child hall-bath",
            hall=("hall", (1.1, 1.4), (6, 9)),
            living=("living", (20, 26)),
            kitchen=("kitchen", (8, 11)),
            main=("bedroom", (12, 16)),
            child=("bedroom", (9, 12)),
            bath=("bathroom", (4, 6)),
        ),
        {"degree(hall,1,4).", "room_area(hall, 3.2, 8.5)."},
    ),
    "a shared flat without a living room, whose areas are hard to decide": (
        brief(
            "hall-one hall-two hall-three hall-four hall-kitchen hall-bath hall-wc",
            hall=("hall", (8, 14)),
            one=("bedroom", (12, 16)),
            two=("bedroom", (12, 16)),
            three=("bedroom", (12, 16)),
            four=("bedroom", (12, 16)),
            kitchen=("kitchen", (12, 18)),
            bath=("bathroom", (5, 8)),
            wc=("wc", (1.3, 2)),
        ),
        {"degree(hall,1,4).", ":- { room(R,living) } != 1."},
    ),
    "a loft of 65 m² without a hall": (
        brief(
            "loft-bath loft-bedroom loft-kitchen",
            loft=("living", (55, 75)),
            bath=("bathroom", (5, 8)),
            bedroom=("bedroom", (14, 20)),
            kitchen=("kitchen", (10, 15)),
        ),
        {"room_area(living, 15.0, 30.0)."},
    ),
}


@pytest.mark.parametrize("name", FLATS)
def test_an_ordinary_flat_has_a_house_and_says_which_typical_rules_gave_way(home: Builder, name: str) -> None:
    stated, gone = FLATS[name]
    house = made(home, stated)
    assert house.provenance
    assert gone <= {rule.split(": ", 1)[1] for rule in house.provenance.gave_way}
    assert all(
        rule.startswith(("rooms.lp:", "sizes.pl:", "lengths.pl:")) for rule in house.provenance.gave_way
    )
    assert check(house) == []


def test_what_must_be_kept_refutes_a_brief_by_itself(home: Builder) -> None:
    stated = brief(
        "hall-bath bath-bedroom hall-living",
        hall=("hall", (4, 6)),
        living=("living", (18, 24)),
        bedroom=("bedroom", (10, 14)),
        bath=("bathroom", (4, 6)),
    )
    stated["no_doors"] = [["hall", "bedroom"], ["living", "bedroom"]]
    with pytest.raises(Unsatisfiable, match=r"opens\(bathroom,any_other_type\) is not stated") as proof:
        made(home, stated)
    assert not any(reason.typical for reason in proof.value.reasons)


def test_counts_of_types_are_stated_and_a_number_of_rooms_is_not(home: Builder) -> None:
    house = house_or_proof(home, HouseRequest(6, {"bedroom": (1, 1)}), 0, 0)
    assert [room.type for room in house.rooms].count("bedroom") == 1
    with pytest.raises(Unsatisfiable) as proof:
        house_or_proof(home, HouseRequest(3), 0, 0)
    assert any(reason.typical for reason in proof.value.reasons)
    assert " (typical)" in str(proof.value)


def test_of_a_house_of_units_the_rule_that_contradicts_a_count_alone_gives_way() -> None:
    house = house_or_proof(builder("apartments"), HouseRequest(8, {"bedroom": (0, 0)}), 0, 0)
    assert house.provenance
    (rule,) = house.provenance.gave_way
    assert rule.endswith(": :- rooms >= 5, { room(R,bedroom) } < (rooms+1)/4.")


def test_a_house_is_explained_by_the_rules_that_were_left(home: Builder) -> None:
    house = made(home, ONE_BEDROOM)
    assert house.provenance
    request = HouseRequest.read(house.provenance.request)
    left = without(home, request, house.provenance.gave_way)
    assert ":- { room(R,bedroom) } < (rooms+2)/4." in {rule.text for rule in left.grammar.gave_way}
    found = witness_of(left, house).why("bedroom", until=0)
    assert found.target == "bedroom"


def test_generate_warns_of_each_rule_that_gave_way_once() -> None:
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        list(generate(6, types={"bedroom": 1}, grammar="home", count=2))
    assert [str(each.message).partition(": rooms.lp")[0] for each in said] == [
        "home: a typical rule gives way to the counts of types"
    ]
    assert issubclass(said[0].category, GrammarWarning)


def outer_doors(house: House) -> list[str]:
    return [
        name for door in house.doors if OUTSIDE in door.between for name in door.between if name != OUTSIDE
    ]


def plan_with(home: Builder, boxes: dict[str, Box], *outer: tuple[str, float, float, float, float]) -> House:
    """Return a house in a plan with these doors that lead outside: a room, and x, y, width and height."""
    plan = read_plan(geojson(boxes, **ROOMS))
    doors = tuple(Door(x, y, width, height, (name, OUTSIDE)) for name, x, y, width, height in outer)
    plan = read_plan(replace(plan, doors=doors, has_more_doors=True))
    return house_or_proof(home, HouseRequest(len(plan.rooms), plan=plan), 0, 0)


DRAWN = (
    Door(4.0, 5.0, 0.0, 0.65, ("hall", "living")),
    Door(4.5, 3.5, 0.65, 0.0, ("hall", "bedroom")),
    Door(6.0, 6.0, 0.0, 0.65, ("hall", "kitchen")),
    Door(6.0, 3.55, 0.0, 0.6, ("hall", "bath")),
    Door(4.5, 7.5, 0.8, 0.0, ("hall", OUTSIDE)),
)
SHORT_WALL: dict[str, Box] = BOXES | {"kitchen": (6, 0, 9, 3.3), "bath": (6, 3.3, 8.4, 5.5)}
"""Rooms of a plan in which hall and bath share 0.7 m of wall."""
PLANS: dict[str, tuple[dict[str, Box], dict[str, Any], set[str]]] = {
    "narrow doors, one in a short wall": (SHORT_WALL, {"doors": DRAWN}, {"door_width(0.8)."}),
    "a window in the living room alone": (
        BOXES,
        {"windows": (Window(0.0, 4.5, 0.0, 1.2, "living"),)},
        {"lit(bedroom).", "lit(kitchen)."},
    ),
    "a wall too short for a door of 0.8 m": (
        BOXES | {"living": (0, 0, 5.05, 4), "hall": (5.05, 0, 6, 4)},
        {},
        {"door_width(0.8)."},
    ),
    "a bedroom of 33 m²": (BOXES | {"bedroom": (0, 4, 6, 9.5)}, {}, {"room_area(bedroom, 8.0, 20.0)."}),
}


@pytest.mark.parametrize("name", PLANS)
def test_what_a_plan_draws_stays_and_the_typical_rules_against_it_give_way(home: Builder, name: str) -> None:
    boxes, drawn, gone = PLANS[name]
    plan = replace(read_plan(geojson(boxes, **ROOMS)), **drawn)
    house = house_or_proof(home, HouseRequest(len(plan.rooms), plan=plan), 0, 0)
    assert house.provenance
    assert gone <= {rule.split(": ", 1)[1] for rule in house.provenance.gave_way}
    assert {door.box for door in plan.doors} <= {door.box for door in house.doors}
    assert check(house) == []


FRONT, GARDEN = ("hall", 4.5, 7.5, 0.9, 0.0), ("living", 0.0, 4.0, 0.0, 0.9)


def test_a_second_outer_door_is_a_garden_door(home: Builder) -> None:
    house = plan_with(home, BOXES, GARDEN, FRONT)
    assert outer_doors(house) == ["hall", "living"]  # the entrance is the hall's
    assert [door.box for door in house.garden_doors] == [(0.0, 4.0, 0.0, 4.9)]
    assert check(house) == []


def test_two_garden_doors_of_one_room_stay_where_they_are(home: Builder) -> None:
    house = plan_with(
        home, BOXES, FRONT, GARDEN, ("living", 0.0, 6.0, 0.0, 0.9), ("bedroom", 2.5, 0.0, 0.9, 0.0)
    )
    assert outer_doors(house) == ["hall", "living", "living", "bedroom"]
    assert check(house) == []


def test_lint_reads_both_kinds_of_rules(tmp_path: Path) -> None:
    folder = copied(
        tmp_path,
        ("rooms.lp", "#program typical.", "#program typicl."),
    )
    assert any("did you mean typical?" in each.text for each in findings(find(folder)))


def test_lint_judges_the_limits_behind_typical_sizes(tmp_path: Path) -> None:
    folder = copied(
        tmp_path, ("sizes.pl", "limit(room_area(wc,         0.9,  30.0)).", "limit(room_area(wc, 90, 99)).")
    )
    (found,) = [each for each in findings(find(folder)) if each.severity == "error"]
    assert "room_area(wc" in found.text
