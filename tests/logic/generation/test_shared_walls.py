"""Plans whose rooms share walls: promises of their grammars, proofs, and additional topologies."""

import shutil
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from clingo import Symbol

from benchmarks.generator.verdicts import furniture_systems, given_systems, verdicts, wall_systems
from tests import architect
from tests.logic.workers.in_process import builder
from vitruvius.logic import GrammarError, RequestError, Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.loop import Stages, Work
from vitruvius.logic.generation.loop import made as made_by
from vitruvius.logic.generation.shared_walls import Assumed, PlanDraft, PlanRules
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.boxes import overlap
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Rect
from vitruvius.logic.house.star import Star, StarRoom
from vitruvius.logic.layout.program import Nogood
from vitruvius.logic.placement.plan import Plan
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.fixed_rooms import fixed_rooms
from vitruvius.logic.request.house_request import HouseRequest

ROW = """%# Topology `row`: the rooms stand in a row, from west to east.
#program house.
% - derive ------------------------------------------------------------------
edge(R,north,outline(north)) :- R = 0..rooms-1.
edge(R,south,outline(south)) :- R = 0..rooms-1.
edge(0,west,outline(west)).
edge(R,east,joint(R))   :- R = 0..rooms-2.
edge(R+1,west,joint(R)) :- R = 0..rooms-2.
edge(rooms-1,east,outline(east)).
face(R,R+1) :- R = 0..rooms-2.
face(R+1,R) :- R = 0..rooms-2.
"""


def unfurnished(
    builder: Builder, rooms: int, seed: int | list[int], nogoods: list[Nogood] | None = None
) -> tuple[Plan, list[Symbol]]:
    """Return a plan without furniture, and its layout; the nogoods receive the layouts that fail."""
    rules = PlanRules(builder.grammar, builder.loaded, builder.maker.feasibility, builder.programs)
    request, work = HouseRequest(rooms), Work(np.random.default_rng(seed), 10**8)
    draft = PlanDraft(rules, request, work, Assumed(*builder.programs.rooms_for(request)))
    draft.nogoods = [] if nogoods is None else nogoods
    return made_by(Stages(draft.sample, draft.place, lambda layout, plan: (plan, layout), draft.learn))


def layouts(made: Builder, rooms: int, seeds: range) -> Iterator[list[Symbol]]:
    program, assumed = made.programs.rooms_for(HouseRequest(rooms))
    for seed in seeds:
        layout = program.sample(np.random.default_rng([seed, rooms]), assumed)
        assert layout is not None
        yield layout


def copied(folder: Path, *changes: tuple[str, str, str], **files: str) -> Path:
    """Return a copy of home, with one text replaced by another in some files, and with additional files."""
    folder = shutil.copytree(SHIPPED / "home", folder / "mine")
    for name, text, other in changes:
        file = folder / name
        assert text in file.read_text()
        file.write_text(file.read_text().replace(text, other))
    for name, text in files.items():
        (folder / f"{name}.lp").write_text(text)
    return folder


@pytest.mark.parametrize("rooms", [4, 7, 10, 12])
def test_a_home_keeps_all_that_its_grammar_promises(home: Builder, rooms: int) -> None:
    for index in range(4):
        house = home.house(HouseRequest(rooms), 5, index)
        assert check(house) == []
        assert len(house.rooms) == rooms
        assert list(architect.faults(house)) == []
        assert house.topology == "ring"
        assert House.from_dict(house.to_dict()) == house


def test_rooms_fill_the_outline_and_every_room_can_be_entered_by_doors_within_both_walls(
    tmp_path: Path,
) -> None:
    made = builder(copied(tmp_path, ("rooms.lp", "notches(2)", "notches(0)")))
    for seed in range(20):
        plan, _ = unfurnished(made, 8, seed)
        boxes = [room.box for room in plan.rooms]
        assert all(overlap(one, other) < 1e-6 for one, other in combinations(boxes, 2))
        whole = max(box[2] for box in boxes) * max(box[3] for box in boxes)
        assert sum(room.area for room in plan.rooms) == pytest.approx(whole)
        reached: set[int | str] = {OUTSIDE}
        for door in plan.doors:
            for room in (plan.rooms[each] for each in door.between if isinstance(each, int)):
                (west, north, east, south), (left, top, right, bottom) = room.box, door.box
                assert west - 1e-6 <= left <= right <= east + 1e-6
                assert north - 1e-6 <= top <= bottom <= south + 1e-6
        ways = [{*door.between} for door in plan.doors]
        for _ in plan.rooms:
            reached.update(*(way for way in ways if reached & way))
        assert len(reached) == 9


