"""Rooms of several corners: a room and its parts, with no wall between them, judged by geometry."""

import json
import shutil
from itertools import product
from pathlib import Path

import pytest
import shapely
from msgspec import UNSET, ValidationError, structs

from vitruvius.logic import PlanWarning, RequestError, Unsatisfiable, check
from vitruvius.logic.drawing.frame import Frame
from vitruvius.logic.drawing.labels import room_names
from vitruvius.logic.drawing.palettes import style
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Room
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.brief import read_brief
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.logic.workers.nearest_plan import nearest_plan

RULES = """
type(bay).  part(bay,living).  opens(living,bay).  lit(bay).  empty(bay).
#program house.
:- not room(_,bay).
"""
SIZES = """
room_size(bay, W, D) :- { W >= 1.5, W =< 3.0, D >= 1.5, D =< 3.0 }.
whole_area(living, 24.0, 24.6).
"""

TINY = """
topology(ring).  type(hall;bay).  empty(hall;bay).  central(hall).
opens(outside,hall).  opens(hall,bay).  part(bay,hall).
#program house.
:- not room(_,bay).
"""
TINY_SIZES = """
room_size(hall, W, D) :- { W >= 2.0, W =< 3.0, D >= 2.0, D =< 3.0 }.
room_size(bay, W, D) :- { W >= 1.0, W =< 2.0, D >= 1.0, D =< 2.0 }.
whole_area(hall, 13.01, 20.0).
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
"""
"""Sizes with which a hall of 9 m² and a bay of 4 m² are 13 m² at most."""


@pytest.fixture(scope="module")
def builder(tmp_path_factory: pytest.TempPathFactory) -> Builder:
    """Return a builder for homes whose living rooms have a bay or two.

    A process has one grammar, so the tests that load others come last.
    """
    folder = tmp_path_factory.mktemp("bay") / "mine"
    shutil.copytree(SHIPPED / "home", folder)
    (folder / "bay.lp").write_text(RULES)
    (folder / "bay.pl").write_text(SIZES)
    return Builder(find(folder))


@pytest.fixture(scope="module")
def houses(builder: Builder) -> list[House]:
    found = [builder.house(HouseRequest(n), seed, 0) for seed, n in product(range(3), (7, 9))]
    for house in found:
        assert check(house) == []
    return found


def bays(house: House) -> list[tuple[Room, Room]]:
    """Return each bay and the room of which it is a part."""
    return [(room, house.room(str(room.part_of))) for room in house.rooms if room.type == "bay"]


def corners(house: House, whole: Room) -> int:
    """Return the number of corners of the room that a whole and its parts form."""
    parts = [room.box for room in house.rooms if room is whole or room.part_of == whole.name]
    shape = shapely.set_precision(shapely.union_all([shapely.box(*box) for box in parts]), 1e-6)
    assert isinstance(shape, shapely.Polygon)
    return len(shapely.get_coordinates(shapely.simplify(shape, 1e-6))) - 1


def test_a_room_and_its_parts_are_one_room_of_the_area_that_is_stated(houses: list[House]) -> None:
    found = set()
    for house in houses:
        assert bays(house)
        for part, whole in bays(house):
            assert whole.type == "living"
            found.add(corners(house, whole))
            area = sum(room.area for room in house.rooms if whole.name in (room.name, room.part_of))
            assert 24.0 - 1e-6 <= area <= 24.6 + 1e-6
            (joint,) = (door for door in house.doors if {*door.between} == {part.name, whole.name})
            meeting = shapely.box(*part.box).boundary.intersection(shapely.box(*whole.box).boundary)
            assert joint.opening
            assert joint.length == pytest.approx(meeting.length, abs=1e-6)
    assert max(found) >= 8  # a T or a U
    assert 6 in found  # an L


def test_parts_stand_in_the_house_file_and_in_exports(houses: list[House]) -> None:
    for house in houses:
        again = House.from_dict(house.to_dict())
        assert again == house
        stated = {
            each["properties"]["name"]: each["properties"]["part_of"]
            for each in to_geojson(house)["features"]
            if "part_of" in each["properties"]
        }
        assert stated == {part.name: whole.name for part, whole in bays(house)}
        plan = read_plan(to_geojson(house))
        assert {room.name: room.part_of for room in plan.rooms if room.part_of} == stated


