"""Plans of other programs are read as rooms, doors and windows; errors name the place and a remedy."""

import codecs
import json
import warnings
import zipfile
from collections.abc import Iterator
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import pytest
import shapely
from msgspec.structs import replace
from shapely.geometry import mapping, shape

from tests.logic.readers.written import WALL, WORDS, WRITERS, resplan_record
from vitruvius.logic import Door, House, HouseFileError, PlanWarning, RequestError, load
from vitruvius.logic.layout.terms import own_requirements
from vitruvius.logic.readers import READERS
from vitruvius.logic.readers.ifc import _sketch as sketch_of
from vitruvius.logic.readers.ifc_solids import Solids
from vitruvius.logic.readers.sketch import require_plain
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.own_plan import OwnPlan

BANK = Path(__file__).parents[3] / "agent" / "houses" / "home-test-v1.jsonl.gz"
HOMES = 8

Ring = list[tuple[float, float]]

HALL: Ring = [(4, 0), (6, 0), (6, 4), (4, 4)]
LIVING: Ring = [(0, 0), (3.9, 0), (3.9, 4), (0, 4)]


@pytest.fixture(scope="module")
def homes() -> list[House]:
    return list(load(BANK)[:HOMES])


@pytest.fixture(autouse=True)
def _warnings_are_read_where_they_are_claimed() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        yield


def written(folder: Path, content: bytes, name: str = "plan") -> OwnPlan:
    (folder / name).write_bytes(content)
    return read_plan(folder / name)


def paired(home: House, plan: OwnPlan) -> dict[str, str]:
    """Return the home's rooms by the names of the plan's rooms at the same places."""
    west, north = (min(room.box[k] for room in home.rooms) for k in (0, 1))
    found = {"outside": "outside"}
    for room in home.rooms:
        middle = np.array([room.x + room.width / 2 - west, room.y + room.height / 2 - north])
        off = [abs(middle - [each.x + each.width / 2, each.y + each.height / 2]).sum() for each in plan.rooms]
        found[plan.rooms[int(np.argmin(off))].name] = room.name
    assert len(found) == len(plan.rooms) + 1 == len(home.rooms) + 1
    return found


def shared(rooms: dict[str, Any]) -> set[frozenset[str]]:
    """Return the pairs of rooms that share a wall longer than walls are thick."""
    boxes = {name: shapely.box(*room.box) for name, room in rooms.items()}
    return {
        frozenset((a, b))
        for a, one in boxes.items()
        for b, other in boxes.items()
        if a < b and one.buffer(1e-4, join_style="mitre").intersection(other).area > 1.5e-4 * WALL
    }


@pytest.mark.parametrize("format", ["houseexpo", "cubicasa", "imdf", "ifc"])
def test_a_home_in_another_format_is_the_same_rooms_doors_and_windows(
    format: str, homes: list[House], tmp_path: Path
) -> None:
    for seed, home in enumerate(homes):
        plan = written(tmp_path, WRITERS[format](home, np.random.default_rng(seed), 0.01))
        names = paired(home, plan)
        ours = {room.name: room for room in home.rooms}
        for room in plan.rooms:
            same = ours[names[room.name]]
            assert abs(room.width - same.width) < 0.03
            assert abs(room.height - same.height) < 0.03
            assert room.type == same.type
        theirs = {names[room.name]: room for room in plan.rooms}
        assert shared(theirs) == shared(ours)
        joined = {frozenset(names[each] for each in door.between) for door in plan.doors}
        if format != "houseexpo":
            assert joined == {frozenset(door.between) for door in home.doors}
        assert all(door.length == pytest.approx(0.8) for door in plan.doors if format != "houseexpo")
        if format in ("cubicasa", "ifc"):
            assert len(plan.windows) == len(home.windows)


