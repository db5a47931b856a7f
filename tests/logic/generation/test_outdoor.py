"""Outdoor rooms, by `outdoor`: they light other rooms, have no window, and do not count in the area."""

import shutil
from functools import reduce
from pathlib import Path

import gymnasium as gym
import pytest
import shapely
from msgspec import structs

from tests.logic.request.test_given_plan import Box, geojson
from tests.logic.workers.in_process import generate
from vitruvius.logic import RequestError, Unsatisfiable, check
from vitruvius.logic.drawing.draw import plan_svg
from vitruvius.logic.drawing.wall_union import wall_rings
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Room, Window
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.shared_walls import PlanWitness

BALCONY = """
type(balcony).  empty(balcony).  outdoor(balcony).  gateless(balcony).
opens((living; bedroom), balcony).
#program house.
:- { room(_,balcony) } != 1.
"""
BALCONY_SIZES = """
room_size(balcony, W, D) :- { W >= 1.4, W =< 4.5, D >= 1.4, D =< 4.5 }.
room_area(balcony, 3.0, 9.0).
"""
PATIO = """
topology(dissection).  type(hall; den; patio).  empty(hall; den; patio).  lit(den).  outdoor(patio).
opens(outside,hall).  opens(hall,(den; patio)).
#program house.
:- { room(R,T) } != 1, T = (hall; den; patio).
"""
PATIO_SIZES = """
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).  window_margin(0.2).
room_size(_, W, D) :- { W >= 2.0, W =< 6.0, D >= 2.0, D =< 6.0 }.
window_size(_, L, Wall) :- { L >= 0.6, L =< 0.8*Wall }.
"""


def grammar(folder: Path, rules: str = PATIO, sizes: str = PATIO_SIZES) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "rooms.lp").write_text(rules)
    (folder / "sizes.pl").write_text(sizes)
    return folder


def of_type(house: House, type_: str) -> Room:
    return next(room for room in house.rooms if room.type == type_)


def on_edge(window: Window, room: Room) -> bool:
    """Return True if the whole of a window lies on the boundary of a room."""
    west, north, east, south = room.box
    a, b, c, d = window.box
    inside = a >= west - 1e-6 and c <= east + 1e-6 and b >= north - 1e-6 and d <= south + 1e-6
    return inside and any(
        abs(x - y) + abs(z - y) < 1e-6
        for x, z, y in ((a, c, west), (a, c, east), (b, d, north), (b, d, south))
    )


@pytest.mark.second_part("many houses")
def test_rooms_have_windows_and_doors_towards_a_balcony_and_no_dark_one_is_left(tmp_path: Path) -> None:
    folder = shutil.copytree(SHIPPED / "home", tmp_path / "mine")
    (folder / "more.lp").write_text(BALCONY)
    (folder / "more.pl").write_text(BALCONY_SIZES)
    builder, towards, by_door = Builder(find(folder)), 0, 0
    for seed in range(14):
        house = builder.house(HouseRequest(8), seed, 0)
        assert check(house) == []
        balcony = of_type(house, "balcony")
        windowed = {window.room for window in house.windows}
        assert balcony.name not in windowed
        assert house.garden_doors == ()
        joined = {name for door in house.doors if balcony.name in door.between for name in door.between}
        for room in house.rooms:
            if room.type in {"living", "dining", "kitchen", "bedroom", "study"}:
                assert room.name in windowed | joined
                by_door += room.name not in windowed
        towards += sum(on_edge(window, balcony) for window in house.windows)
        if seed > 2 and towards and by_door:
            break
    assert towards
    assert by_door


def test_a_window_towards_a_patio_lies_in_the_wall_that_both_share_and_there_is_no_door_in_it(
    tmp_path: Path,
) -> None:
    rules = PATIO + ":- room(R,den), not toward(R,_,_).\n"
    builder = Builder(find(grammar(tmp_path / "mine", rules)))
    for seed in range(5):
        house = builder.house(HouseRequest(3), seed, 0)
        assert check(house) == []
        patio, den = of_type(house, "patio"), of_type(house, "den")
        assert any(on_edge(window, patio) and on_edge(window, den) for window in house.windows)
        assert all({*door.between} != {patio.name, den.name} for door in house.doors)


def test_a_gate_leads_from_a_patio_to_the_garden(tmp_path: Path) -> None:
    builder = Builder(find(grammar(tmp_path / "mine")))
    houses = [builder.house(HouseRequest(3), seed, 0) for seed in (1, 0)]
    for house in houses:
        assert check(house) == []
        [gate], patio = house.garden_doors, of_type(house, "patio")
        assert {*gate.between} == {patio.name, OUTSIDE}
    why = str(PlanWitness(builder, houses[-1]).why("entrance2"))
    assert "a door to the garden" in why
    assert "outdoor(patio)" in why


