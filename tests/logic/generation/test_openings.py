"""Openings between rooms: doors without a leaf, of the grammar's width, judged by geometry."""

import shutil
from itertools import product
from pathlib import Path

import pytest
from msgspec import structs

from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.drawing.door_leaves import door_leaves
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.exports.solids import solids
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.boxes import Box, distance
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.brief import read_brief
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan

OPEN = "opening(living,(kitchen;dining)).\n"
PAIRS = [{"living", "kitchen"}, {"living", "dining"}]
WIDE = "opening_size(_, _, L, Wall) :- { L >= 1.4, L =< Wall - 0.2 }.\n"
"""Bounds that are written again below."""

TINY = """
topology(ring).  type(hall;bath).  empty(hall;bath).  central(hall).
opens(outside,hall).  opens(hall,bath).  opening(hall,bath).
#program house.
:- not room(_,bath).
"""
TINY_SIZES = """
room_size(_, W, D) :- { W >= 1.6, W =< 3.2, D >= 1.6, D =< 3.2 }.
room_area(bath, 3.0, 4.6).
opening_size(bath, hall, L, _) :- { L >= 3.1, L =< 3.15 }.
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
"""


def grammar(folder: Path, sizes: str = "", rules: str = "") -> Path:
    """Write a copy of home whose living rooms are open to kitchens and dining rooms."""
    shutil.copytree(SHIPPED / "home", folder)
    (folder / "open.lp").write_text(OPEN + rules)
    (folder / "open.pl").write_text(sizes)
    return folder


@pytest.fixture(scope="module")
def builder(tmp_path_factory: pytest.TempPathFactory) -> Builder:
    """Return a builder for homes with openings of some width in every kitchen.

    A process has one grammar, so the tests that load others come last.
    """
    kitchen = "#program house.\n:- room(R,kitchen), room(Q,living), not linked(R,Q).\n"
    return Builder(find(grammar(tmp_path_factory.mktemp("open") / "wide", WIDE, kitchen)))


def shared(house: House, door: Door) -> float:
    """Return the length of the wall that the rooms of a door share, metres."""
    one, other = (house.room(name).box for name in door.between)
    across = int(door.height == 0)
    return min(one[3 - across], other[3 - across]) - max(one[1 - across], other[1 - across])


def types(house: House, door: Door) -> set[str]:
    return {OUTSIDE if name == OUTSIDE else house.room(name).type for name in door.between}


def as_drawn(house: House) -> set[tuple[frozenset[str], Box, bool]]:
    """Return for each door the rooms that it joins, in any order, its place, and True if it is an opening."""
    return {(frozenset(door.between), door.box, door.opening) for door in house.doors}


def made(builder: Builder, seeds: range, rooms: tuple[int, ...] = (5, 8)) -> list[House]:
    return [builder.house(HouseRequest(n), seed, 0) for seed, n in product(seeds, rooms)]


def test_doors_between_such_rooms_are_openings_as_wide_as_they_are_to_be(builder: Builder) -> None:
    for house in made(builder, range(4)):
        assert check(house) == []
        opened = [door for door in house.doors if door.opening]
        assert opened == [door for door in house.doors if types(house, door) in PAIRS]
        assert any("kitchen" in types(house, door) for door in opened)
        for door in opened:
            assert 1.4 - 1e-6 <= door.length <= shared(house, door) - 0.2 + 1e-5
        for door in house.doors:
            assert door.opening or door.length == pytest.approx(0.8)


def test_a_plan_s_own_doors_stay_as_they_are_drawn(builder: Builder) -> None:
    (house,) = made(builder, range(1), (5,))
    kept = OwnPlan(house.rooms, house.doors, house.windows)
    again = builder.house(HouseRequest(5, plan=kept), 1, 0)
    assert as_drawn(again) == as_drawn(house)
    shut = tuple(structs.replace(door, opening=False) for door in house.doors)
    house = builder.house(HouseRequest(5, plan=OwnPlan(house.rooms, shut)), 1, 0)
    assert not any(door.opening for door in house.doors)
    assert check(house) == []
    walls = OwnPlan(house.rooms)
    for seed in range(3):
        other = builder.house(HouseRequest(5, plan=walls), seed, 0)
        assert check(other) == []
        assert all(door.opening == (types(other, door) in PAIRS) for door in other.doors)
        assert all(door.length >= 1.4 - 1e-6 for door in other.doors if door.opening)