def test_floor_between_rooms_of_houseexpo_is_a_door(homes: list[House], tmp_path: Path) -> None:
    found = wanted = 0
    for seed, home in enumerate(homes):
        plan = written(tmp_path, WRITERS["houseexpo"](home, np.random.default_rng(seed), 0.01))
        names = paired(home, plan)
        ours = {frozenset(door.between) for door in home.doors if not door.is_entrance}
        theirs = {frozenset(names[each] for each in door.between) for door in plan.doors}
        assert theirs <= ours
        found, wanted = found + len(theirs), wanted + len(ours)
    # The outline has no holes, so a door between free-standing walls is lost with them.
    assert found >= 0.95 * wanted


def test_a_plan_of_resplan_is_read_as_python_has_it(homes: list[House], tmp_path: Path) -> None:
    record = resplan_record(homes[0], np.random.default_rng(0))
    plan = read_plan(record)
    assert plan == written(tmp_path, json.dumps(record, default=mapping).encode())
    unknown = {key: value for key, value in record.items() if key != "area"}
    with pytest.raises(RequestError, match=r"longer than .* give --plan-unit"):
        read_plan(unknown)
    metres = (record["area"] / record["inner"].area) ** 0.5
    assert read_plan(unknown, unit=str(metres)) == plan


def test_rooms_of_resplan_that_have_a_word_are_the_same(homes: list[House], tmp_path: Path) -> None:
    """The rest is open to the living room, which becomes a room of several corners, cut into boxes."""
    for seed, home in enumerate(homes):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            plan = written(tmp_path, WRITERS["resplan"](home, np.random.default_rng(seed), 0.01))
        west, north = (min(room.box[k] for room in home.rooms) for k in (0, 1))
        found = {room.type: [] for room in plan.rooms}
        for room in plan.rooms:
            found[room.type].append(room)
        for room in home.rooms:
            if room.type in WORDS["resplan"] and room.type != "living":
                box = np.array(room.box) - [west, north, west, north]
                assert any(np.abs(box - each.box).max() < 0.04 for each in found[room.type])
        assert sum(room.area for room in plan.rooms) == pytest.approx(
            sum(room.area for room in home.rooms), rel=0.02
        )
        assert len(found["living"]) == 1
        assert ("" in found) == any(
            "corners, and rooms are rectangles: it is read" in str(each.message) for each in said
        )
        assert len(plan.windows) == len(home.windows)
        assert [door for door in plan.doors if door.is_entrance]


def houseexpo(**rooms: Ring) -> bytes:
    """Return a file of HouseExpo with rooms of any shape and their bounding boxes."""
    shapes = {name: shapely.Polygon(ring) for name, ring in rooms.items()}
    floor = (
        shapely.union_all(list(shapes.values()))
        .buffer(0.1, join_style="mitre")
        .buffer(-0.1, join_style="mitre")
    )
    boxes = {name: [shape.bounds] for name, shape in shapes.items()}
    return json.dumps({"verts": mapping(floor)["coordinates"][0], "room_category": boxes}).encode()


def svg(*rooms: tuple[str, Ring], more: str = "") -> bytes:
    """Return rooms as CubiCasa5K writes them."""
    points = [" ".join(f"{100 * x},{100 * y}" for x, y in ring) for _, ring in rooms]
    groups = [
        f'<g class="Space {kind}"><polygon points="{each} "/></g>'
        for (kind, _), each in zip(rooms, points, strict=True)
    ]
    return f'<svg xmlns="http://www.w3.org/2000/svg"><g id="Model">{"".join(groups)}{more}</g></svg>'.encode()


def imdf(*rings: Ring, degree: float = 1e-5, levels: str = "000") -> bytes:
    """Return units of IMDF, about a metre per ``degree``."""
    features = [
        {
            "type": "Feature", "id": str(number), "feature_type": "unit",
            "geometry": {"type": "Polygon", "coordinates": [[(x * degree, y * degree) for x, y in ring]]},
            "properties": {"category": "room", "level_id": level},
        }
        for number, (ring, level) in enumerate(zip(rings, levels, strict=False))
    ]  # fmt: skip
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


