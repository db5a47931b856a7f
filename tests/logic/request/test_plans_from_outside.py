"""Plans from users: any names, other features, other units, and walls slightly apart."""

import json
import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.logic.request.test_given_plan import BOXES, Box, geojson
from vitruvius.logic import House, HouseFileError, PlanWarning, RequestError, load, save
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.house.parts import Room
from vitruvius.logic.request.given_plan import read_plan

BANKS = Path(__file__).parents[3] / "agent" / "houses"
CASES = Path(__file__).parents[4] / "shared" / "cases"
NAMES = ["home-test-v1", "home-large-test-v1", "test-v1", "large-test-v1"]


def neighbours(rooms: tuple[Room, ...], within: float = 1e-6, least: float = 0.01) -> set[tuple[int, int]]:
    """Return the pairs of rooms that share more than ``least`` metres of a wall, by plain geometry."""
    found = set()
    for i, one in enumerate(rooms):
        for j, other in enumerate(rooms[:i]):
            a, b = one.box, other.box
            for k in (0, 1):
                touches = min(abs(a[k] - b[k + 2]), abs(a[k + 2] - b[k])) <= within
                along = min(a[3 - k], b[3 - k]) - max(a[1 - k], b[1 - k])
                if touches and along > least:
                    found.add((j, i))
    return found


@pytest.fixture(autouse=True)
def _no_warning_is_lost():
    with warnings.catch_warnings():
        warnings.simplefilter("error", PlanWarning)
        yield


@pytest.mark.second_part("a thousand houses")
def test_a_thousand_houses_are_read_back_from_each_format_as_they_were_written(tmp_path: Path) -> None:
    """Homes are also read as plans: they have the same walls, and the same rooms side by side."""
    counts = 0
    for name in NAMES:
        houses = load(BANKS / f"{name}.jsonl.gz")
        counts += len(houses)
        save(houses, tmp_path / f"{name}.jsonl")
        assert load(tmp_path / f"{name}.jsonl") == houses
        for house in houses if name.startswith("home") else ():
            plan = read_plan(json.loads(json.dumps(to_geojson(house))))
            west, north = (min(room.box[k] for room in house.rooms) for k in (0, 1))
            for ours, theirs in zip(house.rooms, plan.rooms, strict=True):
                moved = [edge - (west, north)[k % 2] for k, edge in enumerate(ours.box)]
                assert theirs.box == pytest.approx(moved, abs=2e-6)
                assert (theirs.name, theirs.type) == (ours.name, ours.type)
            assert neighbours(plan.rooms) == neighbours(house.rooms)
    assert counts >= 1000


@given(
    st.integers(0, 255),
    st.sampled_from([2, 3, 4, 6]),
    st.floats(-5e6, 5e6),
)
@example(39, 2, 0.0)
def test_a_plan_rounded_anywhere_on_a_map_keeps_its_neighbours(index: int, digits: int, far: float) -> None:
    """Coordinates are rounded to a centimetre or less, and as far away as those of UTM.

    The rounding may shorten a shared wall by as much: a wall of 1.8 cm keeps at least a centimetre.
    """
    house = load_home(index)
    record = to_geojson(house)
    for feature in record["features"]:
        for ring in feature["geometry"]["coordinates"] if feature["geometry"]["type"] == "Polygon" else ():
            ring[:] = [[round(x + far, digits), round(y + far, digits)] for x, y in ring]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        plan = read_plan(record)
    assert neighbours(house.rooms, 1e-5, 0.01 + 10.0**-digits) <= neighbours(plan.rooms, 1e-5)
    assert len(plan.rooms) == len(house.rooms)


_homes: list[House] = []


def load_home(index: int) -> House:
    if not _homes:
        _homes.extend(load(BANKS / "home-test-v1.jsonl.gz"))
    return _homes[index]


def renamed(**names: Any) -> dict[str, Any]:
    record = geojson(BOXES)
    for feature, (key, value) in zip(record["features"], names.items(), strict=False):
        feature["properties"]["name"] = value
        assert key in BOXES
    return record


