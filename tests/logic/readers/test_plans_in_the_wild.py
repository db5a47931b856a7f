"""Plans as in public data sets: boxes over walls, bevels, slivers, stubs and niches, checked by shapely."""

import json
import warnings
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import shapely
from shapely import LineString, Polygon, box
from shapely.geometry import mapping

from tests.logic.readers.test_readers import Ring, svg
from vitruvius.logic import House, PlanWarning, RequestError, load
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.own_plan import OwnPlan
from vitruvius.sim import HouseVectorEnv

WALL = 0.12

ROOMS = {
    "Living_Room": box(0.1, 0.1, 5.1, 4.1),
    "Hallway": box(0.1, 4.22, 5.1, 5.52),
    "Kitchen": box(5.22, 0.1, 8.2, 2.8),
    "Bedroom": box(5.22, 2.92, 8.2, 7.4),
    "Bathroom": box(0.1, 5.64, 2.6, 7.4),
}

GAPS = {
    frozenset(("Living Room", "Hallway")): box(1.0, 4.1, 1.9, 4.22),
    frozenset(("Living Room", "Kitchen")): box(5.1, 0.8, 5.22, 2.6),
    frozenset(("Hallway", "Bedroom")): box(5.1, 4.4, 5.22, 5.3),
    # Beside a wall that continues: a wall ends on one side of it only.
    frozenset(("Hallway", "Bathroom")): box(0.1, 5.52, 0.9, 5.64),
}


@pytest.fixture(autouse=True)
def _warnings_are_read_where_they_are_claimed() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        yield


def bevelled(shape: Any) -> list[list[float]]:
    """Return the corners of an outline from a picture of 1 cm per pixel, each with a bevel."""
    ring = [shapely.Point(each) for each in shape.exterior.coords[:-1]]
    found = []
    for before, corner, after in zip([ring[-1], *ring[:-1]], ring, [*ring[1:], ring[0]], strict=True):
        found += [LineString([corner, other]).interpolate(0.01) for other in (before, after)]
    return [[round(point.x, 2), round(point.y, 2)] for point in found]


def houseexpo(
    rooms: Mapping[str, Polygon], gaps: Sequence[Polygon], reach: Sequence[float] = (0.12, 0.12, 0.12, 0.12)
) -> dict[str, Any]:
    """Return a file of HouseExpo whose boxes reach over the walls, west, north, east and south."""
    floor = shapely.union_all([*rooms.values(), *gaps], grid_size=0.01)
    boxes = {name: [[a + b for a, b in zip(room.bounds, (-reach[0], -reach[1], *reach[2:]), strict=True)]]
             for name, room in rooms.items()}  # fmt: skip
    return {"verts": bevelled(shapely.simplify(floor, 1e-6)), "room_category": boxes, "room_num": len(rooms)}


def areas(plan: OwnPlan) -> dict[str, float]:
    """Return the floor of each room with its parts, up to the middle of walls, m²."""
    found: dict[str, float] = {}
    for room in plan.rooms:
        whole = room.part_of if isinstance(room.part_of, str) else room.name
        found[whole] = found.get(whole, 0.0) + room.area
    return found


def to_the_middle_of_walls(shape: Polygon, wall: float = WALL) -> float:
    return shape.buffer(wall / 2, join_style="mitre").area


@pytest.mark.parametrize(
    "reach",
    [(0, 0, 0, 0), (0.12, 0.12, 0.12, 0.12), (0.82, 0.12, 0.12, 0.82)],
    ids=["tight", "over-walls", "as-far-as-doors-swing"],
)
def test_rooms_and_doors_of_houseexpo_are_those_of_its_outline_whatever_its_boxes_reach(
    reach: Sequence[float],
) -> None:
    plan = read_plan(houseexpo(ROOMS, list(GAPS.values()), reach))
    assert sorted(room.type for room in plan.rooms) == [
        "bathroom",
        "bedroom",
        "corridor",
        "kitchen",
        "living",
    ]
    for name, shape in ROOMS.items():
        assert areas(plan)[name.replace("_", " ")] == pytest.approx(to_the_middle_of_walls(shape), rel=0.01)
    assert {frozenset(door.between) for door in plan.doors} == set(GAPS)
    for door in plan.doors:
        west, north, east, south = GAPS[frozenset(door.between)].bounds
        assert door.length == pytest.approx(max(east - west, south - north), abs=0.05)
        assert door.opening == (door.length > 1.3)


def test_a_room_of_houseexpo_is_one_where_a_wall_ends_in_it_and_its_box_has_both_sides() -> None:
    """The wall between two bedrooms ends at the corridor, 1.1 m from the wall opposite."""
    rooms = {"Hallway": box(0, 0, 8, 1.1), "Bedroom": box(0, 1.22, 3.94, 5), "Office": box(4.06, 1.22, 8, 5)}
    gaps = [box(1, 1.1, 1.9, 1.22), box(4.06, 1.1, 4.96, 1.22)]
    plan = read_plan(houseexpo(rooms, gaps))
    assert {room.name: room.type for room in plan.rooms} == {
        "Hallway": "corridor", "Bedroom": "bedroom", "Office": "study",
    }  # fmt: skip
    assert len(plan.doors) == 2