def test_a_room_of_several_corners_becomes_boxes_of_which_the_largest_has_its_type(tmp_path: Path) -> None:
    ell: Ring = [(0, 0), (3.9, 0), (3.9, 4), (1.9, 4), (1.9, 7), (0, 7)]
    door = '<g id="Door" class="Door"><polygon points="390,100 400,100 400,180 390,180"/></g>'
    with pytest.warns(PlanWarning, match="LivingRoom has 6 corners.*2 rooms, LivingRoom, LivingRoom 2"):
        plan = written(tmp_path, svg(("LivingRoom", ell), ("HallWay", HALL), more=door))
    rooms = {room.name: room for room in plan.rooms}
    assert rooms["LivingRoom"].box == (0, 0, 4, 4.1)
    assert rooms["LivingRoom 2"].box == (0, 4.1, 2, 7.1)
    assert [room.type for room in plan.rooms] == ["living", "", "corridor"]
    # The whole wall between the parts is open.
    assert {door.between: door.length for door in plan.doors} == {
        ("LivingRoom", "HallWay"): pytest.approx(0.8),
        ("LivingRoom", "LivingRoom 2"): pytest.approx(2.0),
    }


def test_a_niche_is_left_out_and_said_to_be(tmp_path: Path) -> None:
    dented: Ring = [(0, 0), (3.9, 0), (3.9, 4), (2, 4), (2, 4.3), (1, 4.3), (1, 4), (0, 4)]
    with pytest.warns(PlanWarning, match=r"a niche of LivingRoom of 1\.10 by 0\.30 m is left out"):
        plan = written(tmp_path, svg(("LivingRoom", dented), ("HallWay", HALL)))
    assert [room.height for room in plan.rooms] == pytest.approx([4.1, 4.1])


def test_rooms_of_houseexpo_are_cut_out_of_the_boxes_of_larger_ones(tmp_path: Path) -> None:
    ell: Ring = [(0, 0), (5, 0), (5, 3), (3, 3), (3, 6), (0, 6)]
    plan = written(tmp_path, houseexpo(Living_Room=ell, Kitchen=[(3, 3), (5, 3), (5, 6), (3, 6)]))
    assert {room.name: room.area for room in plan.rooms} == {
        "Living Room": 18,
        "Living Room 2": 6,
        "Kitchen": 6,
    }


def outer_door(x: float, y: float, word: str = "Door") -> str:
    """Return a door in a wall that runs west to east, 0.8 m wide, as CubiCasa5K writes it."""
    west, north = 100 * x, 100 * y
    ring = f"{west},{north} {west + 80},{north} {west + 80},{north + 10} {west},{north + 10}"
    return f'<g class="{word}"><polygon points="{ring}"/></g>'


def test_what_is_no_room_is_passed_over_and_a_door_to_it_is_a_window_or_a_garden_door(tmp_path: Path) -> None:
    """It becomes a window in a plan that draws windows. In a plan without them it would be the only one."""
    doors = outer_door(1, -0.1) + outer_door(4.5, -0.1)
    balcony = ("Outdoor Balcony", [(0, -2), (3, -2), (3, -0.1), (0, -0.1)])
    rooms = (("LivingRoom", LIVING), ("Entry", HALL), balcony)
    with pytest.warns(PlanWarning, match="ignored, because they are not rooms: Outdoor"):
        plan = written(tmp_path, svg(*rooms, more=doors + outer_door(1, 4, "Window")))
    assert [window.room for window in plan.windows] == ["LivingRoom"] * 2
    assert [door.between for door in plan.doors] == [("Entry", "outside")]
    plan = written(tmp_path, svg(*rooms, more=doors))
    assert plan.windows == ()
    assert [door.between for door in plan.doors] == [("Entry", "outside"), ("LivingRoom", "outside")]


