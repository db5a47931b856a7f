"""Walls with a thickness: rooms, doors and areas reconstructed from coordinates alone. 40 s."""

import json
import re
import shutil
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from msgspec import structs

from tests.logic.workers.in_process import generate
from tests.thick import faces
from vitruvius.logic import GrammarError, Unsatisfiable, check
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.exports.solids import solids
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Window
from vitruvius.logic.house.promises import Promises, Thickness
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

MASONRY = Path(__file__).parents[3] / "examples" / "masonry"
INNER, OUTER = 0.12, 0.36
"""Thickness of walls in the grammar's file, metres."""

EXACT = 1e-6
"""Tolerance, metres and square metres."""

SIZES = (SHIPPED / "home" / "sizes.pl").read_text()
AREAS = {
    name: (float(least), float(most))
    for name, least, most in re.findall(r"^room_area\((\w+),\s*([\d.]+),\s*([\d.]+)\)", SIZES, re.MULTILINE)
}
"""Areas in the file of lengths."""


@pytest.fixture(scope="module")
def builder() -> Builder:
    """Return a builder for the example.

    A process has one grammar, so the tests that load others come last.
    """
    return Builder(find(MASONRY))


@pytest.fixture(scope="module")
def houses(builder: Builder) -> list[House]:
    return [builder.house(HouseRequest(rooms), seed, 0) for rooms in (5, 8) for seed in range(2)]


def boxes(house: House, by: float = 0.0) -> Any:
    """Return the area that rooms cover, each grown by ``by`` metres."""
    return shapely.union_all([shapely.box(*room.box).buffer(by, join_style="mitre") for room in house.rooms])


def across(opening: Door | Window) -> int:
    """Return the axis at right angles to an opening's wall."""
    return int(opening.height == 0)


def test_rooms_stand_apart_by_inner_walls_and_leave_no_other_gap(houses: list[House]) -> None:
    for house in houses:
        assert check(house) == []
        assert house.wall_thickness is not None
        assert [house.wall_thickness.inner, house.wall_thickness.outer] == [INNER, OUTER]
        for one, other in combinations(house.rooms, 2):
            assert shapely.box(*one.box).distance(shapely.box(*other.box)) > INNER - EXACT
        whole = boxes(house, INNER / 2 + EXACT)
        assert whole.geom_type == "Polygon"
        assert not whole.interiors
        # The rooms, each with half of the walls around it, tile the whole.
        tiles = sum((room.width + INNER) * (room.height + INNER) for room in house.rooms)
        assert abs(whole.area - tiles) < 1e-3


def test_areas_and_sizes_are_those_within_the_walls(houses: list[House]) -> None:
    assert {"bedroom", "bathroom", "kitchen"} <= {*AREAS}
    for house in houses:
        for room in house.rooms:
            least, most = AREAS.get(room.type, (0.0, np.inf))
            assert least - EXACT <= room.width * room.height <= most + EXACT
            inside = shapely.box(*room.box).buffer(EXACT, join_style="mitre")
            assert all(inside.contains(shapely.box(*piece.box)) for piece in room.pieces)


def test_doors_lie_in_the_middle_of_walls_before_both_rooms(houses: list[House]) -> None:
    for house in houses:
        for door in house.doors:
            axis, rooms = across(door), [house.room(name) for name in door.between if name != OUTSIDE]
            for room in rooms:
                off = min(abs(door.box[axis] - face) for face in room.box[axis::2])
                assert off == pytest.approx(INNER / 2, abs=EXACT)
                start, end = door.box[1 - axis] - 0.1, door.box[3 - axis] + 0.1  # its margin
                assert room.box[1 - axis] - EXACT <= start < end <= room.box[3 - axis] + EXACT


