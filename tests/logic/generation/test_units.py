"""Houses of units: buildings of flats along a public corridor, and proofs about them."""

import shutil
from collections import Counter
from pathlib import Path

import msgspec
import pytest

from tests.logic.workers.in_process import builder
from vitruvius.logic import GrammarError, House, RequestError, Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.unit import units_of
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.parts import OUTSIDE
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

PUBLIC = "commonCorridor"


@pytest.fixture
def apartments() -> Builder:
    return builder("apartments")


def units(house: House) -> list[set[str]]:
    """Return the names of rooms that doors join without a public room."""
    found: list[set[str]] = []
    for room in house.rooms:
        if room.type == PUBLIC:
            continue
        beyond = {name for door in house.doors if room.name in door.between for name in door.between}
        joined = [unit for unit in found if unit & beyond]
        found = [unit for unit in found if unit not in joined] + [{room.name}.union(*joined)]
    return found


@pytest.mark.second_part("large buildings")
@pytest.mark.parametrize("rooms", [8, 32])
def test_a_building_keeps_all_that_its_grammar_promises(apartments: Builder, rooms: int) -> None:
    """For other sizes see ``test_grammars.py``."""
    house = apartments.house(HouseRequest(rooms), 3, 0)
    assert check(house) == []
    assert len(house.rooms) == rooms
    assert (house.topology, house.hub, house.main.type) == ("building", "R0", PUBLIC)
    assert House.from_dict(house.to_dict()) == house


def test_a_building_promises_what_the_typical_rules_of_its_flats_state(apartments: Builder) -> None:
    promises = apartments.promises(HouseRequest(8))
    assert promises.degree == {"corridor": (4, 9), "hall": (2, 4)}
    assert {*promises.lit} == {"living", "bedroom", "dining", "kitchen", "study"}


def test_the_size_of_a_house_is_that_of_each_flat(apartments: Builder) -> None:
    """``house_size`` of their lengths: neither side is more than 2.2 times as long as the other."""
    house = apartments.house(HouseRequest(16), 3, 0)
    boxes = [[house.room(name).box for name in unit] for unit in units(house)]
    sizes = [
        (max(b[2] for b in each) - min(b[0] for b in each), max(b[3] for b in each) - min(b[1] for b in each))
        for each in boxes
    ]
    assert all(max(size) <= 2.2 * min(size) + 1e-6 for size in sizes)
    shorter = min(width for width, _ in sizes) - 0.001
    found = check(house, {"house_size": [[1.0, 0.0, shorter]]})
    assert len(found) == len(sizes) > 1
    assert all("its unit is" in line and "(must be: length <= " in line for line in found)