@pytest.mark.parametrize(
    ("rooms", "entrance"),
    [
        (("LivingRoom", "Entry"), 1),
        (("LivingRoom", "HallWay"), 1),
        (("HallWay", "Entry"), 1),
        (("Kitchen", "LivingRoom"), 1),
        (("Bedroom", "Kitchen"), 0),
        (("Entry", "LivingRoom"), 0),
    ],
)
def test_of_doors_that_lead_outside_the_readers_choose_the_entrance(
    rooms: tuple[str, str], entrance: int, tmp_path: Path
) -> None:
    model = svg((rooms[0], LIVING), (rooms[1], HALL), more=outer_door(1, -0.1) + outer_door(4.5, -0.1))
    first, other = rooms[entrance], rooms[1 - entrance]
    wanted = (
        f"2 doors lead outside: the one of {first} becomes the entrance, the one of {other} a garden door"
    )
    with pytest.warns(PlanWarning, match=wanted):
        plan = written(tmp_path, model)
    assert [door.between for door in plan.doors] == [(first, "outside"), (other, "outside")]


@pytest.mark.parametrize("format", ["cubicasa", "imdf", "ifc"])
def test_a_garden_door_is_read_beside_the_entrance(format: str, homes: list[House], tmp_path: Path) -> None:
    """The door replaces a window of a living room, and the reader distinguishes it from the front door."""
    home = next(each for each in homes if each.start.type == "corridor")
    pane = next(each for each in home.windows if home.room(each.room).type == "living")
    x, y, width, height = pane.x, pane.y, min(pane.width, 0.8), min(pane.height, 0.8)
    garden = Door(x, y, width, height, (pane.room, "outside"))
    windows = tuple(each for each in home.windows if each.room != pane.room)
    changed = replace(home, doors=(garden, *home.doors), windows=windows)
    plan = written(tmp_path, WRITERS[format](changed, np.random.default_rng(0), 0.01))
    rooms = {room.name: room.type for room in plan.rooms}
    outer = [rooms[door.between[0]] for door in plan.doors if door.is_entrance]
    assert outer == ["hall", "living"]
    assert len(plan.doors) == len(changed.doors)


def test_a_word_that_no_table_has_is_a_room_of_any_type(tmp_path: Path) -> None:
    with pytest.warns(PlanWarning, match="of no known type, so these rooms may have any type: Ballroom"):
        plan = written(tmp_path, svg(("LivingRoom", LIVING), ("Ballroom", HALL)))
    assert [room.type for room in plan.rooms] == ["living", ""]


def test_a_byte_order_mark_changes_no_plan(homes: list[House], tmp_path: Path) -> None:
    for format in ("houseexpo", "resplan", "cubicasa", "ifc"):
        content = WRITERS[format](homes[0], np.random.default_rng(0), 0.01)
        assert written(tmp_path, codecs.BOM_UTF8 + content) == written(tmp_path, content)


