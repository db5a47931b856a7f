"""GeoJSON as people and programs write it: turned, in degrees, with walls, corners, words and doors."""

import json
import warnings
from collections.abc import Callable, Iterator
from math import asinh, cos, radians, sin, sqrt, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity
from shapely.geometry import mapping

from tests.logic.readers.test_readers import paired, shared
from tests.logic.readers.written import inner, opening
from tests.logic.request.test_given_plan import BOXES, geojson
from tests.logic.workers.in_process import generate
from vitruvius.logic import House, PlanWarning, RequestError, load
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.request.given_plan import read_plan

ROOT = Path(__file__).parents[3]
CASES = ROOT.parent / "shared" / "cases"

GERMAN = {
    "hall": "Diele", "corridor": "Flur", "living": "Wohnzimmer", "dining": "Esszimmer", "kitchen": "Küche",
    "bedroom": "Schlafzimmer", "bathroom": "Bad", "wc": "Gäste-WC", "storage": "Abstellraum", "study": "Büro",
}  # fmt: skip

Write = Callable[[House, float], dict[str, Any]]


@pytest.fixture(scope="module")
def homes() -> list[House]:
    return list(load(ROOT / "agent" / "houses" / "home-test-v1.jsonl.gz")[:4])


@pytest.fixture(autouse=True)
def _warnings_are_read_where_they_are_claimed() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        yield