def test_a_plan_has_one_name_and_one_area_for_both(houses: list[House]) -> None:
    for house in houses:
        frame = Frame(60.0, 0.0, 0.0)
        words = [text.text for name in room_names(house, frame, style([house]), {}, 4.0) for text in name]
        assert "bay" not in words
        for _, whole in bays(house):
            area = sum(room.area for room in house.rooms if whole.name in (room.name, room.part_of))
            assert f"{area:.1f} m²" in words


def test_check_sees_a_wall_between_them_a_wrong_area_and_a_part_of_nothing(houses: list[House]) -> None:
    house = houses[0]
    (part, whole), *_ = bays(house)
    joint = next(door for door in house.doors if {*door.between} == {part.name, whole.name})
    across = {"width": joint.width / 2} if joint.width else {"height": joint.height / 2}
    half = [structs.replace(door, **across) if door is joint else door for door in house.doors]
    assert "are open (must be all)" in " ".join(map(str, check(structs.replace(house, doors=tuple(half)))))

    alone = [structs.replace(room, part_of=UNSET) for room in house.rooms]
    said = " ".join(map(str, check(structs.replace(house, rooms=tuple(alone)))))
    assert "is no part of a room (must be of a living)" in said
    assert "m² with its parts (24 to 24.6)" in said


def test_a_reader_refuses_parts_of_parts_and_of_nothing(houses: list[House]) -> None:
    record = houses[0].to_dict()
    part = next(room for room in record["rooms"] if "part_of" in room)
    for name, said in (("R99", "there is no room R99"), (part["name"], "is itself a part")):
        rooms = [room | {"part_of": name} if room is part else room for room in record["rooms"]]
        with pytest.raises(ValidationError, match=said):
            House.from_dict(record | {"rooms": rooms})


def test_a_plan_s_parts_are_kept(builder: Builder, houses: list[House]) -> None:
    house = houses[0]
    plan = OwnPlan(house.rooms, house.doors, house.windows)
    again = builder.house(HouseRequest(len(house.rooms), plan=plan), 1, 0)
    assert check(again) == []
    assert bays(again) == [
        (structs.replace(part, children=again.room(part.name).children), again.room(whole.name))
        for part, whole in bays(house)
    ]


def test_the_openings_of_a_plan_are_kept_beside_parts_and_no_other_door_lacks_a_leaf(
    builder: Builder, houses: list[House]
) -> None:
    house = houses[0]
    drawn, other, *_ = (door for door in house.doors if not door.opening and not door.is_entrance)
    doors = [structs.replace(door, opening=door.opening or door is drawn) for door in house.doors]
    plan = OwnPlan(house.rooms, tuple(doors), house.windows)
    again = builder.house(HouseRequest(len(house.rooms), plan=plan), 1, 0)
    assert check(again) == []
    assert next(door for door in again.doors if door.between == drawn.between).opening
    types = [{again.room(name).type for name in door.between} for door in (drawn, other)]
    assert types[0] != types[1]
    leafless = [
        structs.replace(door, opening=door.opening or door.between == other.between) for door in again.doors
    ]
    assert any("has no leaf" in line for line in check(structs.replace(again, doors=tuple(leafless))))


def test_on_a_grid_the_area_is_kept_too(builder: Builder) -> None:
    house = Builder(builder.grammar, cell=0.3).house(HouseRequest(7), 0, 0)
    assert check(house) == []
    for _, whole in bays(house):
        area = sum(room.area for room in house.rooms if whole.name in (room.name, room.part_of))
        assert 24.0 - 1e-6 <= area <= 24.6 + 1e-6


def test_a_brief_beside_areas_of_wholes_is_refused(builder: Builder) -> None:
    brief = read_brief({"rooms": [{"name": "A", "type": "hall"}, {"name": "B", "type": "living"}]})
    with pytest.raises(RequestError, match="whole_area/3"):
        Builder(builder.grammar).house(HouseRequest(2, brief=brief), 0, 0)


@pytest.mark.second_part("large plans")
def test_a_plan_of_another_area_is_moved_as_little_as_can_be(builder: Builder, houses: list[House]) -> None:
    """The plan is drawn 3 % too wide. The result keeps the area, by geometry."""
    house = houses[0]
    (_, whole), *_ = bays(house)
    wide = [structs.replace(room, x=1.03 * room.x, width=1.03 * room.width) for room in house.rooms]
    found = nearest_plan(OwnPlan(tuple(wide)), grammar=builder.grammar.directory)
    moved = {room.name: room for room in found.plan.rooms}
    parts = [moved[room.name] for room in house.rooms if whole.name in (room.name, room.part_of)]
    assert 24.0 - 1e-6 <= sum(room.area for room in parts) <= 24.6 + 1e-6