def test_a_file_that_is_too_large_is_said_to_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model that was cut there would be reported as damaged."""
    monkeypatch.setattr("vitruvius.logic.request.given_plan.MOST_BYTES", 1 << 20)
    with pytest.raises(HouseFileError, match="more than 1 MiB: a plan is of one house"):
        written(tmp_path, b"ISO-10303-21;\nFILE_SCHEMA(('IFC4'));\n" + bytes(1 << 20))


@pytest.mark.parametrize(("unit", "width"), [(None, 2.1), ("0.02", 4.2), ("mm", None)])
def test_a_unit_that_is_said_is_taken_for_that_of_the_file(
    unit: str | None, width: float | None, tmp_path: Path
) -> None:
    (tmp_path / "plan").write_bytes(svg(("LivingRoom", LIVING), ("HallWay", HALL)))
    if width is None:
        with pytest.raises(
            RequestError, match=r"are shorter than 0\.4 m: mm is not its unit: give another with --plan-unit"
        ):
            read_plan(tmp_path / "plan", unit)
        return
    rooms = {room.name: room for room in read_plan(tmp_path / "plan", unit).rooms}
    assert rooms["HallWay"].width == pytest.approx(width)


ARC: Ring = [
    (4, 0),
    (6, 0),
    *((6 + 2 * np.sin(a), 2 - 2 * np.cos(a)) for a in np.linspace(0.2, 3, 12)),
    (6, 4),
    (4, 4),
]


ROOM = ("LivingRoom", LIVING)


def hall(off: float) -> tuple[str, Ring]:
    return "Entry", [(x + off, y) for x, y in HALL]


SHORT: Ring = [(0, 4.1), (2, 4.1), (2, 6), (0, 6)]
LONG: Ring = [(0, 6.1), (6, 6.1), (6, 8), (0, 8)]
COURT = svg(ROOM, hall(0), ("Bath", SHORT), ("Bath", [(x + 4, y) for x, y in SHORT]), ("Sauna", LONG))
COMB: Ring = [(4, 0), *((6 + 0.5 * (k // 2 % 2), 0.5 * ((k + 1) // 2)) for k in range(300)), (4, 75)]
BATH = '<g class="Space Bath"><polygon points="0,0 9,0 9,9 "/></g>'
STOREYS = "".join(f'<g id="Floor-{k}" class="Floorplan Floor-{k}">{BATH}</g>' for k in (1, 2))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (svg(ROOM, ("Entry", [(4, 0), (6, 0), (7, 4), (4, 4)])), "Entry has a diagonal wall from x"),
        (svg(ROOM, ("Entry", ARC)), "Entry has an arc from x .* to x .*: draw it as steps"),
        (svg(ROOM, hall(0.6)), r"Entry shares no wall .*0\.700 m off"),
        (svg(ROOM, hall(-0.6)), r"LivingRoom overlaps Entry by 0\.500 m"),
        (COURT, r"LivingRoom, Entry, Bath, Bath 2, Sauna belong to no room, 1\.900 m wide.*draw what"),
        (svg(("Outdoor", HALL)), "has 0 rooms"),
        (svg(ROOM, ("Entry", COMB)), r"Entry has \d+ corners: at most 200 are read"),
        (svg(ROOM)[:-9], "that is damaged"),
        (b'<!DOCTYPE s [<!ENTITY a "b">]>' + svg(ROOM), "declares entities"),
        (svg(more=STOREYS), r"2 storeys with rooms \(Floor-1, Floor-2\): choose one"),
        (imdf(LIVING, HALL, degree=1e3), "degrees of longitude and latitude"),
        (imdf(LIVING, HALL, levels="01"), r"2 storeys with rooms \(0, 1\): choose one, as in --storey 0"),
        (imdf([]), "IMDF has units with polygons: it has none"),
        (imdf(LIVING[:1]), "geometry of unit 0 is invalid"),
        (b'{"verts": [[0, 0]], "room_category": {}}', "at least four corners"),
        (b'{"verts": [[0,0],[1,0],[1,1],[0,1e99]], "room_category": {}}', "at least four corners"),
        (b'{"verts": [[0,0],[9,0],[9,9],[0,9]], "room_category": {"Bath": [[0,0,1]]}}', "a box of Bath"),
        (b'{"verts": [[0,0],[9,0],[9,9],[0,9]], "room_category": []}', "an object of lists of boxes"),
        (b'{"inner": 1, "wall": 1, "door": 1, "window": {"type": "Polygon"}}', "window of .* is not"),
        (b'{"inner": [], "wall": [], "door": [], "window": []}', "has 0 rooms"),
    ],
)  # fmt: skip
def test_what_is_no_plan_says_where_and_what_would_do(content: bytes, says: str, tmp_path: Path) -> None:
    with pytest.raises(RequestError, match=says) as refused:
        written(tmp_path, content)
    assert str(refused.value).startswith("plan: ")
    assert "\n" not in str(refused.value)


def test_a_storey_of_cubicasa_and_a_level_of_imdf_are_read_by_name(tmp_path: Path) -> None:
    (tmp_path / "plan").write_bytes(
        svg(("Bath", LIVING), more=STOREYS.replace("0,0 9,0 9,9", "0,0 9,0 9,9 0,9"))
    )
    assert read_plan(tmp_path / "plan", "1", storey="floor-2").rooms[0].width == 9
    levels = [
        {"type": "Feature", "id": str(number), "feature_type": "level", "geometry": None,
         "properties": {"name": {"en": name}, "ordinal": number}}
        for number, name in ((1, "Upper"), (0, "Ground"))
    ]  # fmt: skip
    record = json.loads(imdf(LIVING, HALL, levels="01"))
    record["features"] += levels
    with pytest.raises(RequestError, match=r"2 storeys with rooms \(Ground, Upper\): choose one"):
        read_plan(record)
    assert read_plan(record, storey="upper").rooms[0].height == pytest.approx(4.42, abs=0.1)
    for one in (houseexpo(Hall=HALL), b'{"inner": [], "wall": [], "door": [], "window": []}'):
        (tmp_path / "plan").write_bytes(one)
        with pytest.raises(RequestError, match="it has one storey, without a name: leave --storey out"):
            read_plan(tmp_path / "plan", storey="upper")


def test_an_svg_picture_without_rooms_is_none_of_them(tmp_path: Path) -> None:
    with pytest.raises(HouseFileError, match="is an SVG picture"):
        written(tmp_path, svg())


def test_an_archive_is_read_to_a_limit(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "plan", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("unit.geojson", b" " * (1 << 25))
    with pytest.raises(RequestError, match="hold more than 16 MiB together"):
        read_plan(tmp_path / "plan")
    with zipfile.ZipFile(tmp_path / "plan", "w") as archive:
        archive.writestr("unit.geojson", b"[" * 100_000)
    with pytest.raises(RequestError, match="is not a feature collection"):
        read_plan(tmp_path / "plan")


def stars(format: str) -> bytes:
    """Sixteen rooms, each of which crosses itself nearly as often as the outlines of a file may together."""
    turns = 2 * np.pi * 50 / 101 * np.arange(101)
    star = np.stack([40 + 30 * np.cos(turns), 40 + 30 * np.sin(turns)], 1)
    rings: list[Ring] = [[*(star + 100 * k).tolist(), (star[0] + 100 * k).tolist()] for k in range(16)]
    if format == "cubicasa":
        return svg(*(("LivingRoom", ring) for ring in rings))
    if format == "imdf":
        return imdf(*rings, levels="0" * 16)
    shapes = [{"type": "Polygon", "coordinates": [ring]} for ring in rings]
    if format == "resplan":
        parts = dict.fromkeys(("inner", "wall", "door", "window"))
        return json.dumps(parts | {f"room {k}": shape for k, shape in enumerate(shapes)}).encode()
    doors = [{"kind": "door"} if format == "doors" and k else None for k in range(16)]
    features = [
        {"type": "Feature", "properties": each, "geometry": shape}
        for each, shape in zip(doors, shapes, strict=True)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}).encode()


@pytest.mark.parametrize("format", ["cubicasa", "imdf", "resplan", "geojson", "doors", "ifc", "world"])
def test_the_outlines_of_all_shapes_of_a_file_are_bounded_together(
    format: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """1,024 rooms, each within the bounds, made a reader work for minutes before it said so."""
    monkeypatch.setattr(shapely, "make_valid", lambda *_, **__: pytest.fail("made valid before the check"))
    (path := tmp_path / "plan.geojson").write_bytes(content := stars(format))

    def of_ifc(_: Path) -> object:
        each = [shapely.to_wkt(shape(one["geometry"])) for one in json.loads(content)["features"]]
        return sketch_of(Solids([], each[:8], each[8:]))

    read = {"world": load, "ifc": of_ifc}.get(format, read_plan)
    with pytest.raises((RequestError, HouseFileError), match="its outlines cross each other too often"):
        read(path)


def test_sides_whose_bounding_boxes_overlap_too_often_are_refused_before_they_are_compared() -> None:
    """A star of 20,000 points, whose sides do not cross, took 26 s, and one of 65,000 minutes."""
    turns, far = 2 * np.pi * np.arange(20000) / 20000, np.where(np.arange(20000) % 2, 50, 20)
    star = shapely.Polygon(np.stack([far * np.cos(turns), far * np.sin(turns)], 1))
    start = process_time()
    with pytest.raises(RequestError, match="cross each other too often"):
        require_plain([star])
    assert process_time() - start < 2


def test_a_plan_of_houseexpo_of_too_many_doorways_is_refused_before_rooms_are_joined(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two thousand doorways took minutes: each joins the rooms beside it, and compares them with boxes."""
    monkeypatch.setattr(
        "vitruvius.logic.readers.houseexpo.cut", lambda *_: pytest.fail("joined before the check")
    )
    walls = [(3 * k + x, y) for k in range(1500) for x, y in ((2.9, 0), (2.9, 2), (3, 2), (3, 0))]
    record = {
        "verts": [(0, 0), *walls, (4501, 0), (4501, 3), (0, 3)],
        "room_category": {"Bath": [[0, 0, 3, 3]]},
    }
    with pytest.raises(RequestError, match="too many corners, doorways and boxes"):
        read_plan(record)


