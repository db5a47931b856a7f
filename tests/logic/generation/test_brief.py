"""Houses by a brief satisfy each of its lines, by geometry; an impossible brief is refuted by its lines."""

import gc
from collections import Counter
from itertools import combinations, pairwise
from typing import Any
from weakref import ref

import pytest
from scipy.cluster.hierarchy import DisjointSet

import vitruvius
from benchmarks.briefs.bank import frozen
from benchmarks.generator.verdicts import brief_systems, until_refuted, verdicts
from tests.logic.workers import in_process
from tests.logic.workers.in_process import generate
from vitruvius.logic import House, RequestError, Unsatisfiable
from vitruvius.logic.checking.check import violations
from vitruvius.logic.house.parts import OUTSIDE, Room
from vitruvius.logic.request.brief import Brief, read_brief
from vitruvius.logic.request.house_request import HouseRequest

FLAT: dict[str, Any] = {
    "rooms": [
        {"name": "Hall", "type": "hall", "area": 6, "tolerance": 0.2},
        {"name": "Living", "type": "living", "area": 22, "outside": ["south"]},
        {"name": "Kitchen", "type": "kitchen", "size": [[2.4, 4.0], [2.8, 4.2]], "outside": True},
        {"name": "Bed", "type": "bedroom", "area": [11, 13]},
        {"name": "Bath", "type": "bathroom", "area": 5},
    ],
    "doors": [["Hall", "Living"], ["Hall", "Bed"], ["Hall", "Bath"]],
    "no_doors": [["Living", "Bed"]],
    "next_to": [["Kitchen", "Bath"]],
    "apart": [["Bed", "Kitchen"]],
    "entrance": "Hall",
    "outline": {"width": [7.5, 9.5], "voids": [{"corner": "north-east", "width": 2, "depth": 1.5}]},
    "area": [52, 62],
}
SIDES = {"north": 1, "east": 2, "south": 3, "west": 0}


def shared(one: Room, other: Room) -> float:
    """Return the length of the wall that two rooms share, metres."""
    across = [min(one.box[k + 2], other.box[k + 2]) - max(one.box[k], other.box[k]) for k in (0, 1)]
    return max(across) if abs(min(across)) < 1e-6 else 0.0


def outline(house: House) -> tuple[float, float, float, float]:
    """Return the box around a house."""
    west, north, east, south = zip(*(room.box for room in house.rooms), strict=True)
    return min(west), min(north), max(east), max(south)


def broken(house: House, brief: Brief) -> list[str]:
    """Return the lines of a brief that a house breaks, by its boxes, doors and windows alone."""
    rooms = {room.name: room for room in house.rooms}
    doors = {frozenset(door.between) for door in house.doors}
    whole = outline(house)
    bad = []
    for wanted in brief.rooms:
        room = rooms[wanted.name]
        tolerance = brief.tolerance if wanted.tolerance is None else wanted.tolerance
        if wanted.area is not None and not within(room.area, wanted.area, tolerance):
            bad.append(f"{wanted.name}: area {room.area}")
        if wanted.size is not None and not any(
            all(within(side, span, tolerance) for side, span in zip(sides, wanted.size, strict=True))
            for sides in ((room.width, room.height), (room.height, room.width))
        ):
            bad.append(f"{wanted.name}: size")
        if wanted.type and room.type not in (wanted.type, wanted.label):
            bad.append(f"{wanted.name}: type")
        for side in wanted.outside if isinstance(wanted.outside, tuple) else ():
            if abs(room.box[SIDES[side]] - whole[SIDES[side]]) > 1e-6:
                bad.append(f"{wanted.name}: not at the {side}")  # but at a void, which these briefs leave out
    bad += [f"no door {pair}" for pair in brief.doors if frozenset(pair) not in doors]
    bad += [f"a door {pair}" for pair in brief.no_doors if frozenset(pair) in doors]
    bad += [f"apart {a} {b}" for a, b in brief.next_to if shared(rooms[a], rooms[b]) < 0.1 - 1e-6]
    bad += [f"next {a} {b}" for a, b in brief.apart if shared(rooms[a], rooms[b]) > 1e-6]
    if isinstance(brief.entrance, str) and frozenset((brief.entrance, OUTSIDE)) not in doors:
        bad.append("entrance")
    for span, length in (
        (brief.outline.width, whole[2] - whole[0]),
        (brief.outline.depth, whole[3] - whole[1]),
    ):
        if span is not None and not within(length, span, 0, 2e-6):
            bad.append("outline")
    if brief.area is not None and not within(
        sum(room.area for room in house.rooms), brief.area, brief.tolerance
    ):
        bad.append("area")
    return bad