def test_a_house_is_a_function_of_its_seed(home: Builder) -> None:
    first = home.house(HouseRequest(6), 2, 3)
    home.house(HouseRequest(6), 9, 9)
    assert home.house(HouseRequest(6), 2, 3) == first


def test_hardly_two_plans_have_the_same_topology(home: Builder) -> None:
    found = {tuple(map(str, layout)) for layout in layouts(home, 8, range(60))}
    assert len(found) >= 59


@pytest.mark.second_part("systems by three solvers")
def test_nothing_is_refuted_that_has_a_solution(home: Builder) -> None:
    """CLP(Q) agrees with HiGHS. CLP(R) may refute a feasible system, but accepts no infeasible one."""
    for systems in (
        wall_systems(home, 6, range(60)),
        given_systems(home, 6, range(4)),
        furniture_systems(home, range(30)),
    ):
        found = verdicts(systems)
        assert {rational == highs for _, rational, highs in found} == {True}
        assert not any(real and not highs for real, _, highs in found)
        assert len(found) >= 2


def test_a_conflict_is_a_nogood_that_no_layout_of_this_house_has(home: Builder) -> None:
    nogoods: list[Nogood] = []
    for seed in range(40):
        _, layout = unfurnished(home, 5, seed, nogoods)
        assert not any(all((atom in layout) == holds for atom, holds in each.items()) for each in nogoods)
    assert nogoods


@pytest.mark.second_part("large plans")
@pytest.mark.parametrize(
    ("rooms", "types", "reasons"),
    [
        (
            8,
            {"hall": 0, "corridor": 0, "living": 0},
            ["opens(outside,any_other_type) is not stated", "--type hall=0"],
        ),
        (
            4,
            {"living": 0, "bedroom": 0},
            [":- { room(R,living); room(R,bedroom) } = 0.", "--type bedroom=0"],
        ),
    ],
)
def test_that_there_is_no_plan_is_proved_by_the_users_own_lines(
    home: Builder, rooms: int, types: dict[str, int], reasons: list[str]
) -> None:
    with pytest.raises(Unsatisfiable) as error:
        house_or_proof(home, HouseRequest.read({"rooms": rooms, "types": types}), 0, 0)
    assert [each for each in reasons if each not in str(error.value)] == []


@pytest.mark.second_part("many proofs")
@pytest.mark.parametrize(
    ("text", "other", "rule", "named"),
    [
        (
            "(hall; corridor; living)).",
            "hall).",
            ":- room(R,hall), from(R,outside).",
            "opens(outside,any_other_type) is not stated",
        ),
        (
            "kitchen; study).",
            "kitchen; study).  lit(bathroom).",
            ":- window(R,_), room(R,bathroom).",
            "lit(bathroom).",
        ),
    ],
)
def test_a_proof_names_the_line_that_says_who_opens_into_whom_or_needs_a_window(
    tmp_path: Path, text: str, other: str, rule: str, named: str
) -> None:
    folder = copied(tmp_path, ("rooms.lp", text, other), mine=f"#program house.\n{rule}\n")
    with pytest.raises(Unsatisfiable) as error:
        house_or_proof(builder(folder), HouseRequest(5), 0, 0)
    reasons = {each.text for each in error.value.reasons}
    assert {named, rule} <= reasons


def test_an_outline_may_lack_corners(home: Builder) -> None:
    filled = []
    for index in range(6):
        house = home.house(HouseRequest(6), 0, index)
        assert check(house) == []
        east, south = (max(room.box[side] for room in house.rooms) for side in (2, 3))
        filled.append(sum(room.area for room in house.rooms) / (east * south))
    assert min(filled) < 0.9
    assert max(filled) > 0.999