def test_windows_and_entrances_lead_outside_through_the_whole_of_an_outer_wall(houses: list[House]) -> None:
    found = 0
    for house in houses:
        solid = boxes(house, OUTER)
        openings: list[Door | Window] = [*house.windows]
        openings += [door for door in house.doors if OUTSIDE in door.between]
        for opening in openings:
            name = (
                opening.room
                if isinstance(opening, Window)
                else next(n for n in opening.between if n != OUTSIDE)
            )
            room, axis = house.room(name), across(opening)
            way = 1 if opening.box[axis] > room.box[axis] + (room.box[axis + 2] - room.box[axis]) / 2 else -1
            start = opening.box[axis] + way * (OUTER - INNER / 2 + 1e-5)
            ends = sorted((start, start + way * 0.05))
            along = opening.box[1 - axis] + 1e-5, opening.box[3 - axis] - 1e-5
            (west, east), (north, south) = (ends, along) if axis == 0 else (along, ends)
            assert not solid.intersects(shapely.box(west, north, east, south))
            found += 1
    assert found > 20


def test_nothing_stands_nearer_to_a_doorway_than_its_clearance(houses: list[House]) -> None:
    for house in houses:
        for door in house.doors:
            x, y = (INNER / 2, 0.0) if across(door) == 0 else (0.0, INNER / 2)
            west, north, east, south = door.box
            way = shapely.box(west - x, north - y, east + x, south + y)
            for name in door.between:
                for piece in house.room(name).pieces if name != OUTSIDE else ():
                    assert way.distance(shapely.box(*piece.box)) > 0.45 - EXACT


def test_what_stops_bodies_and_rays_is_the_edge_of_rooms_and_doorways(houses: list[House]) -> None:
    for house in houses:
        lines = [[(x, low), (x, high)] for x, low, high in house.walls[0]]
        lines += [[(low, y), (high, y)] for y, low, high in house.walls[1]]
        ours: Any = shapely.union_all([shapely.LineString(line) for line in lines])
        theirs: Any = faces(house)
        assert ours.buffer(EXACT).covers(theirs)
        assert theirs.buffer(EXACT).covers(ours)


def test_solids_and_rooms_fill_the_house_up_to_the_outer_faces(houses: list[House]) -> None:
    for house in houses:
        walls = [each for each in solids(house) if each.bottom < 1.0 < each.top and each.kind != "piece"]
        area = sum((e - w) * (s - n) for _, _, (w, n, e, s), *_ in walls)
        standing = shapely.union_all([shapely.box(*each.box) for each in walls])
        assert area == pytest.approx(standing.area, abs=EXACT)  # none lies over another
        ways = sum(door.length * INNER for door in house.doors if OUTSIDE not in door.between)
        whole = boxes(house, OUTER).area
        assert whole == pytest.approx(area + ways + sum(room.area for room in house.rooms), abs=1e-5)


def broken(house: House, **changes: Any) -> list[str]:
    return check(structs.replace(house, **changes))


def test_check_says_what_is_wrong_with_walls(houses: list[House]) -> None:
    house = houses[0]
    thin = Thickness(0.1, OUTER)
    assert "house: its inner walls are 0.10 m thick (must be 0.12)" in broken(house, wall_thickness=thin)
    assert "house: its outer walls are 0 m thick (must be 0.36)" in broken(house, wall_thickness=None)
    door = next(each for each in house.doors if OUTSIDE not in each.between)
    axis = "xy"[across(door)]
    moved = structs.replace(door, **{axis: getattr(door, axis) + 0.02})
    doors = tuple(moved if each is door else each for each in house.doors)
    assert any("is not on a wall that they share" in each for each in broken(house, doors=doors))
    one, other = (house.room(name) for name in door.between)
    way = 1 if getattr(other, axis) > getattr(one, axis) else -1
    near = structs.replace(other, **{axis: getattr(other, axis) - 0.05 * way}, children=())
    rooms = tuple(near if room is other else room for room in house.rooms)
    assert any("is 0.07 m from" in each and "0.12 m thick" in each for each in broken(house, rooms=rooms))


def test_a_file_has_the_thickness_and_gives_the_same_house(houses: list[House]) -> None:
    for house in houses:
        record = json.loads(json.dumps(house.to_dict()))
        assert record["wall_thickness"] == {"inner": INNER, "outer": OUTER}
        assert House.from_dict(record) == house
        assert house.only("R0").wall_thickness == house.wall_thickness
    for wrong in ({"inner": 0.3, "outer": 0.2}, {"inner": 0, "outer": 0.2}):
        with pytest.raises(
            ValueError, match="wall_thickness: must be more than 0 m, and inner walls must not be"
        ):
            House.from_dict({**houses[0].to_dict(), "wall_thickness": wrong})