def within(value: float, span: float | tuple[float, float], tolerance: float, slack: float = 2e-3) -> bool:
    """Return True if a length or an area satisfies a span, within ``slack``, the precision of briefs."""
    least, most = span if isinstance(span, tuple) else (span * (1 - tolerance), span * (1 + tolerance))
    return least - slack <= value <= most + slack


def test_the_void_of_a_brief_is_free() -> None:
    for house in generate(brief=FLAT, count=3):
        _, north, east, _ = outline(house)
        notch = Room(east - 2, north, 2, 1.5, "notch", "", ())
        assert all(
            min(room.box[2], notch.box[2]) - max(room.box[0], notch.box[0]) < 1e-6
            or min(room.box[3], notch.box[3]) - max(room.box[1], notch.box[1]) < 1e-6
            for room in house.rooms
        )


def notch(house: House) -> Room:
    """Return the notch of NOTCHED, in its north-east corner."""
    _, north, east, _ = outline(house)
    return Room(east - 3, north, 3, 3, "notch", "", ())


NOTCHED = {"voids": [{"corner": "north-east", "width": 3, "depth": 3}]}


def test_a_notch_takes_no_whole_side_of_the_outline() -> None:
    for house in generate(brief=brief(3, outline=NOTCHED), count=6):
        assert sum(room.area for room in house.rooms) == pytest.approx(area_of(outline(house)) - 9)


def area_of(box: tuple[float, float, float, float]) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def test_an_outer_wall_at_a_void_is_a_wall_that_the_room_shares_with_it() -> None:
    wanted = brief(5, outline={"width": 8, "depth": 8} | NOTCHED)
    for room in wanted["rooms"][:4]:
        room["outside"] = ["east"]
    at_notch = 0
    for house in generate(brief=wanted, count=6):
        for room in house.rooms[:4]:
            if abs(room.box[2] - outline(house)[2]) > 1e-6:
                at_notch += 1
                assert shared(room, notch(house)) > 0.1 - 1e-6
    assert at_notch


@pytest.mark.second_part("hundreds of houses")
def test_no_dissection_is_preferred_where_a_brief_leaves_all() -> None:
    """Three named rooms have 36 dissections; chi-square of 35 degrees, at one in a thousand."""
    found: Counter[str] = Counter()
    for house in generate(brief=brief(3), count=144, seed=5):
        found[str([side_of(one, other) for one, other in combinations(house.rooms, 2)])] += 1
    assert len(found) == 36
    assert sum((times - 4) ** 2 / 4 for times in found.values()) < 66.6


def side_of(one: Room, other: Room) -> str:
    """Return the side of one room on which another lies."""
    for side, (near, far) in {"west": (one, other), "east": (other, one)}.items():
        if near.x + near.width < far.x + 1e-6:
            return side
    return "north" if one.y < other.y else "south"


def brief(rooms: int, **more: Any) -> dict[str, Any]:
    """Return a brief of rooms with only names."""
    return {"rooms": [{"name": f"R{number}"} for number in range(rooms)], **more}


def reasons(wanted: dict[str, Any]) -> set[str]:
    """Return the lines of a brief in the proof that no house satisfies it."""
    with pytest.raises(Unsatisfiable) as caught:
        next(generate(brief=wanted))
    return {each.text for each in caught.value.reasons if each.text.startswith("brief: ")}