def test_another_topology_of_the_core_serves_the_same_rules(tmp_path: Path) -> None:
    made = builder(copied(tmp_path, ("rooms.lp", "topology(ring).", "topology(dissection).")))
    for index in range(3):
        house = made.house(HouseRequest(5), 0, index)
        assert house.topology == "dissection"
        assert check(house) == []


def test_a_user_adds_a_topology_as_one_file(tmp_path: Path) -> None:
    long = ("lengths.pl", "W =< 2.2*D", "W =< 4*D")
    ring = ("rooms.lp", "topology(ring).", "topology(row).")
    common = ("rooms.lp", ":- not common.", ":- not common, rooms > 4.")
    folder = copied(tmp_path, ring, common, long, row=ROW)
    made = builder(folder)
    house = made.house(HouseRequest.read({"rooms": 4, "types": {"dining": 0}}), 0, 0)
    assert house.topology == "row"
    assert len({room.y for room in house.rooms}) == 1


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("rooms.lp", "topology(ring).", "topology(rign)."), "did you mean ring"),
        (("rooms.lp", "topology(ring).", "topology(ring). topology(dissection)."), "one topology"),
        (("rooms.lp", "topology(ring).", "topology(X) :- X = ring."), "rooms.lp:2:1: .* by a fact alone"),
        (("rooms.lp", "topology(ring).", "topology(ring;dissection)."), "rooms.lp:2:1: .* by a fact alone"),
        (("rooms.lp", "topology(ring).", 'mine("topology(ring).").'), "is no fact where it stands"),
        (("rooms.lp", "opens(outside, (hall;", "opens(outside, (haal;"), "haal"),
    ],
)
def test_a_topology_or_type_that_there_is_not_is_named(
    tmp_path: Path, change: tuple[str, str, str], says: str
) -> None:
    with pytest.raises(GrammarError, match=says):
        builder(copied(tmp_path, change))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("topology( dissection ) .", "dissection"),
        ("topology(\n  dissection\n).", "dissection"),
        ("%*\ntopology(ring).\n*% topology(dissection).", "dissection"),
        ("% topology(ring).", "star"),
    ],
)
def test_a_topology_is_named_where_clingo_sees_it(tmp_path: Path, text: str, name: str) -> None:
    assert find(copied(tmp_path, ("rooms.lp", "topology(ring).", text))).topology_name == name


def test_more_rooms_than_the_topology_holds_are_refused(home: Builder) -> None:
    with pytest.raises(RequestError, match="at most 14"):
        home.house(HouseRequest(15), 0, 0)


def test_a_grammar_that_names_no_topology_is_a_star() -> None:
    assert find("family").topology_name == "star"
    assert not find("family").shares_walls
    assert find("home").shares_walls


def test_rooms_of_a_star_cannot_be_kept_in_a_plan(home: Builder) -> None:
    room = StarRoom(0, 0, 4, 4, "bedroom", (), Rect(1, 4, 0.8, 0))
    star = House.of_star(Star(Rect(0, 4, 8, 8), (room,)))
    with pytest.raises(RequestError, match=r"keep: these are rooms of a star.*leave out keep"):
        home.house(HouseRequest(6, fixed=tuple(fixed_rooms(star))), 0, 0)


@pytest.mark.second_part("many requests")
def test_pieces_that_a_request_asks_for_stand_in_a_plan_or_are_proved_impossible(home: Builder) -> None:
    request = HouseRequest.read({"rooms": 6, "furniture": {"bedroom.singleBed": 2}})
    house = home.house(request, 0, 0)
    beds = [
        [piece.type for piece in room.pieces].count("singleBed")
        for room in house.rooms
        if room.type == "bedroom"
    ]
    assert set(beds) == {2}
    with pytest.raises(Unsatisfiable) as error:
        house_or_proof(home, HouseRequest.read({"rooms": 4, "furniture": {"bedroom.singleBed": 3}}), 0, 0)
    assert "may(bedroom,singleBed,0,2)." in str(error.value)