def test_what_boxes_of_houseexpo_part_without_a_wall_is_open_to_each_other() -> None:
    rooms = {"Living_Room": box(0, 0, 5, 4), "Kitchen": box(5, 0, 8, 4)}
    [door] = (plan := read_plan(houseexpo(rooms, []))).doors
    assert door.opening
    assert door.length == pytest.approx(4, abs=0.01)
    assert areas(plan) == pytest.approx({"Living Room": 20, "Kitchen": 12}, rel=0.01)


def test_a_bathroom_of_houseexpo_with_a_toilet_is_a_bathroom_and_floor_without_a_box_is_a_room() -> None:
    record = houseexpo(ROOMS, list(GAPS.values()))
    del record["room_category"]["Hallway"]
    record["room_category"] = {"Toilet": record["room_category"]["Bathroom"], **record["room_category"]}
    kinds = {room.name: room.type for room in read_plan(record).rooms}
    assert kinds["Bathroom"] == "bathroom"
    assert kinds["Room"] == ""


def test_the_default_backend_takes_a_plan_of_houseexpo_with_bevels(tmp_path: Path) -> None:
    record = houseexpo(ROOMS, list(GAPS.values()))
    (tmp_path / "plan.json").write_text(json.dumps(record))
    [house] = load(tmp_path / "plan.json")
    assert all(wall.box for wall in house.free_walls)
    drawn = Polygon(record["verts"])
    shift = [sum(drawn.bounds[k::2]) / 2 for k in (0, 1)]
    assert shapely.hausdorff_distance(outline(house, shift), drawn.boundary) < 0.011
    HouseVectorEnv([house], num_envs=2).reset(seed=0)


def test_a_wall_at_an_angle_in_houseexpo_stays_as_it_is_drawn(tmp_path: Path) -> None:
    ring = [(0.01, 0), (0, 0.01), (0, 4), (3, 4), (5, 2), (5, 0)]
    (tmp_path / "plan.json").write_text(json.dumps({"verts": ring, "room_category": {}}))
    [house] = load(tmp_path / "plan.json")
    assert shapely.hausdorff_distance(outline(house, (2.5, 2)), Polygon(ring).boundary) < 1e-6


def outline(house: House, shift: Sequence[float]) -> shapely.Geometry:
    x, y = shift
    return shapely.union_all(
        [LineString([(w.x1 + x, w.y1 + y), (w.x2 + x, w.y2 + y)]) for w in house.free_walls]
    )


def resplan(rooms: Mapping[str, Any], doors: Sequence[Polygon], unit: float = 0.05) -> dict[str, Any]:
    """Return a plan with the keys of ResPlan's pickle, in units of ``unit`` metres. The rest is wall."""
    inner = shapely.union_all([*rooms.values(), *doors]).buffer(WALL, join_style="mitre")
    shapes = {**rooms, "inner": inner, "wall": inner - shapely.union_all(list(rooms.values())),
              "door": shapely.MultiPolygon(doors), "window": shapely.MultiPolygon(), "land": inner.buffer(1),
              "balcony": shapely.MultiPolygon(), "stair": shapely.MultiPolygon()}  # fmt: skip
    scaled = {key: shapely.transform(shape, lambda corners: corners / unit) for key, shape in shapes.items()}
    neighbours = (shapely.MultiPolygon([box(0, 0, 1, 9)]), shapely.MultiPolygon())
    return {**scaled, "neighbor": neighbours, "front_door": shapely.MultiPolygon(), "area": inner.area,
            "net_area": 1.0, "wall_depth": WALL / unit, "unitType": "Apartment", "id": 3}  # fmt: skip


@pytest.mark.parametrize("as_json", [False, True], ids=["python", "json"])
def test_strips_of_an_open_living_room_in_resplan_are_none_and_it_is_open_to_the_kitchen(
    as_json: bool,
) -> None:
    kitchen, hall = box(1.95, 3.3, 3.67, 6.2), box(0, 0, 5, 3.33)
    rooms = {
        "kitchen": kitchen, "living": (hall | kitchen.buffer(0.03, join_style="mitre")) - kitchen,
        "bedroom": box(3.82, 3.45, 7.5, 7), "bathroom": box(5.12, 1, 7.5, 3.33),
    }  # fmt: skip
    record = resplan(rooms, [box(4, 3.33, 4.8, 3.45), box(5, 2, 5.12, 2.8)])
    plan = read_plan(json.loads(json.dumps(record, default=mapping)) if as_json else record)
    assert sorted(areas(plan)) == ["bathroom", "bedroom", "kitchen", "living"]
    assert areas(plan)["living"] == pytest.approx(to_the_middle_of_walls(hall), rel=0.03)
    # The kitchen has no wall in the north.
    assert areas(plan)["kitchen"] == pytest.approx((1.72 + WALL) * (2.9 + WALL / 2), rel=0.02)
    opened = {frozenset(door.between): door.length for door in plan.doors if door.opening}
    assert opened == {frozenset(("living", "kitchen")): pytest.approx(1.72, abs=0.2)}
    assert len(plan.doors) == 3