def test_a_proof_names_the_area_that_rooms_are_too_small_for(tmp_path: Path) -> None:
    (tmp_path / "rooms.lp").write_text(TINY)
    (tmp_path / "sizes.pl").write_text(TINY_SIZES)
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(Builder(find(tmp_path)), HouseRequest(2), 0, 0)
    reasons = " ".join(reason.text for reason in caught.value.reasons)
    assert all(each in reasons for each in ("whole_area(hall", "room_size(hall", "room_size(bay"))


def test_walls_with_a_thickness_leave_them_open_and_their_insides_of_that_area(
    builder: Builder, tmp_path: Path
) -> None:
    shutil.copytree(builder.grammar.directory, tmp_path / "thick")
    (tmp_path / "thick" / "walls.pl").write_text("wall_thickness(inner, 0.1).  wall_thickness(outer, 0.3).\n")
    house = Builder(find(tmp_path / "thick")).house(HouseRequest(7), 0, 0)
    assert check(house) == []
    for part, whole in bays(house):
        assert shapely.distance(shapely.box(*part.box), shapely.box(*whole.box)) == pytest.approx(0.1)
        area = sum(room.area for room in house.rooms if whole.name in (room.name, room.part_of))
        assert 24.0 - 1e-6 <= area <= 24.6 + 1e-6


def test_that_a_room_without_a_part_is_too_small_says_nothing_of_one_with_it(tmp_path: Path) -> None:
    """A hall of at most 9 m² must have 9.5 m²; its neighbour may be a den, but is a bay."""
    rules = TINY.replace("hall;bay", "hall;bay;den").replace("opens(hall,bay)", "opens(hall,(bay;den))")
    (tmp_path / "rooms.lp").write_text(rules.replace(":- not room(_,bay).", ""))
    den = "room_size(den, W, D) :- { W >= 1.0, W =< 2.0, D >= 1.0, D =< 2.0 }.\n"
    (tmp_path / "sizes.pl").write_text(TINY_SIZES.replace("13.01", "9.5") + den)
    builder = Builder(find(tmp_path))
    for seed in range(8):
        house = house_or_proof(builder, HouseRequest(2), seed, 0)
        assert check(house) == []
        assert {room.type for room in house.rooms} == {"hall", "bay"}


def test_a_room_of_six_corners_in_a_real_plan_is_a_room_and_its_part(tmp_path: Path) -> None:
    """The plan is in HouseExpo's format, without doors: a hall of 3 m by 3 m with a bay of 2 m by 1.5 m."""
    (tmp_path / "rooms.lp").write_text(TINY)
    (tmp_path / "sizes.pl").write_text(TINY_SIZES.replace("whole_area(hall, 13.01, 20.0).", ""))
    corners = [[0, 0], [3, 0], [3, 3], [2, 3], [2, 4.5], [0, 4.5]]
    bounds = {"min": [0, 0], "max": [3, 4.5]}
    record = {"id": "L", "room_num": 1, "verts": corners, "bbox": bounds}
    record["room_category"] = {"Hall": [[0, 0, 3, 4.5]]}
    (tmp_path / "plan.json").write_text(json.dumps(record))
    with pytest.warns(PlanWarning, match="2 rooms, Hall, Hall 2"):
        plan = read_plan(tmp_path / "plan.json")
    house = Builder(find(tmp_path)).house(HouseRequest(2, plan=plan), 0, 0)
    assert check(house) == []
    hall, bay = house.rooms
    assert (hall.type, bay.type, bay.part_of) == ("hall", "bay", hall.name)
    (door,) = (each for each in house.doors if not each.is_entrance)
    assert door.opening
    assert door.length == pytest.approx(2.0)
    # A grammar without parts of a hall has the same rooms, open to each other.
    rules = TINY.replace("part(bay,hall).", "opening(bay,hall).")
    (tmp_path / "rooms.lp").write_text(rules)
    house = Builder(find(tmp_path)).house(HouseRequest(2, plan=plan), 0, 0)
    assert [room.part_of for room in house.rooms] == [UNSET, UNSET]