@pytest.mark.parametrize(
    ("given_", "read"),
    [
        ("Living Room", "Living Room"),
        ("Küche", "Küche"),
        ("居間", "居間"),
        ("101", "101"),
        (1, "1"),
        (1.0, "1"),
        (2.5, "2.5"),
        ("  two\tlines\nof it ", "two lines of it"),
        ("x" * 100, "x" * 64),
        ("R-1.a", "R-1.a"),
        ("outside", "outside 2"),
        (None, "R0"),
        ("", "R0"),
        (True, "R0"),
    ],
)
def test_a_room_may_have_any_name(given_: Any, read: str) -> None:
    plan = read_plan(renamed(hall=given_))
    assert plan.rooms[0].name == read
    house = House(plan.rooms, (), ())
    assert House.from_dict(json.loads(json.dumps(house.to_dict()))) == replace(house, topology=house.topology)


def test_a_name_that_stands_twice_gets_a_number_and_another_property_may_hold_it() -> None:
    record = renamed(hall="Room", living="Room", kitchen="Room 2")
    record["features"][3]["properties"] = {"label": "Bad"}
    record["features"][4] |= {"properties": None, "id": 7}
    assert [room.name for room in read_plan(record).rooms] == ["Room", "Room 3", "Room 2", "Bad", "7"]


def test_a_polygon_in_other_clothes_is_the_same_room() -> None:
    plain = read_plan(geojson(BOXES)).rooms
    record = geojson(BOXES)
    hall, living, kitchen, bath, _ = (feature["geometry"] for feature in record["features"])
    hall |= {"type": "MultiPolygon", "coordinates": [hall["coordinates"]]}
    living["coordinates"][0].reverse()
    kitchen["coordinates"][0] = [[*point, 0.0] for point in kitchen["coordinates"][0]][:-1]
    bath["coordinates"][0].insert(1, [7, 3])
    assert read_plan(record).rooms == plain
    one = {"type": "Feature", "properties": {"name": "hall"}, "geometry": record["features"][1]["geometry"]}
    assert read_plan(one).rooms[0].width == read_plan(one["geometry"]).rooms[0].width == 4


def test_what_is_no_room_is_passed_over_and_said() -> None:
    record = geojson(BOXES)
    for geometry in (
        {"type": "Point", "coordinates": [4, 2]},
        {"type": "LineString"},
        {"type": "Point"},
        None,
    ):
        record["features"].insert(0, {"type": "Feature", "properties": {}, "geometry": geometry})
    with pytest.warns(PlanWarning, match="1 LineString, 2 Points, 1 feature without geometry"):
        plan = read_plan(record)
    assert len(plan.rooms) == len(BOXES)
    with pytest.raises(RequestError, match="plan: it has no polygon of a room, but 2 Points"):
        read_plan({"type": "FeatureCollection", "features": record["features"][1:2] * 2})


@pytest.mark.parametrize(
    ("boxes", "says"),
    [
        (
            BOXES | {"again": BOXES["living"]},
            "living and again are the same rectangle: leave one of them out",
        ),
        (
            BOXES | {"all": (-1, -1, 20, 20)},
            "all has hall, living, kitchen and 2 more within",
        ),
        (
            {"a": (0, 0, 3, 3), "b": (3.45, 0, 6, 3)},
            r"b shares no wall .*, 0\.450 m off \(--snap 0\.451 merges",
        ),
    ],
)
def test_what_is_drawn_beside_or_over_rooms_is_named_for_what_it_is(boxes: dict[str, Box], says: str) -> None:
    with pytest.raises(RequestError, match=says):
        read_plan(geojson(boxes))


def test_a_feature_of_another_program_is_a_room_whatever_kind_it_calls_it() -> None:
    record = geojson(BOXES)
    for feature in record["features"]:
        feature["properties"]["kind"] = "space"
    assert read_plan(record).rooms == read_plan(geojson(BOXES)).rooms


def scaled(factor: float, far: float = 0.0) -> dict[str, Any]:
    boxes = {name: tuple(factor * edge + far for edge in box) for name, box in BOXES.items()}
    return geojson(boxes)  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize(
    ("record", "says"),
    [
        (scaled(1000), "look like millimetres .*--plan-unit mm"),
        (scaled(100), "look like centimetres, or pixels .*--plan-unit cm"),
        (scaled(40), "look like (centimetres, or )?pixels .*--plan-unit"),
    ],
)
def test_other_units_are_named_and_taken_when_they_are_said(record: dict[str, Any], says: str) -> None:
    with pytest.raises(RequestError, match=says):
        read_plan(record)


