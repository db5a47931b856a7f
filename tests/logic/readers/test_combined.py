"""A room of several uses becomes a room for each use, open to each other, in every format and unit."""

import warnings
from collections.abc import Iterator
from itertools import combinations
from typing import Any

import pytest
import shapely
from shapely import Polygon, affinity, box
from shapely.geometry import mapping

from vitruvius.logic import PlanWarning
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.own_plan import OwnPlan

LARGE, MIDDLE, SMALL = box(0, 0, 8, 5), box(0, 0, 6, 5), box(0, 0, 4, 3)
ELL = Polygon([(0, 0), (9, 0), (9, 4), (5, 4), (5, 7), (0, 7)])


@pytest.fixture(autouse=True)
def _warnings_are_read_where_they_are_claimed() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PlanWarning)
        yield


def collection(*rooms: tuple[str, Any], doors: Any = (), windows: Any = ()) -> dict[str, Any]:
    features = [
        *(
            {"type": "Feature", "properties": {"name": name}, "geometry": mapping(shape)}
            for name, shape in rooms
        ),
        *({"type": "Feature", "properties": {"type": "door"}, "geometry": mapping(door)} for door in doors),
        *(
            {"type": "Feature", "properties": {"type": "window"}, "geometry": mapping(pane)}
            for pane in windows
        ),
    ]
    return {"type": "FeatureCollection", "features": features}


def types(plan: OwnPlan) -> list[str]:
    return sorted(room.type for room in plan.rooms)


@pytest.mark.parametrize(
    ("name", "shape", "wanted"),
    [
        ("Wohnen/Essen/Kochen", LARGE, ["dining", "kitchen", "living"]),
        ("Wohnen/Essen/Kochen", affinity.rotate(LARGE, 31, origin=(0, 0)), ["dining", "kitchen", "living"]),
        ("Kitchen / Dining / Living", ELL, ["dining", "kitchen", "living"]),
        ("Wohnküche", MIDDLE, ["kitchen", "living"]),
        ("OH+K", MIDDLE, ["kitchen", "living"]),
        ("Salón-comedor", LARGE, ["dining", "living"]),
        ("Cuisine ouverte sur séjour", LARGE, ["kitchen", "living"]),
        ("Keuken/eetkamer", MIDDLE, ["dining", "kitchen"]),
        ("Kitchen/Diner", SMALL, ["kitchen"]),
        ("Living/Dining", box(0, 0, 4, 5), ["living"]),
        ("Bad/WC", SMALL, ["bathroom"]),
    ],
)
def test_each_use_for_which_there_is_floor_is_a_room_open_to_the_others(
    name: str, shape: Polygon, wanted: list[str]
) -> None:
    plan = read_plan(collection((name, shape)))
    assert types(plan) == wanted
    boxes = {room.name: box(*room.box) for room in plan.rooms}
    assert sum(each.area for each in boxes.values()) == pytest.approx(shape.area, abs=0.01)
    open_to = {frozenset(door.between): door.length for door in plan.doors if door.opening}
    for (one, a), (other, b) in combinations(boxes.items(), 2):
        shared = a.buffer(1e-3, join_style="mitre").intersection(b).length / 2
        if shared > 0.7:
            assert open_to[frozenset((one, other))] == pytest.approx(shared, abs=0.02)


def test_what_is_read_as_several_rooms_is_said_and_named_by_its_parts() -> None:
    with pytest.warns(
        PlanWarning, match=r"Wohnen/Essen/Kochen is read as 3 rooms that are open to each other: Wohnen,"
    ):
        plan = read_plan(collection(("Wohnen/Essen/Kochen", LARGE)))
    assert {room.name: room.type for room in plan.rooms} == {
        "Wohnen": "living", "Essen": "dining", "Kochen": "kitchen"
    }  # fmt: skip
    assert {room.name for room in read_plan(collection(("Wohnküche", MIDDLE))).rooms} == {
        "Wohnküche living", "Wohnküche kitchen"
    }  # fmt: skip


def test_a_use_that_another_room_has_is_none_of_a_room_of_several() -> None:
    plan = read_plan(collection(("Wohnküche", MIDDLE), ("Wohnzimmer", box(6, 0, 11, 5))))
    assert [(room.name, room.type) for room in plan.rooms] == [
        ("Wohnküche", "kitchen"),
        ("Wohnzimmer", "living"),
    ]
    plan = read_plan(collection(("Wohnen/Kochen", LARGE), ("Kochen/Essen", box(8, 0, 12, 5))))
    assert types(plan) == ["dining", "kitchen", "living"]


@pytest.mark.parametrize("metres", [1, 0.001])
def test_no_cut_meets_a_door_and_each_part_has_one_of_the_windows(metres: float) -> None:
    """The best division of the floor would cut the south wall at x 4.2, where the door is."""
    door, panes = box(3.8, -0.1, 4.7, 0.1), (box(1, 4.9, 2, 5.1), box(7, 4.9, 7.8, 5.1))
    hall = ("Diele", box(0, -3, 8, 0))
    record = collection(("Wohnen/Kochen", LARGE), hall, doors=[door], windows=panes)
    for each in record["features"]:
        shape = affinity.scale(
            shapely.geometry.shape(each["geometry"]), 1 / metres, 1 / metres, origin=(0, 0)
        )
        each["geometry"] = mapping(shape)
    plan = read_plan(record, None if metres == 1 else str(metres))
    living, kitchen = (
        next(room for room in plan.rooms if room.type == kind) for kind in ("living", "kitchen")
    )
    assert {window.room for window in plan.windows} == {living.name, kitchen.name}
    [(start, end)] = [(d.x, d.x + d.width) for d in plan.doors if not d.opening]
    assert not start - 0.05 < max(living.x, kitchen.x) < end + 0.05


def test_a_room_of_one_word_keeps_its_place_beside_one_that_is_cut() -> None:
    rooms = (("Bad", box(8, 0, 10, 2)), ("Wohnküche", LARGE), ("Flur", box(0, 5, 8, 6.5)))
    plan = read_plan(collection(*rooms))
    boxes = {room.name: room.box for room in plan.rooms}
    assert boxes["Bad"] == (8, 4.5, 10, 6.5)
    assert boxes["Flur"] == (0, 0, 8, 1.5)
