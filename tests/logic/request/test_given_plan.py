"""Plans of the user: read from GeoJSON and house files, kept, furnished, or proved impossible."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace

from tests.logic.generation.test_shared_walls import ROW, copied
from tests.logic.workers.in_process import builder
from vitruvius.logic import LimitReached, RequestError, Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Room
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

FILE = Path(__file__).parents[2] / "fixtures" / "plan.geojson"
Box = tuple[float, float, float, float]
BOXES: dict[str, Box] = {
    "hall": (4, 0, 6, 4),
    "living": (0, 0, 4, 4),
    "kitchen": (6, 0, 9, 3),
    "bath": (6, 3, 8.4, 5.2),
    "bedroom": (2, 4, 6, 7.5),
}
"""Rooms of the file: west, south, east, north."""


def geojson(boxes: Mapping[str, Box], **types: str) -> dict[str, Any]:
    """Return the rooms as GeoJSON, some of them with types."""
    features = []
    for name, (west, south, east, north) in boxes.items():
        ring = [[west, south], [east, south], [east, north], [west, north], [west, south]]
        properties = {"name": name} | ({"type": types[name]} if name in types else {})
        geometry = {"type": "Polygon", "coordinates": [ring]}
        features.append({"type": "Feature", "properties": properties, "geometry": geometry})
    return {"type": "FeatureCollection", "features": features}


def places(rooms: Iterable[Room]) -> list[tuple[Any, ...]]:
    return [(room.name, room.box) for room in rooms]


def made(home: Builder, source: Any, index: int = 0, **request: Any) -> House:
    plan = read_plan(source)
    record = {"rooms": len(plan.rooms), **request}
    wanted = HouseRequest.read({**record, "plan": msgspec.to_builtins(plan)})
    return house_or_proof(home, wanted, 0, index)


def test_rooms_stay_where_the_plan_says_and_get_doors_windows_and_furniture(home: Builder) -> None:
    plan = read_plan(FILE)
    houses = [made(home, FILE, index) for index in range(3)]
    for house in houses:
        assert check(house) == []
        assert places(house.rooms) == places(plan.rooms)
        assert sum(len(room.children) for room in house.rooms) > 5
        assert House.from_dict(house.to_dict()) == house
    assert len({json.dumps(house.to_dict()["doors"]) for house in houses}) == 3
    assert made(home, FILE, 1) == houses[1]


def test_a_type_that_the_plan_gives_is_kept_and_the_others_are_chosen(home: Builder) -> None:
    houses = [made(home, geojson(BOXES, kitchen="kitchen"), index) for index in range(4)]
    assert all(check(house) == [] and house.room("kitchen").type == "kitchen" for house in houses)
    assert made(home, geojson(BOXES), types={"bedroom": 1, "bathroom": 1}).room("bath").type == "bathroom"


def test_y_of_geojson_grows_north_and_any_direction_or_start_of_a_ring_is_a_rectangle() -> None:
    plan = read_plan(FILE)
    boxes = {room.name: room.box for room in plan.rooms}
    assert boxes["bedroom"] == (2, 0, 6, 3.5)
    assert boxes["hall"] == (4, 3.5, 6, 7.5)
    moved = json.loads(json.dumps(geojson(BOXES, hall="hall")))
    for number, feature in enumerate(moved["features"]):
        ring = [[x + 500_000, y + 5_000_000] for x, y in feature["geometry"]["coordinates"][0][:-1]]
        feature["geometry"]["coordinates"] = [
            (ring[number % 4 :] + ring[: number % 4])[:: 1 - 2 * (number % 2)]
        ]
    assert {room.name: room.box for room in read_plan(moved).rooms} == boxes


def test_a_house_is_a_plan_whose_rooms_doors_and_windows_stay_and_are_furnished_again(
    home: Builder, tmp_path: Path
) -> None:
    house = made(home, FILE)
    (tmp_path / "house.json").write_text(json.dumps(house.to_dict()))
    other = made(home, tmp_path / "house.json", 1)
    assert check(other) == []
    assert places(other.rooms) == places(house.rooms)
    assert [room.type for room in other.rooms] == [room.type for room in house.rooms]
    assert sorted(door.box for door in other.doors) == sorted(door.box for door in house.doors)
    assert other.windows == house.windows
    assert [room.children for room in other.rooms] != [room.children for room in house.rooms]
    assert other.provenance
    assert other.provenance.request["plan"]["rooms"][0]["name"] == house.rooms[0].name


def test_doors_of_a_plan_that_the_rules_forbid_are_named_in_the_proof(home: Builder) -> None:
    house = made(home, FILE)
    to_bath = next(door for door in house.doors if "bath" in door.between)
    others = tuple(door for door in house.doors if door is not to_bath)
    with pytest.raises(Unsatisfiable, match="plan: there are no other doors"):
        made(home, replace(house, doors=others))
    thin = replace(to_bath, width=to_bath.width / 2, height=to_bath.height / 2)
    with pytest.raises(Unsatisfiable, match="plan: a door joins bath and hall") as proof:
        made(home, replace(house, doors=(*others, thin)))
    assert "door_width" in str(proof.value)
    for astray in (replace(to_bath, x=0.0), replace(to_bath, between=("bath", "living"))):
        with pytest.raises(
            RequestError, match=r"the door between bath and .* is not in a wall that they share"
        ):
            read_plan(replace(house, doors=(*others, astray)))


@pytest.mark.second_part("a long proof")
def test_a_room_that_cannot_be_furnished_is_proved_by_the_room_the_pieces_and_the_rules(
    home: Builder,
) -> None:
    small = geojson(BOXES | {"bath": (6, 3, 8.4, 4.6)}, bath="bathroom")
    with pytest.raises(Unsatisfiable) as proof:
        made(home, small, furniture={"bathtub": 1, "shower": 1})
    for text in (
        "plan: bath is 2.40 by 1.60 m",
        "plan: bath is of type bathroom",
        "--piece bathtub=1",
        "--piece shower=1",
        "furniture.lp:10:1: may(bathroom,sink,1,1).",
        "passage(0.42).",
        "piece_size(bathtub,",
    ):
        assert text in str(proof.value), str(proof.value)


def test_past_the_most_layouts_of_a_room_its_limit_is_named(
    home: Builder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vitruvius.logic.generation.movable_doors.MOST_LAYOUTS", 0)
    monkeypatch.setattr("vitruvius.logic.generation.shared_walls.MOST_TRIES", 6)
    small = geojson(BOXES | {"bath": (6, 3, 7.6, 5.15)}, bath="bathroom")
    with pytest.raises(LimitReached, match=r"most recently bath, a bathroom of 1\.60 by 2\.15 m"):
        made(home, small, furniture={"bathtub": 1, "shower": 1, "washingMachine": 1})


def test_doors_move_to_where_a_room_can_be_furnished(home: Builder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vitruvius.logic.generation.given_plan.PATIENCE", 1)
    monkeypatch.setattr("vitruvius.logic.generation.shared_walls.MOST_TRIES", 1)
    tight = geojson(BOXES | {"bath": (6, 0, 7.6, 3), "kitchen": (6, 3, 9, 6)}, bath="bathroom")
    for index in (0, 1, 2, 17):  # of the first 24, only 17 has doors that leave no place for both
        house = made(home, tight, index, furniture={"bathtub": 1, "shower": 1})
        assert check(house) == []
        assert {"bathtub", "shower"} <= {piece.type for piece in house.room("bath").pieces}
    monkeypatch.setattr("vitruvius.logic.generation.given_plan.PATIENCE", 2)
    with pytest.raises(LimitReached):
        made(home, tight, 17, furniture={"bathtub": 1, "shower": 1})


@pytest.mark.parametrize(
    ("boxes", "types", "says"),
    [
        (
            {"bath": (6, 3, 8.4, 4)},
            {"bath": "bathroom"},
            ("room_size(bathroom", "plan: bath is 2.40 by 1.00 m"),
        ),
        (
            {"kitchen": (6, 1.2, 7.6, 3)},
            {"kitchen": "kitchen"},
            ("room_area(kitchen, 3.0, 60.0)", "plan: kitchen"),
        ),
        ({}, {"hall": "living"}, ("plan: hall is of type living",)),
        ({}, {"bath": "living", "living": "bedroom"}, ("plan: bath is of type living", "room_size(living")),
        (
            {"bath": (6, 3, 9, 6), "store": (9, 0, 10, 6)},
            {"store": "storage", "bath": "bathroom", "kitchen": "kitchen"},
            ("plan: store is 1.00 by 6.00 m",),
        ),
    ],
)
def test_a_plan_that_breaks_a_rule_is_proved_impossible_by_its_room_and_the_rule(
    home: Builder, boxes: dict[str, Box], types: dict[str, str], says: tuple[str, ...]
) -> None:
    with pytest.raises(Unsatisfiable) as proof:
        made(home, geojson(BOXES | boxes, **types))
    assert all(text in str(proof.value) for text in says), str(proof.value)


@pytest.mark.parametrize(
    ("boxes", "says"),
    [
        ({"bath": (5.8, 3, 8.4, 5.2)}, "hall overlaps bath by 0.200 m"),
        ({"shed": (20, 0, 22, 2)}, "shed shares no wall with the rooms around hall"),
        ({"shed": (9, 3, 11, 5)}, "shed shares no wall"),
        ({"living": (0, 0, 3.9, 4)}, "m² between hall, living, bedroom belong to no room"),
        ({"bath": (5.95, 3, 8.4, 5.2)}, r"hall overlaps bath by 0.050 m \(--snap 0.051 merges"),
        ({"shed": (9, 0, 2000, 2)}, "within 1000 m"),
    ],
)
def test_rooms_that_are_no_plan_are_refused_by_name(boxes: dict[str, Box], says: str) -> None:
    with pytest.raises(RequestError, match=says):
        read_plan(geojson(BOXES | boxes))


def test_what_is_no_rectangle_is_refused_by_name() -> None:
    for ring in (
        [[0, 0], [2, 0], [1, 1], [2, 2], [0, 2]],
        [[0, 0], [2, 0]],
        [],
        [[10**400, 0]] * 4,
        [["0", 0]] * 4,
        [[float("nan"), 0]] * 4,
    ):
        plan = geojson({"hall": (0, 0, 2, 2)})
        plan["features"][0]["geometry"]["coordinates"] = [ring]
        with pytest.raises(RequestError, match=r"plan: (features\[0\]: room )?hall"):
            read_plan(plan)
    for plan in (
        {},
        {"type": "FeatureCollection", "features": []},
        {"type": "FeatureCollection", "features": [3]},
    ):
        with pytest.raises(RequestError, match="plan: "):
            read_plan(plan)


def test_a_plan_stands_in_the_place_of_a_topology_of_the_users(tmp_path: Path) -> None:
    rules = copied(tmp_path, ("rooms.lp", "topology(ring).", "topology(row)."), row=ROW)
    house = made(builder(rules), FILE)
    assert check(house, "home") == []
    assert places(house.rooms) == places(read_plan(FILE).rooms)


def test_a_house_of_units_is_no_plan_yet() -> None:
    """Its own plan was called impossible because of the numbers of rooms of its units."""
    plan = read_plan(geojson(BOXES))
    with pytest.raises(RequestError, match="units, which given plans do not support: choose another grammar"):
        builder("apartments").house(HouseRequest(len(plan.rooms), plan=plan), 0, 0)