def test_a_plan_of_a_house_or_of_its_geojson_keeps_its_rooms(builder: Builder, houses: list[House]) -> None:
    house = houses[3]
    for plan in (house, to_geojson(house)):
        again = builder.house(HouseRequest(len(house.rooms), plan=read_plan(plan)), 1, 0)
        assert check(again) == []
        assert again.wall_thickness == house.wall_thickness
        offsets = np.subtract([room.box for room in house.rooms], [room.box for room in again.rooms])
        assert np.ptp(offsets[:, 0::2]) < 1e-5
        assert np.ptp(offsets[:, 1::2]) < 1e-5


def test_a_plan_s_door_that_reaches_into_the_wall_across_moves_out_of_it(
    builder: Builder, houses: list[House]
) -> None:
    house = houses[3]
    door = next(each for each in house.doors if OUTSIDE not in each.between)
    axis = 1 - across(door)
    end = min(house.room(name).box[axis + 2] for name in door.between)
    past = structs.replace(door, **{"xy"[axis]: end - door.length + 0.05})
    drawn = structs.replace(house, doors=tuple(past if each is door else each for each in house.doors))
    assert any("reaches 0.05 m into the wall across" in line for line in check(drawn))
    again = builder.house(HouseRequest(len(house.rooms), plan=read_plan(drawn)), 1, 0)
    assert check(again) == []
    (kept,) = (each for each in again.doors if {*each.between} == {*door.between})
    assert kept.length == pytest.approx(door.length)
    assert kept.box[axis + 2] == pytest.approx(end, abs=1e-5)


def test_geojson_in_another_unit_has_walls_in_that_unit(houses: list[House]) -> None:
    record = to_geojson(houses[3])
    plan = read_plan(record)
    for feature in record["features"]:
        geometry = feature["geometry"]
        geometry["coordinates"] = (1000 * np.array(geometry["coordinates"])).tolist()
    record["wall_thickness"] = {name: 1000 * length for name, length in record["wall_thickness"].items()}
    for one, other in zip(plan.rooms, read_plan(record, unit="mm").rooms, strict=True):
        assert one.box == pytest.approx(other.box, abs=1e-5)


TINY = """
topology(ring).  type(hall;bath).  empty(hall;bath).  central(hall).
opens(outside,hall).  opens(hall,bath).
"""
TINY_LENGTHS = """
room_size(_, W, D) :- { W >= 1.6, W =< 3.2, D >= 1.6, D =< 3.2 }.
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
wall_thickness(inner, 0.1).
"""


@pytest.mark.parametrize(("width", "by_walls"), [(1.75, None), (1.65, True), (1.55, False)])
def test_a_plan_whose_rooms_are_too_narrow_for_its_walls_alone_names_these(
    width: float, by_walls: bool | None, tmp_path: Path
) -> None:
    (tmp_path / "rooms.lp").write_text(TINY)
    (tmp_path / "lengths.pl").write_text(TINY_LENGTHS)
    plan = {
        "rooms": [
            {"name": type_, "type": type_, "x": x, "y": 0, "width": width, "height": 2.5}
            for type_, x in (("hall", 0), ("bath", width))
        ]
    }
    plan = House.from_dict({"format": "vitruvius-2", "unit": "m", "doors": [], **plan})
    if by_walls is None:
        [house] = generate(plan=plan, grammar=tmp_path)
        assert [room.width for room in house.rooms] == pytest.approx([width - 0.1] * 2, abs=EXACT)
        return
    with pytest.raises(Unsatisfiable) as proof:
        list(generate(plan=plan, grammar=tmp_path))
    assert "room_size(" in str(proof.value)
    assert ("wall_thickness(inner, 0.1)" in str(proof.value)) == by_walls


OTHERS = {
    "clinic": (SHIPPED / "clinic", 14),
    "apartments": (SHIPPED / "apartments", 15),
    "dissection": (MASONRY.parent / "dissection", 7),
}


