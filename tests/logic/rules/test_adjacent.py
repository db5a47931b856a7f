"""Rooms that share a wall: rules agree with geometry in all topologies."""

import shutil
from collections.abc import Iterable
from pathlib import Path

import msgspec

from tests.docs.reader import ROOT, blocks
from tests.logic.generation.test_shared_walls import unfurnished
from tests.logic.generation.test_units import PUBLIC, units
from tests.logic.rules.plan_geometry import neighbours, shared
from tests.logic.workers.in_process import builder
from vitruvius.logic import check
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.house.house import House
from vitruvius.logic.language.linter import errors, warnings
from vitruvius.logic.placement.plan import Plan
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

NAMED = "#program house.\n:- adjacent(R,R).\n:- linked(R,R).\n"
"""Rules that bind nothing."""
APART = "#program house.\n:- adjacent(R,Q), room(R,bathroom), room(Q,kitchen).\n"
BESIDE = """#program house.
:- { room(_,bedroom) } != 2.
:- not room(_,dining).
:- room(R,(bedroom;dining)), not adjacent(R,Q) : room(Q,living).
"""


def copied(folder: Path, rules: str, base: str = "home", topology: str = "") -> Path:
    """Write a grammar with additional rules, and optionally with another topology."""
    made = shutil.copytree(SHIPPED / base, folder / "mine")
    (made / "mine.lp").write_text(rules)
    page = (ROOT / "docs" / "tutorials" / "topology.md").read_text()
    text = next(block.text for block in blocks(page) if block.file == Path("mine/rows.lp"))
    file = made / "rooms.lp"
    wide = file.read_text().replace("notches(2)", "notches(4)")
    if topology:
        wide = wide.replace("topology(ring).", f"topology({topology}).")
        if topology == "rows":
            (made / "rows.lp").write_text(text)
    file.write_text(wide)
    return made


def pairs(atoms: Iterable, name: str) -> set[tuple[int, int]]:
    """Return the pairs of rooms in atoms of this name."""
    return {tuple(end.number for end in atom.arguments) for atom in atoms if atom.match(name, 2)}


def test_rooms_that_a_rule_keeps_apart_share_no_wall(tmp_path: Path) -> None:
    made = builder(copied(tmp_path, APART))
    assert not [*errors(made.grammar, made.loaded), *warnings(made.grammar, made.loaded, 6)]
    assert not any(meeting(unfurnished(made, size, [1, index])[0]) for size in (6, 11) for index in range(3))


def test_rooms_that_must_be_next_to_each_other_share_a_wall(tmp_path: Path) -> None:
    made = builder(copied(tmp_path, BESIDE))
    for index in range(4):
        house = made.house(HouseRequest(8), 1, index)
        assert check(house) == []
        (living,) = [room for room in house.rooms if room.type == "living"]
        beside = [room for room in house.rooms if room.type in ("bedroom", "dining")]
        assert len(beside) >= 3
        assert all(shared(room.box, living.box) >= 0.1 - 1e-6 for room in beside)


def test_in_a_house_of_units_adjacent_is_said_of_rooms_of_one_unit(tmp_path: Path) -> None:
    made = builder(copied(tmp_path, APART, "apartments"))
    for index in range(2):
        house = made.house(HouseRequest(13), 1, index)
        assert not any(meeting(house.only(*unit)) for unit in units(house))
        assert any(room.type == PUBLIC for room in house.rooms)


def test_in_a_plan_of_the_users_adjacent_is_what_the_plan_says(tmp_path: Path) -> None:
    made = builder(copied(tmp_path, APART))
    for index in range(2):
        first = made.house(HouseRequest(7), 6, index)
        unfurnished = tuple(msgspec.structs.replace(room, type="", children=()) for room in first.rooms)
        plan = read_plan(House(unfurnished, (), ()))
        request = HouseRequest(7, plan=plan)
        program = made.maker_of(request).stated(request)
        program.models = []
        house = made.house(request, 0, index)
        assert not meeting(house)
        found = set(neighbours([room.box for room in house.rooms]))
        assert all(pairs(atoms, "adjacent") == pairs(atoms, "face") == found for _, atoms in program.models)


def meeting(house: House | Plan, one: str = "bathroom", other: str = "kitchen") -> int:
    """Return the number of pairs of rooms of these types that share a wall."""
    ones, others = ([room for room in house.rooms if room.type == each] for each in (one, other))
    return sum(shared(a.box, b.box) > 0 for a in ones for b in others)