def test_doors_of_all_with_all_of_four_rooms_in_a_plan_are_impossible_by_these_doors() -> None:
    doors = [[f"R{one}", f"R{other}"] for one in range(4) for other in range(one)]
    assert reasons(brief(5, doors=doors)) == {
        f"brief: a door joins {one} and {other}" for one, other in doors
    }


def test_rooms_that_have_a_door_and_are_apart_are_impossible_by_these_two_lines() -> None:
    found = reasons(brief(4, doors=[["R0", "R1"], ["R1", "R2"]], apart=[["R2", "R1"]]))
    assert found == {"brief: a door joins R1 and R2", "brief: R2 is not next to R1"}


def test_areas_that_are_too_large_for_the_outline_are_named_with_it() -> None:
    wanted = brief(4, outline={"width": 8, "depth": 6})
    for room, area in zip(wanted["rooms"], (30, 30, 5, 5), strict=True):
        room["area"] = area
    assert reasons(wanted) == {
        "brief: R0 has 27 to 33 m²",
        "brief: R1 has 27 to 33 m²",
        "brief: the outline is 8 m wide",
        "brief: the outline is 6 m deep",
    }


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        (brief(0), "rooms: give 1 to 24 rooms, not 0"),
        (brief(200), "rooms: give 1 to 24 rooms, not 200"),
        ({"rooms": [{"name": "A"}, {"name": "A"}]}, r"rooms\[1\]: rooms\[0\] is named A too"),
        (brief(2, doors=[["R0", "R0"]]), r"doors\[0\]: R0 is named twice"),
        (brief(2, doors=[["R0", "R3"]]), r"doors\[0\]: there is no room R3: there are R0, R1"),
        (brief(2, nextto=[["R0", "R1"]]), "there is no key nextto: did you mean next_to"),
        (brief(2, entrance="Hal"), "entrance: "),
        (
            brief(2, entrance={"room": "R0", "side": "N"}),
            r"entrance\.side: there is no value N: there are east",
        ),
        (brief(2, entrance=["R0", "R1"]), "entrance: must be a text or an object of room, side"),
        (brief(3, doors=[["R0", "R1", "R2"]]), r"doors\[0\]: must be a list of 2, each a text, not"),
        ({"rooms": [{"name": "A", "outside": "south"}]}, r'outside: must be a list: write \["south"\]'),
        ({"rooms": [{"name": "A", "outside": ["South"]}]}, r"outside\[0\]: .* did you mean south"),
        (
            {"rooms": [{"name": "A", "area": "10 m2"}]},
            r"area: must be a number or \[least, most\], not \"10 m2",
        ),
        ({"rooms": [{"area": 9}]}, r"rooms\[0\]: name is missing"),
        (
            brief(1, outline={"width": 850}),
            r"outline\.width: must be at most 400 m, not 850: lengths are metres",
        ),
        (
            brief(1, outline={"voids": [{"x": [3, 2]}]}),
            r"voids\[0\]: x: the smaller number comes first: \[2, 3\]",
        ),
        (brief(1, outline={"voids": [{"x": -1}]}), r"voids\[0\]: x: must be at least 0"),
        ({"rooms": [{"name": "A", "area": 0.1}]}, r"rooms\[0\] \(A\): area: 0.1 m² is less than the least"),
        (
            {"rooms": [{"name": "A", "area": [9, 4]}]},
            r"rooms\[0\] \(A\): area: the smaller number comes first",
        ),
        ({"rooms": [{"name": "A", "size": [3, -1]}]}, r"rooms\[0\] \(A\): size: must be above 0"),
        ({"rooms": [{"name": "A", "colour": "red"}]}, "there is no key colour: there are name"),
        (brief(1, area=20, outline={"voids": [{"width": 2}]}), "area: a house with voids"),
        (brief(1, outline={"voids": [{"width": 0.9}]}), r"voids\[0\]: width: a void must be"),
        (brief(2, tolerance=0.6), "tolerance: must be a number, at most 0.5, not 0.6"),
        (
            {"rooms": [{"name": "A", "area": 5001}]},
            r"rooms\[0\] \(A\): area: must be at most 5000 m², not 5001",
        ),
        ({"rooms": [{"name": "A" * 65}]}, "name: must be a text, at most 64 long"),
        ({"rooms": [{"name": "two\nlines"}]}, "name: must be one line, without a space"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line_that_says_where(
    wanted: dict[str, Any], message: str
) -> None:
    with pytest.raises(RequestError, match=message) as caught:
        next(generate(brief=wanted))
    assert "\n" not in str(caught.value)


def test_the_program_of_a_house_by_a_brief_is_freed_with_the_next_one() -> None:
    builder = in_process.builder("plain")
    request = HouseRequest(2, brief=read_brief(brief(2)))
    programs = list[Any]()
    for index in range(3):
        builder.house(request, 0, index)
        programs.append(ref(builder.origin.program))
    gc.collect()
    assert [program() is None for program in programs] == [True, True, False]


def test_a_brief_on_a_grid_is_refused() -> None:
    with pytest.raises(RequestError, match="cell: a brief does not support a grid: leave out cell"):
        next(vitruvius.generate(brief=brief(2), cell=0.5))


def test_rooms_may_be_named_in_any_script() -> None:
    names = ["Küche", "居間", "غرفة نوم"]
    house = next(generate(brief={"rooms": [{"name": name} for name in names], "doors": [names[:2]]}))
    assert [room.name for room in house.rooms] == names
    assert [room.type for room in house.rooms] == names


def test_a_least_area_that_is_nearly_nothing_is_that_of_the_least_sides() -> None:
    house = next(generate(brief={"rooms": [{"name": "A", "area": [1e-9, 5]}, {"name": "B"}]}))
    room = house.rooms[0]
    assert room.area <= 5
    assert min(room.width, room.height) >= 0.5


def test_a_court_has_no_entrance() -> None:
    court = {"x": 3, "y": 3, "width": 2, "depth": 2}
    around = brief(4, outline={"width": 8, "depth": 8, "voids": [court]})
    for house in generate(brief={**around, "entrance": "R1"}, count=3):
        entrance = next(door for door in house.doors if OUTSIDE in door.between)
        whole = outline(house)
        assert any(abs(entrance.box[k] - whole[j]) < 1e-6 for k in range(4) for j in (k % 2, k % 2 + 2))


def test_no_layout_of_a_brief_is_refuted_falsely() -> None:
    """Stage 2, CLP(Q) and HiGHS agree on the systems of constraints in the search for layouts."""
    systems = until_refuted(brief_systems(in_process.builder("plain"), (5,)), 8)
    found = verdicts(systems)
    assert set(found) == {(False, False, False), (True, True, True)}


@pytest.mark.second_part("a brief of twelve rooms")
def test_a_brief_alone_gets_the_doors_that_it_asks_for_and_one_into_each_group_of_rooms() -> None:
    """In a frozen brief doors join all rooms; here some doors are left out, so that there are groups."""
    (entry,) = (each for each in frozen() if each.name == "home-12-05")
    fewer = {**entry.brief, "doors": entry.brief["doors"][2:-3]}
    for brief in (entry.brief, fewer):
        asked = [*map(frozenset, brief["doors"])]
        groups = DisjointSet(room["name"] for room in brief["rooms"])
        for one, other in asked:
            groups.merge(one, other)
        for house in generate(brief=brief):
            doors = [frozenset(door.between) for door in house.doors if not door.is_entrance]
            others = [door for door in doors if door not in asked]
            assert {*asked} <= {*doors}
            assert len(others) == groups.n_subsets - 1
            assert not any(groups.connected(*door) for door in others)


def test_a_void_lies_in_the_range_of_its_place_and_a_comment_has_no_effect() -> None:
    court = {"x": [2, 3], "y": [3, 4], "width": 2, "depth": 2, "comment": "a light well"}
    outline_ = {"width": 8, "depth": 8, "voids": [court]}
    places = [
        (court_.x - outline(house)[0], court_.y - outline(house)[1])
        for house in generate(brief=brief(4, outline=outline_, comment="a note"), count=3)
        for court_ in free_boxes(house)
    ]
    assert len({*places}) == 3
    assert all(2 - 2e-3 <= x <= 3 + 2e-3 and 3 - 2e-3 <= y <= 4 + 2e-3 for x, y in places)


def free_boxes(house: House) -> list[Room]:
    """Return the boxes of a house's outline that no room covers, found between the lines of its rooms."""
    xs = sorted({round(at, 6) for room in house.rooms for at in room.box[::2]})
    ys = sorted({round(at, 6) for room in house.rooms for at in room.box[1::2]})
    free = [
        (x, y)
        for x, x2 in pairwise(xs)
        for y, y2 in pairwise(ys)
        if not any(
            room.box[0] < (x + x2) / 2 < room.box[2] and room.box[1] < (y + y2) / 2 < room.box[3]
            for room in house.rooms
        )
    ]
    west, north = (min(each) for each in zip(*free, strict=True))
    return [Room(west, north, 2, 2, "court", "", ())]


# With the grammar home: last, since each change of the grammar loads another one.


@pytest.mark.parametrize("grammar", [None, "home"])
def test_houses_keep_each_line_of_a_brief_and_the_promises_of_the_grammar(grammar: str | None) -> None:
    brief = read_brief(FLAT)
    houses = list(generate(brief=FLAT, grammar=grammar, count=4))
    assert [broken(house, brief) for house in houses] == [[], [], [], []]
    for house in houses:
        assert house.provenance is not None
        assert house.provenance.promises is not None
        assert violations(house, house.provenance.promises) == []
    assert len({outline(house) for house in houses}) == 4
    assert all(room.pieces for house in houses for room in house.rooms if room.name == "Bed") == bool(grammar)


def test_a_house_by_a_brief_is_made_again_whatever_was_made_before() -> None:
    _, house = generate(brief=FLAT, grammar="home", seed=3, count=2)
    again = next(vitruvius.generate(brief=FLAT, grammar="home", seed=3, start=1))
    assert (again.rooms, again.doors, again.windows) == (house.rooms, house.doors, house.windows)


def test_an_unknown_type_is_refused_with_what_is_meant() -> None:
    with pytest.raises(RequestError, match=r"rooms\[0\] \(A\): .*kitchn.*kitchen"):
        next(generate(brief={"rooms": [{"name": "A", "type": "kitchn"}]}, grammar="home"))


def others_than(asked: set[frozenset[str]], wanted: dict[str, Any], count: int) -> list[frozenset[str]]:
    """Return the doors of houses of home by a brief that the brief does not ask for, without entrances."""
    houses = generate(brief=wanted, grammar="home", seed=1, count=count)
    doors = [frozenset(door.between) for house in houses for door in house.doors if not door.is_entrance]
    return [door for door in doors if door not in asked]


def test_a_brief_has_other_doors_than_it_asks_for_only_where_it_says_so() -> None:
    asked = {*map(frozenset, FLAT["doors"]), frozenset(("Living", "Kitchen"))}
    wanted = FLAT | {"doors": [*map(list, asked)]}
    assert others_than(asked, wanted, 2) == []
    assert others_than(asked, wanted | {"other_doors": True}, 2)


def test_a_door_that_the_rules_require_is_there_though_the_brief_does_not_ask_for_it() -> None:
    rooms = [{"name": name, "type": name} for name in ("hall", "living", "kitchen", "dining", "bathroom")]
    rooms += [{"name": name, "type": "bedroom"} for name in ("bed", "guests")]
    doors = [["hall", name] for name in ("living", "bathroom", "bed", "guests")]
    doors += [["living", name] for name in ("dining", "kitchen")]
    assert frozenset(("dining", "kitchen")) in others_than(set(), {"rooms": rooms, "doors": doors}, 1)