def test_what_stands_downstream_knows_that_an_opening_has_no_leaf(builder: Builder) -> None:
    (house,) = made(builder, range(1), (8,))
    opened = [door for door in house.doors if door.opening]
    shut = [door for door in house.doors if not door.opening]
    assert len(door_leaves(house)) == len(shut)
    features = [each["properties"] for each in to_geojson(house)["features"]]
    stated = [each["between"] for each in features if each.get("opening")]
    assert stated == [door.between for door in opened]
    walls = [each.box for each in solids(house) if each.kind == "wall"]
    for door in opened:
        (west, north, east, south), thick = door.box, 0.06
        inside = (west + thick, north, east - thick, south)
        if door.height:
            inside = (west, north + thick, east, south - thick)
        assert not [wall for wall in walls if distance(wall, inside) == 0]


def test_a_brief_s_doors_are_openings_too(builder: Builder) -> None:
    rooms = [{"name": name, "type": name} for name in ("living", "kitchen", "bedroom", "bathroom", "hall")]
    brief = read_brief({"rooms": rooms, "doors": [["living", "kitchen"], ["hall", "living"]]})
    house = Builder(builder.grammar).house(HouseRequest(5, brief=brief), 0, 0)
    assert check(house) == []
    opened = {frozenset(door.between): door.length for door in house.doors if door.opening}
    assert opened[frozenset({"living", "kitchen"})] >= 1.4 - 1e-6
    assert frozenset({"hall", "living"}) not in opened


def test_on_a_grid_openings_are_whole_cells(builder: Builder) -> None:
    for house in made(Builder(builder.grammar, cell=0.1), range(2)):
        for door in house.doors:
            if door.opening:
                assert door.length >= 1.4 - 1e-6
                assert 10 * door.length == pytest.approx(round(10 * door.length))


def test_without_a_size_there_is_no_wall_where_rooms_meet(tmp_path: Path) -> None:
    for house in made(Builder(find(grammar(tmp_path / "mine"))), range(4)):
        assert check(house) == []
        for door in house.doors:
            if door.opening:
                assert door.length == pytest.approx(shared(house, door))


def test_a_proof_names_the_size_of_an_opening_that_the_rooms_are_too_small_for(tmp_path: Path) -> None:
    """A bath of 4.6 m² is at most 2.9 m long; its opening would take 3.1 m."""
    (tmp_path / "rooms.lp").write_text(TINY)
    (tmp_path / "sizes.pl").write_text(TINY_SIZES)
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(Builder(find(tmp_path)), HouseRequest(2), 0, 0)
    reasons = " ".join(reason.text for reason in caught.value.reasons)
    assert all(each in reasons for each in ("opening_size(bath", "room_area(bath", "opening(hall,bath)"))


def test_an_opening_that_a_plan_has_stays_one_whatever_the_grammar_says(builder: Builder) -> None:
    (house,) = made(Builder(builder.grammar), range(1), (5,))
    drawn = OwnPlan(house.rooms, house.doors, house.windows)
    again = Builder(find("home")).house(HouseRequest(5, plan=drawn), 0, 0)
    assert check(again) == []
    assert any(door.opening for door in again.doors)
    assert as_drawn(again) == as_drawn(house)


def test_a_proof_names_the_door_that_a_plan_has_where_a_rule_asks_for_an_opening(tmp_path: Path) -> None:
    (tmp_path / "rooms.lp").write_text(TINY + ":- room(R,bath), not open_to(R,Q) : room(Q,hall).\n")
    sizes = TINY_SIZES.replace("L, _) :- { L >= 3.1, L =< 3.15 }", "L, Wall) :- { L >= 0.8, L =< Wall }")
    (tmp_path / "sizes.pl").write_text(sizes)
    builder = Builder(find(tmp_path))
    house = builder.house(HouseRequest(2), 0, 0)
    assert [door.opening for door in house.doors if not door.is_entrance] == [True]
    shut = tuple(structs.replace(door, opening=False) for door in house.doors)
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(builder, HouseRequest(2, plan=OwnPlan(house.rooms, shut)), 0, 0)
    reasons = [reason.text for reason in caught.value.reasons]
    assert any("plan: a door joins" in text for text in reasons)
    assert any("open_to" in text for text in reasons)