@pytest.mark.parametrize(("factor", "unit"), [(1000, "mm"), (100, "cm"), (1 / 0.3048, "ft"), (50, "0.02")])
def test_a_unit_that_is_said_gives_the_same_plan(factor: float, unit: str) -> None:
    plan, same = read_plan(scaled(factor), unit), read_plan(geojson(BOXES))
    for one, other in zip(plan.rooms, same.rooms, strict=True):
        assert one.box == pytest.approx(other.box, abs=1e-5)
    with pytest.raises(RequestError, match="plan unit yd: give one of m, dm"):
        read_plan(scaled(1), "yd")


@pytest.mark.parametrize("off", [-0.009, -0.001, 0.001, 0.009])
def test_walls_within_a_centimetre_are_one_and_it_is_said(off: float) -> None:
    moved: dict[str, Box] = BOXES | {"living": (0, 0, 4 + off, 4)}
    with pytest.warns(PlanWarning, match=f"1 edge of rooms moved by {abs(off):.2g} m at most"):
        rooms = read_plan(geojson(moved)).rooms
    assert neighbours(rooms) == neighbours(read_plan(geojson(BOXES)).rooms)
    with pytest.raises(RequestError, match=rf"(overlaps|to no room).* {abs(off)} m.*--snap"):
        read_plan(geojson(moved), snap=0.0)


@pytest.mark.parametrize("off", [-0.03, 0.03])
def test_walls_further_apart_are_no_plan_unless_it_is_said(off: float) -> None:
    moved: dict[str, Box] = BOXES | {"living": (0, 0, 4 + off, 4)}
    with pytest.raises(RequestError, match=r"0\.030 m.*--snap 0\.031"):
        read_plan(geojson(moved))
    with pytest.warns(PlanWarning, match=r"moved by 0\.03 m"):
        rooms = read_plan(geojson(moved), snap=0.031).rooms
    assert neighbours(rooms) == neighbours(read_plan(geojson(BOXES)).rooms)


def test_a_corner_a_pixel_off_is_still_a_rectangle() -> None:
    record = geojson({"a": (0, 0, 5, 4), "b": (5, 0, 8, 4)})
    record["features"][0]["geometry"]["coordinates"][0][1] = [5, 0.01]
    assert [room.width for room in read_plan(record).rooms] == [5, 3]


def test_doors_and_windows_go_with_the_wall_that_moves() -> None:
    house = load(Path(__file__).parents[2] / "fixtures" / "plans.jsonl")[0]
    first, *others = house.rooms
    pushed = replace(house, rooms=(replace(first, height=first.height - 0.004), *others))
    with pytest.warns(PlanWarning, match="moved by 0.004 m"):
        plan = read_plan(pushed)
    assert all(plan.wall_of(opening) for opening in (*plan.doors, *plan.windows))


def test_a_house_file_without_a_format_is_read_and_another_programs_is_named(tmp_path: Path) -> None:
    house = load(Path(__file__).parents[2] / "fixtures" / "plans.jsonl")[0]
    record = house.to_dict()
    del record["format"]
    (tmp_path / "mine.json").write_text(json.dumps(record))
    assert load(tmp_path / "mine.json") == [house]
    other = {"rooms": [{"id": "room|2", "roomType": "Kitchen", "floorPolygon": []}], "doors": []}
    (tmp_path / "other.json").write_text(json.dumps(other))
    with pytest.raises(HouseFileError, match="no format, and its rooms have id, roomType, floorPolygon"):
        load(tmp_path / "other.json")


@pytest.mark.skipif(not CASES.exists(), reason="the cases are beside the project")
def test_inputs_that_once_failed_are_read() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        # Rooms of ``reasons`` are no plans, and their errors are tested elsewhere.
        for file in sorted(each for each in CASES.glob("*/*.geojson") if each.parent.name != "reasons"):
            assert len(read_plan(file).rooms) >= 2, file