def test_a_given_plan_has_the_gate_that_it_draws_and_one_where_it_draws_no_door_to_outside(
    tmp_path: Path,
) -> None:
    boxes: dict[str, Box] = {"hall": (0, 0, 3, 3), "den": (3, 0, 6, 3), "patio": (0, 3, 6, 6)}
    folder = grammar(tmp_path / "mine")
    house = next(generate(plan=geojson(boxes, hall="hall", den="den", patio="patio"), grammar=folder))
    [gate] = house.garden_doors
    assert {*gate.between} == {"patio", OUTSIDE}
    for drawn in (house, structs.replace(house, doors=tuple(door for door in house.doors if door != gate))):
        again = next(generate(plan=drawn, grammar=folder, seed=1))
        assert check(again) == []
        assert again.garden_doors == drawn.garden_doors


def test_the_area_of_a_house_is_that_of_its_rooms_inside(tmp_path: Path) -> None:
    """A hall and a den have 24 to 25 m², and a patio 9 m² or more: 33 m² or more together."""
    sizes = PATIO_SIZES + "room_area(patio, 9.0, 12.0).\nhouse_area(24.0, 25.0).\n"
    builder = Builder(find(grammar(tmp_path / "mine", sizes=sizes)))
    for seed in range(4):
        house = builder.house(HouseRequest(3), seed, 0)
        assert check(house) == []
        assert 24 <= of_type(house, "hall").area + of_type(house, "den").area <= 25
    small = PATIO_SIZES + "room_area(den, 4.0, 5.0).\nroom_area(hall, 4.0, 5.0).\nhouse_area(12.0, 20.0).\n"
    with pytest.raises(Unsatisfiable, match="house_area"):
        house_or_proof(Builder(find(grammar(tmp_path / "small", sizes=small))), HouseRequest(3), 0, 0)


def test_check_finds_a_window_of_a_patio_and_one_towards_no_patio(tmp_path: Path) -> None:
    house = Builder(find(grammar(tmp_path / "mine", PATIO + ":- room(R,den), not toward(R,_,_).\n"))).house(
        HouseRequest(3), 0, 0
    )
    patio, den = of_type(house, "patio"), of_type(house, "den")
    of_patio = tuple(
        structs.replace(window, room=patio.name) for window in house.windows if on_edge(window, patio)
    )
    assert any(
        "has a window, and is outside" in fault for fault in check(structs.replace(house, windows=of_patio))
    )
    rooms = tuple(structs.replace(room, type="hall") if room is patio else room for room in house.rooms)
    faults = check(structs.replace(house, rooms=rooms))
    assert any(f"{den.name}" in fault and "not outside" in fault for fault in faults)


def test_a_patio_amid_rooms_is_refuted_and_found_by_the_check(tmp_path: Path) -> None:
    """Four rooms surround the patio like the sails of a windmill."""
    boxes: dict[str, Box] = {
        "north": (0, 4, 4, 6), "east": (4, 2, 6, 6), "south": (2, 0, 6, 2), "west": (0, 0, 2, 4),
        "amid": (2, 2, 4, 4),
    }  # fmt: skip
    plan = geojson(boxes, north="hall", east="den", south="den", west="den", amid="patio")
    rules = PATIO.split("#program", maxsplit=1)[0] + "opens(den,den).\n"
    with pytest.raises(Unsatisfiable, match="outdoor\\(patio\\)"):
        next(generate(plan=plan, grammar=grammar(tmp_path / "mine", rules)))
    inside = rules.replace("outdoor(patio).", "")
    house = next(generate(plan=plan, grammar=grammar(tmp_path / "inside", inside)))
    assert check(house) == []
    assert house.provenance
    assert house.provenance.promises
    promises = structs.replace(house.provenance.promises, outdoor=("patio",))
    assert any("has no outer wall, and is outside" in fault for fault in check(house, promises))