def test_what_is_impossible_for_a_flat_is_found_once_and_not_once_a_flat(
    apartments: Builder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A flat of 5 rooms between two others has light from one side, and is infeasible if flats are deep."""
    tried = list[int]()
    monkeypatch.setattr(
        "vitruvius.logic.generation.units.units_of", lambda *made: tried.append(1) or units_of(*made)
    )
    house = apartments.house(HouseRequest(64), 0, 0)
    assert check(house) == []
    assert len(units(house)) > 6
    assert len(tried) <= 8


def test_each_flat_has_a_hall_a_living_room_and_a_kitchen_and_one_door_to_the_corridor(
    apartments: Builder,
) -> None:
    house = apartments.house(HouseRequest(24), 4, 0)
    found = units(house)
    assert sum(map(len, found)) == 23
    for unit in found:
        types = Counter(house.room(name).type for name in unit)
        assert types["hall"] == types["living"] == types["kitchen"] == 1
        assert 5 <= len(unit) <= 9
        doors = [door for door in house.doors if unit & {*door.between} and house.hub in door.between]
        assert [{house.room(name).type for name in door.between} for door in doors] == [{"hall", PUBLIC}]
    entrances = [door for door in house.doors if door.is_entrance]
    assert entrances
    assert all({*door.between} == {OUTSIDE, house.hub} for door in entrances)


@pytest.mark.second_part("large buildings")
def test_a_building_depends_on_the_rules_the_request_and_the_seed_alone(apartments: Builder) -> None:
    alone = apartments.house(HouseRequest(11), 9, 5)
    apartments.house(HouseRequest(11, {"bedroom": (2, 2)}), 9, 0)
    assert builder("apartments").house(HouseRequest(11), 9, 5) == alone
    assert apartments.house(HouseRequest(11), 9, 5) == alone
    assert apartments.house(HouseRequest(11), 9, 6) != alone


def test_the_flats_of_a_building_share_the_rooms_that_are_asked_for(apartments: Builder) -> None:
    asked = HouseRequest(21, {"bedroom": (6, 6), "study": (1, None), "dining": (0, 0)})
    house = apartments.house(asked, 1, 0)
    types = Counter(room.type for room in house.rooms)
    assert (types["bedroom"], types["dining"]) == (6, 0)
    assert types["study"] >= 1
    assert check(house) == []


@pytest.mark.second_part("large buildings")
@pytest.mark.parametrize(
    ("request_", "text"),
    [
        (HouseRequest(4), "--rooms 4"),
        (HouseRequest(11, {"hall": (0, 0)}), "opens(commonCorridor,any_other_type) is not stated"),
    ],
)
def test_what_no_building_has_is_proved_by_the_rules_of_its_flats(
    apartments: Builder, request_: HouseRequest, text: str
) -> None:
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(apartments, request_, 0, 0)
    assert any(text in str(reason) for reason in caught.value.reasons)


def test_the_check_finds_a_flat_without_a_door_to_the_corridor_or_with_two(apartments: Builder) -> None:
    house = apartments.house(HouseRequest(8), 2, 0)
    (way,) = [door for door in house.doors if house.hub in door.between and not door.is_entrance]
    others = tuple(door for door in house.doors if door is not way)
    shut = msgspec.structs.replace(house, doors=others)
    assert any("its unit is entered by 0 doors" in line for line in check(shut))
    twice = msgspec.structs.replace(house, doors=(*house.doors, way))
    assert any("its unit is entered by 2 doors" in line for line in check(twice))


def changed(folder: Path, *edits: tuple[str, str, str]) -> Path:
    folder = shutil.copytree(SHIPPED / "apartments", folder / "mine")
    for name, text, other in edits:
        file = folder / name
        assert text in file.read_text()
        file.write_text(file.read_text().replace(text, other))
    return folder


def test_a_user_says_how_many_rooms_flats_have_and_how_deep_they_are(tmp_path: Path) -> None:
    mine = changed(
        tmp_path,
        ("rooms.lp", "units(5,9)", "units(6,7)"),
        ("rooms.lp", "#program house.", "#program units.\n:- not entrance(_,west).\n#program house."),
        ("sizes.pl", "D >= 7.0, D =< 8.8", "D >= 8.0, D =< 8.2"),
    )
    house = builder(mine).house(HouseRequest(21), 0, 0)
    assert sorted(map(len, units(house))) == [6, 7, 7]
    (west,) = [door.x for door in house.doors if door.is_entrance and door.x == house.main.x]
    flats = [room for room in house.rooms if room.type != PUBLIC]
    assert 8.0 - 1e-6 <= house.main.y - min(room.y for room in flats) <= 8.2 + 1e-6
    assert west == 0


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (("rooms.lp", "units(5,9)", "units(9,5)"), "the smaller first"),
        (("rooms.lp", "public(commonCorridor)", "public(lobby)"), "no room type has this name"),
        (("sizes.pl", "unit_depth(D) :- { D >= 7.0, D =< 8.8 }.", ""), "unit_depth/1 has no clause"),
        (("rooms.lp", "units(5,9).", ""), "state it by units/2"),
        (("rooms.lp", "topology(building)", "topology(ring)"), "the topology ring has no units"),
    ],
)
def test_a_wrong_statement_about_units_is_an_error_at_its_place(
    tmp_path: Path, edit: tuple[str, str, str], says: str
) -> None:
    with pytest.raises(GrammarError, match=says):
        builder(changed(tmp_path, edit))


def test_how_many_doors_a_public_room_has_is_said_to_be_no_rule(tmp_path: Path) -> None:
    mine = changed(
        tmp_path, ("rooms.lp", "degree(hall,2,4).", "degree(hall,2,4).  degree(commonCorridor,1,3).")
    )
    (warning,) = LoadedGrammar(find(mine)).warnings
    assert "the units decide how many doors a public room has: remove this fact" in warning.message


def test_a_building_lies_on_no_grid_and_says_so() -> None:
    with pytest.raises(RequestError, match="cell: houses of units do not support a grid: leave cell"):
        Builder(find("apartments"), cell=0.3)