HALL: tuple[str, Ring] = ("Entry", [(4, 0), (6, 0), (6, 4), (4, 4)])
DOOR = '<g id="Door" class="Door"><polygon points="390,100 400,100 400,180 390,180"/></g>'


def drawn(folder: Path, *rooms: tuple[str, Ring], more: str = DOOR) -> OwnPlan:
    (folder / "plan.svg").write_bytes(svg(*rooms, more=more))
    return read_plan(folder / "plan.svg")


@pytest.mark.parametrize("thick", [0.06, 0.1, 0.3])
def test_a_wall_that_stands_into_a_room_is_left_out_and_said_to_be(thick: float, tmp_path: Path) -> None:
    stub: Ring = [
        (0, 0),
        (1.5, 0),
        (1.5, 0.9),
        (1.5 + thick, 0.9),
        (1.5 + thick, 0),
        (3.9, 0),
        (3.9, 4),
        (0, 4),
    ]
    with pytest.warns(PlanWarning, match=rf"wall of {thick:.2f} by 0\.90 m that stands into LivingRoom"):
        plan = drawn(tmp_path, ("LivingRoom", stub), HALL)
    assert areas(plan)["LivingRoom"] == pytest.approx(
        to_the_middle_of_walls(box(0, 0, 3.9, 4), 0.1), rel=1e-3
    )


def test_a_niche_between_two_rooms_goes_to_one_of_them(tmp_path: Path) -> None:
    """A wardrobe of the hall, 0.55 m deep, projects into the kitchen."""
    kitchen: Ring = [(0, 0), (3.9, 0), (3.9, 1), (3.35, 1), (3.35, 3), (3.9, 3), (3.9, 4), (0, 4)]
    hall: Ring = [(4, 0), (6, 0), (6, 4), (4, 4), (4, 2.9), (3.45, 2.9), (3.45, 1.1), (4, 1.1)]
    plan = drawn(tmp_path, ("Kitchen", kitchen), ("Entry", hall))
    assert areas(plan) == pytest.approx({"Kitchen": 4 * 4.1, "Entry": 2.1 * 4.1}, rel=1e-3)
    assert [door.between for door in plan.doors] == [("Kitchen", "Entry")]


def test_a_loggia_with_rooms_all_around_it_is_a_room_of_any_type(tmp_path: Path) -> None:
    rings: dict[str, Ring] = {"Bath": [(0, 0), (2.9, 0), (2.9, 2.9), (0, 2.9)]}
    rings["Bedroom"] = [(3, 0), (6, 0), (6, 4.9), (3, 4.9)]
    rings["Outdoor"] = [(0, 3), (2.9, 3), (2.9, 4.9), (0, 4.9)]
    rings["LivingRoom"] = [(-4, 0), (-0.1, 0), (-0.1, 8), (-4, 8)]
    rings["Kitchen"] = [(0, 5), (6, 5), (6, 8), (0, 8)]
    with pytest.warns(PlanWarning, match="between rooms, so they may have any type: Outdoor"):
        plan = drawn(tmp_path, *rings.items())
    assert {room.name: room.type for room in plan.rooms}["Outdoor"] == ""


def test_of_rooms_that_lie_apart_the_nearest_two_are_named_and_their_gap_is_as_drawn(tmp_path: Path) -> None:
    flats = [(0, 2.9), (3, 2.9), (9.6, 1.9), (6.55, 2.95)]
    rooms = [
        (x, wide, name)
        for (x, wide), name in zip(flats, ("LivingRoom", "Kitchen", "Bath", "Bedroom"), strict=True)
    ]
    rings: list[tuple[str, Ring]] = [
        (name, [(x, 0), (x + wide, 0), (x + wide, 2.9), (x, 2.9)]) for x, wide, name in rooms
    ]
    with pytest.raises(RequestError, match=r"Bedroom shares no wall .* which is Kitchen, 0\.650 m off"):
        drawn(tmp_path, *rings, more="")


def test_a_snap_is_proposed_where_it_does_and_only_there(tmp_path: Path) -> None:
    def beside(off: float) -> tuple[str, Ring]:
        return "Entry", [(x - off, y) for x, y in HALL[1]]

    living: tuple[str, Ring] = ("LivingRoom", [(0, 0), (3.9, 0), (3.9, 4), (0, 4)])
    with pytest.raises(RequestError, match=r"by 0\.080 m: .*, or give --snap 0\.05, which reads this plan"):
        drawn(tmp_path, living, beside(0.18))
    assert len(read_plan(tmp_path / "plan.svg", snap=0.05).rooms) == 2
    with pytest.raises(RequestError) as refused:
        drawn(tmp_path, living, beside(0.7))
    assert "--snap" not in str(refused.value)


def test_beveled_corners_are_short(tmp_path: Path) -> None:
    """The files above have sides of 1.4 cm at each corner."""
    verts = houseexpo(ROOMS, list(GAPS.values()))["verts"]
    sides = [LineString(pair).length for pair in pairwise([*verts, verts[0]])]
    assert sum(side < 0.02 for side in sides) == len(verts) / 2