@pytest.mark.second_part("every topology")
@pytest.mark.parametrize("name", OTHERS)
def test_other_topologies_and_units_have_such_walls(name: str, tmp_path: Path) -> None:
    source, rooms = OTHERS[name]
    shutil.copytree(source, tmp_path / "thick")
    (tmp_path / "thick" / "walls.pl").write_text("wall_thickness(inner, 0.1). wall_thickness(outer, 0.4).\n")
    if name == "dissection":
        (tmp_path / "thick" / "void.lp").write_text("#program house.\nvoid(rooms).\n")
    [house] = generate(rooms, grammar=tmp_path / "thick")
    assert check(house) == []
    least = min(
        shapely.box(*one.box).distance(shapely.box(*other.box)) for one, other in combinations(house.rooms, 2)
    )
    assert least == pytest.approx(0.1, abs=EXACT)


def test_a_brief_states_areas_within_the_walls() -> None:
    areas = {"Hall": 6.0, "Living": 20.0, "Kitchen": 9.0, "Bed": 12.0, "Bath": 5.0}
    types = dict(zip(areas, ("hall", "living", "kitchen", "bedroom", "bathroom"), strict=True))
    rooms = [{"name": name, "type": types[name], "area": area} for name, area in areas.items()]
    brief = {"rooms": rooms, "tolerance": 0.01, "doors": [["Hall", "Bath"]]}
    [house] = generate(brief=brief, grammar=MASONRY)
    assert check(house) == []
    for room in house.rooms:
        assert abs(room.width * room.height / areas[room.name] - 1) <= 0.01 + EXACT


def grammar(folder: Path, walls: str, base: str = "home") -> Path:
    shutil.copytree(SHIPPED / base, folder)
    (folder / "walls.pl").write_text(walls)
    return folder


@pytest.mark.second_part("every topology")
def test_no_thickness_is_the_same_as_none_bit_for_bit(tmp_path: Path) -> None:
    [one] = generate(6, grammar="home", seed=4)
    none = grammar(tmp_path / "none", "wall_thickness(inner, 0.0).\n")
    [other] = generate(6, grammar=none, seed=4)
    assert structs.replace(one, provenance=None) == structs.replace(other, provenance=None)
    assert "wall_thickness" not in one.to_dict()


THICK = "wall_thickness(inner, 0.3). wall_thickness(outer, 0.1)."
TWICE = "wall_thickness(inner, 0.1). wall_thickness(inner, 0.2)."
WRONG = {
    "wall_thickness(iner, 0.1).": ":1:1: wall_thickness(iner, 0.1): write inner or outer, not iner",
    "wall_thickness(inner, -0.1).": ":1:1: wall_thickness(inner, -0.1) must be a number of metres, 0 or more",
    "wall_thickness(outer, 0.3).": ":1:1: wall_thickness(outer, 0.3): inner walls have no thickness: also",
    "wall_thickness(inner, 3).": ":1:1: wall_thickness(inner, 3): a wall may not be thicker than a room",
    THICK: ":1:29: wall_thickness(outer, 0.1): outer walls must be at least as thick",
    TWICE: ":1:29: wall_thickness(inner, 0.2) is a second clause",
}


@pytest.mark.parametrize("walls", WRONG)
def test_what_is_no_thickness_is_named_by_line_and_column(walls: str, tmp_path: Path) -> None:
    with pytest.raises(GrammarError) as error:
        list(generate(4, grammar=grammar(tmp_path / "wrong", walls)))
    assert f"walls.pl{WRONG[walls]}" in str(error.value).replace("error: ", "")


def test_a_star_refuses_it(tmp_path: Path) -> None:
    with pytest.raises(GrammarError, match="nothing uses wall_thickness/2 in a star: state a topology/1"):
        list(generate(4, grammar=grammar(tmp_path / "star", "wall_thickness(inner, 0.1).", "family")))


def test_promises_of_a_thickness_are_kept_or_said(houses: list[House]) -> None:
    wanted = Promises(wall_thickness=Thickness(INNER, 0.5))
    assert check(houses[0], wanted) == ["house: its outer walls are 0.36 m thick (must be 0.5)"]