def test_formats_are_not_taken_for_each_other(homes: list[House]) -> None:
    for format, write in WRITERS.items():
        content = write(homes[0], np.random.default_rng(0), 0.0)
        record = json.loads(content) if content.startswith(b"{") else None
        names = [reader.read.__name__ for reader in READERS if reader.recognises(content, record)]
        assert names == [f"read_{format}"]


def test_where_a_room_has_no_door_in_the_drawing_there_may_be_more(tmp_path: Path) -> None:
    door = '<g id="Door"><polygon points="390,100 400,100 400,180 390,180"/></g>'
    rooms = (("LivingRoom", LIVING), ("HallWay", HALL), ("Bath", [(0, 4.1), (3, 4.1), (3, 6), (0, 6)]))
    with pytest.warns(PlanWarning, match="no drawn door leads to Bath: doors may be added"):
        plan = written(tmp_path, svg(*rooms, more=door))
    assert plan.has_more_doors
    assert "plan: there are no other doors" not in own_requirements(plan).values()
    assert not written(tmp_path, svg(*rooms[:2], more=door)).has_more_doors


def test_a_door_beside_the_end_of_a_wall_is_as_wide_as_it_is_drawn(tmp_path: Path) -> None:
    door = '<g id="Door"><polygon points="390,-9 400,-9 400,71 390,71"/></g>'
    [found] = written(tmp_path, svg(("LivingRoom", LIVING), ("HallWay", HALL), more=door)).doors
    assert found.length == pytest.approx(0.8)
    assert found.y == 0


def test_ifc_that_cannot_be_read_says_what_would_do(
    homes: list[House], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = WRITERS["ifc"](homes[0], np.random.default_rng(0), 0.0)
    with pytest.raises(RequestError, match="plan: the IFC file has no IfcSpace, one for each"):
        written(tmp_path, content.replace(b"IFCSPACE(", b"IFCZONE("))
    with pytest.raises(
        RequestError, match="its schema is IFC4RC4, which IfcOpenShell does not read: export it"
    ):
        written(tmp_path, content.replace(b"(('IFC4'))", b"(('IFC4RC4'))"))
    with pytest.raises(RequestError, match=r"IfcSpace .* has no readable solid"):
        written(tmp_path, content.replace(b"IFCEXTRUDEDAREASOLID(", b"IFCSURFACECURVESWEPTAREASOLID("))
    monkeypatch.setattr("vitruvius.logic.readers.ifc.SECONDS", 0.01)
    with pytest.raises(RequestError, match="IfcOpenShell cannot read: export it again"):
        written(tmp_path, content)
    monkeypatch.undo()
    with pytest.raises(RequestError, match="damaged: its end is missing"):
        written(tmp_path, content[:2000])