@pytest.mark.second_part("many plans")
def test_in_a_plan_a_room_behind_a_patio_is_lit_from_there_or_by_its_door(tmp_path: Path) -> None:
    boxes: dict[str, Box] = {"hall": (0, 0, 3, 3), "den": (3, 0, 6, 3), "patio": (0, 3, 6, 6)}
    folder = grammar(tmp_path / "mine", PATIO + ":- room(R,den), outer(R,S), window(R,S).\n")
    plan = geojson(boxes, hall="hall", den="den", patio="patio")
    house = next(generate(plan=plan, grammar=folder))
    assert check(house) == []
    (window,) = (each for each in house.windows if each.room == "den")
    assert on_edge(window, of_type(house, "patio"))
    # A plan of this house keeps the window in its place. Towards an indoor room the window is refuted.
    again = next(generate(plan=house, grammar=folder, seed=1))
    assert check(again) == []
    assert again.windows == house.windows
    inside = PATIO.replace("outdoor(patio).", "")
    with pytest.raises(Unsatisfiable, match="there are no other windows"):
        next(generate(plan=house, grammar=grammar(tmp_path / "inside", inside)))
    # A window of at least 1.8 m in at most 0.8 of its wall needs a wall of 2.25 m.
    long = PATIO_SIZES.replace("L >= 0.6", "L >= 1.8")
    folder = grammar(tmp_path / "mine", PATIO + ":- room(R,den), outer(R,S), window(R,S).\n", long)
    for wall, possible in ((2.3, True), (2.2, False)):
        boxes = {"hall": (0, 0, 3, 3), "den": (3, 0, 3 + wall, 3), "patio": (1, 3, 3 + wall, 5)}
        plan = geojson(boxes, hall="hall", den="den", patio="patio")
        if possible:
            assert check(next(generate(plan=plan, grammar=folder))) == []
        else:
            with pytest.raises(Unsatisfiable, match="window_size"):
                next(generate(plan=plan, grammar=folder))
    boxes = {"hall": (0, 0, 3, 3), "den": (3, 0, 6, 3), "patio": (0, 3, 6, 6)}
    plan = geojson(boxes, hall="hall", den="den", patio="patio")
    folder = grammar(
        tmp_path / "mine",
        PATIO.replace("opens(hall,", "opens(den,patio).  opens(hall,") + ":- window(_,_).\n",
    )
    house = next(generate(plan=plan, grammar=folder))
    assert check(house) == []
    assert {"den", "patio"} in [{*door.between} for door in house.doors]
    folder = grammar(tmp_path / "mine", sizes=PATIO_SIZES + "house_area(10.0, 30.0).\n")
    with pytest.raises(RequestError, match="house_area/2, and outdoor/1"):
        next(generate(plan=plan, grammar=folder))


def test_a_body_finds_targets_on_a_patio_and_its_boards_are_drawn(tmp_path: Path) -> None:
    house = Builder(find(grammar(tmp_path / "mine"))).house(HouseRequest(3), 0, 0)
    env = gym.make("Vitruvius/House-v0", houses=[house], targets={"rooms": ["patio"]})
    west, north, east, south = of_type(house, "patio").box
    for seed in range(3):
        _, info = env.reset(seed=seed)
        x, y = info["target"][:2]
        assert west <= x <= east
        assert north <= y <= south
    boarded, plain = plan_svg(house), plan_svg(structs.replace(house, provenance=None))
    assert len(boarded) > len(plain) + 200
    inside = sum(room.area for room in house.rooms if room.type != "patio")
    assert f"{inside:.0f} m²" in boarded
    assert f"{inside:.0f} m²" not in plain


def test_why_a_window_is_towards_a_patio_is_derived(tmp_path: Path) -> None:
    builder = Builder(find(grammar(tmp_path / "mine", PATIO + ":- room(R,den), not toward(R,_,_).\n")))
    house = builder.house(HouseRequest(3), 0, 0)
    den = of_type(house, "den")
    why = str(PlanWitness(builder, house).why(f"{den.name}.window"))
    assert "toward(" in why
    assert "outdoor(patio)" in why


COUNTED = """
topology(ring).  type(hall; den; balcony).  empty(hall; den; balcony).  central(hall).  outdoor(balcony).
opens(outside,hall).  opens(hall,(den; balcony)).
"""
COUNTED_SIZES = """
room_size(_, W, D) :- { W >= 2.0, W =< 2.1, D >= 2.0, D =< 2.1 }.
house_area(12.0, 14.0).
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
"""
"""Sizes with which a room has 4 to 4.41 m², so that three rooms must be indoors."""


def test_that_a_house_with_a_balcony_is_too_small_says_nothing_of_one_without(tmp_path: Path) -> None:
    builder = Builder(find(grammar(tmp_path, COUNTED, COUNTED_SIZES)))
    for seed in range(8):
        house = house_or_proof(builder, HouseRequest(3), seed, 0)
        assert check(house) == []
        assert "balcony" not in {room.type for room in house.rooms}


def test_around_a_patio_a_parapet_is_drawn_in_the_place_of_the_outer_wall(tmp_path: Path) -> None:
    thick = "wall_thickness(inner, 0.15).  wall_thickness(outer, 0.5).\n"
    for name, sizes in (("lines", PATIO_SIZES), ("masonry", PATIO_SIZES + thick)):
        house = Builder(find(grammar(tmp_path / name, sizes=sizes))).house(HouseRequest(3), 0, 0)
        [patio] = [room for room in house.rooms if room.type == "patio"]
        others = [shapely.box(*room.box) for room in house.rooms if room is not patio]
        indoors = shapely.union_all(others).buffer(0.5, join_style="mitre")
        outside = shapely.difference(shapely.box(*patio.box).buffer(0.4), indoors)
        walls = reduce(shapely.symmetric_difference, map(shapely.Polygon, wall_rings(house, 0.4)))
        low = shapely.intersection(walls, outside)
        assert low.area > 0
        assert low.within(shapely.box(*patio.box).buffer(0.08, join_style="mitre"))