def feature(shape: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": mapping(shape)}


def collection(*features: dict[str, Any]) -> dict[str, Any]:
    return {"type": "FeatureCollection", "features": list(features)}


def walled(house: House, turn: float = 0.0, factor: float = 1.0) -> dict[str, Any]:
    """Return rooms from wall to wall with German names, and openings through the walls; y grows north."""
    rng = np.random.default_rng(0)

    def on_map(shape: Any) -> Any:
        turned = affinity.rotate(affinity.scale(shape, 1, -1, origin=(0, 0)), turn, origin=(0, 0))
        return affinity.scale(turned, factor, factor, origin=(0, 0))

    rooms = [
        feature(on_map(shape), name=f"{GERMAN[room.type]} {number}")
        for number, (room, shape) in enumerate(zip(house.rooms, inner(house, rng, 0.005), strict=True))
    ]
    doors = [feature(on_map(opening(door, rng, 0.0)), type="Tür") for door in house.doors]
    windows = [feature(on_map(opening(each, rng, 0.0)), category="window") for each in house.windows]
    return collection(*rooms, *doors, *windows)


def on_earth(record: dict[str, Any], lon: float, lat: float, digits: int = 9) -> dict[str, Any]:
    """Return metres east and north of a place as degrees, by the radii of WGS 84."""
    a, e2 = 6378137.0, 0.00669437999014
    curve = 1 - e2 * sin(radians(lat)) ** 2
    north, east = a * (1 - e2) / curve**1.5, a / sqrt(curve) * cos(radians(lat))

    def degrees(points: np.ndarray) -> np.ndarray:
        return np.round(np.array([lon, lat]) + np.degrees(points / [east, north]), digits)

    moved = json.loads(json.dumps(record))
    for each in moved["features"]:
        shape = shapely.geometry.shape(each["geometry"])
        each["geometry"] = mapping(shapely.transform(shape, degrees))
    return moved


DRESSES: dict[str, tuple[Callable[[House], dict[str, Any]], str | None]] = {
    "metres": (walled, None),
    "turned": (lambda home: walled(home, 33), None),
    "millimetres": (lambda home: walled(home, -20, 1000), "mm"),
    "degrees": (lambda home: on_earth(walled(home, 17), 11.5, 48.1), None),
    "degrees in the south": (lambda home: on_earth(walled(home), -70.7, -33.4), None),
    "degrees of six decimals": (lambda home: on_earth(walled(home, 17), 11.5, 48.1, 6), None),
}


@pytest.mark.parametrize("dress", DRESSES)
def test_a_home_in_geojson_is_the_same_rooms_doors_and_windows(dress: str, homes: list[House]) -> None:
    write, unit = DRESSES[dress]
    for home in homes:
        plan = read_plan(write(home), unit)
        names = paired(home, plan)
        ours, theirs = (
            {room.name: room for room in home.rooms},
            {names[room.name]: room for room in plan.rooms},
        )
        for name, room in theirs.items():
            off = 0.12 if dress == "degrees of six decimals" else 0.03
            assert (room.width, room.height) == pytest.approx((ours[name].width, ours[name].height), abs=off)
            assert room.type == ours[name].type
        assert shared(theirs) == shared(ours)
        joined = {frozenset(names[each] for each in door.between) for door in plan.doors}
        assert joined == {frozenset(door.between) for door in home.doors}
        assert len(plan.windows) == len(home.windows)


def test_what_convert_writes_comes_back_with_its_doors_and_windows(homes: list[House]) -> None:
    for home in homes:
        plan = read_plan(json.loads(json.dumps(to_geojson(home))))
        west, north = (min(room.box[k] for room in home.rooms) for k in (0, 1))
        for ours, theirs in ((home.doors, plan.doors), (home.windows, plan.windows)):
            places = [np.array(each.box) - [west, north, west, north] for each in ours]
            assert np.allclose(
                sorted(map(list, places)), sorted(list(each.box) for each in theirs), atol=2e-6
            )
        ours, theirs = ({frozenset(door.between) for door in doors} for doors in (home.doors, plan.doors))
        assert theirs == ours


@pytest.mark.parametrize(
    ("lon", "lat"), [(11.5, 48.1), (-70.7, -33.4), (24.9, 60.2), (0.0, 0.0), (179.99, 71.0)]
)
def test_degrees_become_metres_to_a_millimetre(lon: float, lat: float) -> None:
    """The comparison is with straight lines between corners in space, on the ellipsoid."""

    def in_space(point: tuple[float, float]) -> np.ndarray:
        e2 = 0.00669437999014
        x, y = np.radians(point)
        radius = 6378137.0 / sqrt(1 - e2 * sin(y) ** 2)
        return radius * np.array([cos(y) * cos(x), cos(y) * sin(x), (1 - e2) * sin(y)])

    step = 9e-5  # about 10 m northwards
    corners = [(lon, lat), (lon + step, lat), (lon + step, lat + step), (lon, lat + step)]
    with pytest.warns(PlanWarning, match="degrees of longitude and latitude, made metres around"):
        [room] = read_plan(feature(shapely.Polygon(corners), name="Wohnen")).rooms
    wide, deep = (np.linalg.norm(in_space(corners[k + 1]) - in_space(corners[k])) for k in (0, 1))
    assert (room.width, room.height) == pytest.approx((wide, deep), abs=1e-3)
    assert room.type == "living"


ELL = shapely.Polygon([(0, 0), (8, 0), (8, 4), (4, 4), (4, 9), (0, 9)])
SQUARE = shapely.box(4, 4, 8, 9)


def test_metres_of_the_web_are_made_metres_on_the_ground() -> None:
    """QGIS writes this for drawings over a street map: each metre is 1.64 units long in Berlin."""
    lon, lat = radians(13.4), radians(52.5)
    x, y, length = 6378137 * lon, 6378137 * asinh(tan(lat)), 1 / cos(lat)
    boxes = [shapely.box(x + 3 * k * length, y, x + 3 * (k + 1) * length, y + 4 * length) for k in (0, 1)]
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3857"}}
    plan = read_plan(collection(*map(feature, boxes)) | {"crs": crs})
    sizes = {size for room in plan.rooms for size in (room.width, room.height)}
    assert sorted(sizes) == pytest.approx([3, 4], rel=5e-3)


def test_a_door_beside_a_named_entrance_is_a_garden_door_and_no_window() -> None:
    rooms = [feature(shapely.box(x, 0, x + 3, 4), name=name) for x, name in ((0, "Flur"), (3, "Wohnen"))]
    openings = {"Haustür": [(1, 0), (2, 0)], "Tür": [(6, 1), (6, 2)], "Fenster": [(3.5, 4), (5, 4)]}
    lines = [feature(shapely.LineString(line), type=name) for name, line in openings.items()]
    plan = read_plan(collection(*rooms, *lines))
    assert [door.between for door in plan.doors] == [("Flur", "outside"), ("Wohnen", "outside")]


@pytest.mark.parametrize("turn", [0, 25, -40])
def test_six_corners_become_boxes_whichever_way_they_lie(turn: float) -> None:
    rooms = (feature(affinity.rotate(ELL, turn, origin=(0, 0)), name="Living", type="Living Room"),
             feature(affinity.rotate(SQUARE, turn, origin=(0, 0)), name="Bed", type="Bedroom"))  # fmt: skip
    with pytest.warns(PlanWarning, match="Living has 6 corners.*2 rooms, Living, Living 2"):
        plan = read_plan(collection(*rooms))
    assert {room.name: room.type for room in plan.rooms} == {
        "Living": "living",
        "Living 2": "",
        "Bed": "bedroom",
    }
    assert sum(room.area for room in plan.rooms) == pytest.approx(72, abs=0.01)


@pytest.mark.parametrize(
    ("properties", "kind"),
    [
        ({"type": "Living Room"}, "living"),
        ({"type": "small office"}, "study"),
        ({"name": "Küche"}, "kitchen"),
        ({"name": "A 1.02", "category": "Badezimmer"}, "bathroom"),
        ({"name": "101", "room_type": "slaapkamer"}, "bedroom"),
        ({"label": "MH 2"}, "bedroom"),
        ({"indoor": "room", "room": "kitchen"}, "kitchen"),
        ({"type": "room", "name": "Bad"}, "bathroom"),
        ({"type": "Bedroom", "name": "Küche"}, "bedroom"),
        ({"type": "", "name": "Raum 3"}, ""),
        ({"name": "Haus"}, ""),
        ({"kind": "room", "type": "", "name": "Küche"}, ""),
        ({"type": "cell", "name": "Küche"}, "cell"),
    ],
)
def test_any_words_say_the_type_of_a_room(properties: dict[str, Any], kind: str) -> None:
    assert read_plan(feature(shapely.box(0, 0, 4, 4), **properties)).rooms[0].type == kind


@pytest.mark.parametrize(
    ("word", "types", "kind"),
    [
        ("office", {"office", "cell"}, "office"),
        ("office", {"study", "hall"}, "study"),
        ("office", {"cell"}, ""),
        ("Office", {"cell"}, ""),
        ("bath", {"bathroom"}, "bathroom"),
        ("den", {"den", "patio"}, "den"),
        ("kitchn", {"kitchen"}, "kitchn"),
    ],
)
def test_a_grammars_own_words_come_first(word: str, types: set[str], kind: str) -> None:
    """A word that neither the grammar nor the table has stays, so that the error names the likely word."""
    assert read_plan(feature(shapely.box(0, 0, 4, 4), type=word), types=types).rooms[0].type == kind


def test_what_is_outside_is_a_room_where_the_grammar_has_such_rooms() -> None:
    record = collection(
        feature(shapely.box(0, 0, 4, 4), type="hall"), feature(shapely.box(4, 0, 6, 4), type="patio")
    )
    assert [room.type for room in read_plan(record, types={"hall", "patio"}).rooms] == ["hall", "patio"]
    with pytest.warns(PlanWarning, match="ignored, because they are not rooms: R1"):
        assert [room.type for room in read_plan(record, types={"hall"}).rooms] == ["hall"]


DOOR = shapely.LineString([(4, 1), (4, 1.9)])


@pytest.mark.parametrize(
    ("shape", "properties", "length"),
    [
        (DOOR, {"type": "door"}, 0.9),
        (DOOR, {"kind": "door"}, 0.9),
        (DOOR, {"name": "Tür 1"}, 0.9),
        (DOOR, {"class": "IfcDoor"}, 0.9),
        (DOOR, {"category": "puerta"}, 0.9),
        (DOOR.buffer(0.1, cap_style="flat"), {"type": "Door"}, 0.9),
        (shapely.Point(4, 2), {"door": "yes"}, 0.8),
        (shapely.Point(4.1, 0.2), {"indoor": "door"}, 0.8),
    ],
)
def test_lines_polygons_and_points_are_doors_where_a_word_says_so(
    shape: Any, properties: dict[str, Any], length: float
) -> None:
    plan = read_plan(collection(*geojson(BOXES)["features"], feature(shape, **properties)))
    [door] = plan.doors
    assert {*door.between} == {"hall", "living"}
    assert door.length == pytest.approx(length)
    assert len(plan.rooms) == len(BOXES)


@pytest.mark.parametrize("properties", [{"name": "Outline"}, {"type": "building"}, {"category": "Möbel"}])
def test_an_outline_or_a_piece_is_no_room_and_is_said_to_be_passed_over(properties: dict[str, Any]) -> None:
    around = feature(shapely.box(0, 0, 9, 7.5), **properties)
    with pytest.warns(PlanWarning, match="ignored beside the rooms: 1 Polygon"):
        plan = read_plan(collection(around, *geojson(BOXES)["features"]))
    assert [room.name for room in plan.rooms] == list(BOXES)


def test_a_sequence_of_features_is_the_same_plan(tmp_path: Path) -> None:
    features = geojson(BOXES)["features"]
    plan = read_plan(collection(*features))
    lines = [json.dumps(each).encode() for each in features]
    for name, content in {
        "lines": b"\n".join(lines),
        "windows.geojsonl": b"\r\n".join(lines) + b"\r\n",
        "rfc8142.geojsons": b"".join(b"\x1e" + line + b"\n" for line in lines),
        "one": b"\x1e" + json.dumps(collection(*features), indent=1).replace("\n", " ").encode(),
        "bom": b"\xef\xbb\xbf\n" + b"\n\n".join(lines),
    }.items():
        (tmp_path / name).write_bytes(content)
        assert read_plan(tmp_path / name) == plan
    assert len(load(tmp_path / "rfc8142.geojsons")) == 1


def test_doors_in_no_wall_have_few_notes_and_are_counted() -> None:
    rooms = feature(shapely.box(0, 0, 4, 4), name="a"), feature(shapely.box(4, 0, 8, 4), name="b")
    lines = (shapely.LineString([(1, 1 + number / 100), (1.9, 1 + number / 100)]) for number in range(200))
    doors = [feature(line, type="door") for line in lines]
    with pytest.warns(PlanWarning) as warned:
        read_plan(collection(*rooms, *doors))
    assert [str(each.message) for each in warned][4:] == [
        "plan: a door at x 1.45, y 2.96 m is not in a wall: ignored",
        "plan: 195 more doors are not in a wall: ignored",
    ]


@pytest.mark.parametrize("key", ["level", "storey", "floor"])
def test_of_several_storeys_one_is_named(key: str) -> None:
    features = [
        {**each, "properties": {**each["properties"], key: level}}
        for level in ("EG", "OG 1")
        for each in geojson(BOXES)["features"][: 3 if level == "EG" else 5]
    ]
    with pytest.raises(
        RequestError, match=r"2 storeys with rooms \(EG, OG 1\): choose one, as in --storey EG"
    ):
        read_plan(collection(*features))
    assert len(read_plan(collection(*features), storey="eg").rooms) == 3
    assert len(read_plan(collection(*features), storey="OG 1").rooms) == 5
    with pytest.raises(RequestError, match="no storey OG 2: did you mean OG 1"):
        read_plan(collection(*features), storey="OG 2")
    with pytest.raises(RequestError, match=r"no room says its storey.*leave --storey out"):
        read_plan(geojson(BOXES), storey="EG")


def test_a_plan_of_a_stranger_is_furnished_by_home() -> None:
    """The plan has rooms from wall to wall, turned, in degrees, with the words of an advertisement."""
    names = {"hall": "Diele", "living": "Wohnen", "kitchen": "Küche", "bath": "Bad", "bedroom": "Schlafen"}
    rooms = [
        feature(
            affinity.rotate(shapely.box(*box).buffer(-0.06, join_style="mitre"), 12, origin=(0, 0)),
            name=names[key],
        )
        for key, box in BOXES.items()
    ]
    house = next(generate(plan=on_earth(collection(*rooms), 8.5, 47.4, 8), grammar="home"))
    assert [room.type for room in house.rooms] == ["hall", "living", "kitchen", "bathroom", "bedroom"]


@pytest.mark.skipif(not CASES.exists(), reason="the cases are beside the project")
def test_a_door_that_is_a_point_and_sequences_that_once_failed_are_read() -> None:
    assert len(read_plan(CASES / "plan-multipolygon" / "with-a-point.geojson").doors) == 1
    for name in ("rfc8142.geojsonl", "newline-delimited.geojsonl", "warns.geojson"):
        assert [room.type for room in read_plan(CASES / "reasons" / name).rooms] == ["living", "hall"]


def test_more_rooms_and_doors_than_are_read_are_refused_before_any_is_made() -> None:
    door = feature(DOOR, type="door")
    with pytest.raises(RequestError, match=r"1 room and 4,097 doors and windows: at most 1,024 and 4,096"):
        read_plan(collection(feature(SQUARE), *[door] * 4097))


def test_each_part_of_a_geometry_counts_as_a_room() -> None:
    """13,000 squares of one feature made the reader compare 84 million pairs, for minutes."""
    parts = shapely.MultiPolygon([shapely.box(k, 0, k + 0.5, 1) for k in range(1025)])
    with pytest.raises(RequestError, match="it has 1,025 rooms and 0 doors and windows: at most 1,024"):
        read_plan(collection(feature(parts)))


@pytest.mark.parametrize(
    "geometry", [{"type": "Point", "coordinates": []}, {"type": "LineString"}, {"type": "Knot"}]
)
def test_a_door_without_a_place_is_named(geometry: dict[str, Any]) -> None:
    door = {"type": "Feature", "properties": {"type": "door"}, "geometry": geometry}
    with pytest.raises(RequestError, match=r"plan: features\[1\]: its geometry is invalid"):
        read_plan(collection(feature(SQUARE), door))


def test_holes_are_cut_out_and_parts_of_a_multipolygon_are_rooms() -> None:
    ring = shapely.box(0, 0, 9, 9).difference(shapely.box(3, 3, 6, 6))
    plan = read_plan(collection(feature(ring, name="Flur"), feature(shapely.box(3, 3, 6, 6), name="Bad")))
    assert sum(room.area for room in plan.rooms) == pytest.approx(81, abs=1e-3)
    both = shapely.MultiPolygon([shapely.box(0, 0, 4, 4), shapely.box(4, 0, 8, 4)])
    assert [room.name for room in read_plan(feature(both, name="Zimmer")).rooms] == ["Zimmer", "Zimmer 2"]
