"""Relations of rooms in rules agree with the geometry of plans, relation by relation."""

from collections.abc import Callable, Iterable
from itertools import combinations
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from clingo import Symbol

from tests.logic.generation.test_shared_walls import unfurnished
from tests.logic.rules.plan_geometry import TOLERANCE, Box, neighbours, shared
from tests.logic.rules.test_adjacent import NAMED, copied
from tests.logic.workers.in_process import builder
from vitruvius.logic.generation.loop import Work
from vitruvius.logic.generation.units import UnitsDraft
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE
from vitruvius.logic.placement import plan as placed
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

SIDES = {"west": 0, "north": 1, "east": 2, "south": 3}


class Plan:
    """Plan of walls, doors and windows in numbers, and the rules' atoms about it."""

    def __init__(self, plan: placed.Plan, atoms: Iterable[Symbol]) -> None:
        self.boxes = [room.box for room in plan.rooms]
        self.types = [room.type for room in plan.rooms]
        self.doors = [(door.box, door.between) for door in plan.doors]
        self.windows = [(window.box, window.room) for window in plan.windows]
        self._atoms = list(atoms)

    def said(self, name: str, arity: int) -> set[tuple[Any, ...]]:
        """Return the arguments of all atoms of a name: numbers, and other terms as text."""
        found = [atom.arguments for atom in self._atoms if atom.match(name, arity)]
        return {tuple(a.number if a.type.name == "Number" else str(a) for a in each) for each in found}

    def side_of(self, opening: Box, room: int) -> str:
        """Return the side of a room in which an opening lies."""
        box = self.boxes[room]
        (side,) = (
            side
            for side, k in SIDES.items()
            if abs(opening[k] - box[k]) + abs(opening[(k + 2) % 4] - box[k]) <= 2 * TOLERANCE
        )
        return side

    def leads_out(self, opening: Box, room: int) -> bool:
        """Return True if no other room is behind an opening of a room."""
        return not any(shared(opening, box) for other, box in enumerate(self.boxes) if other != room)

    def free(self, room: int, side: str) -> tuple[float, float]:
        """Return the length of a side, and the length that no other room shares."""
        k = SIDES[side]
        box = self.boxes[room]
        whole = box[3 - k % 2] - box[1 - k % 2]
        behind = [
            b for r, b in enumerate(self.boxes) if r != room and abs(b[(k + 2) % 4] - box[k]) <= TOLERANCE
        ]
        return whole, whole - sum(shared(box, other) for other in behind)

    def beyond(self, room: int, other: int, side: str) -> bool:
        """Return True if a room lies wholly beyond the line of another room's side."""
        k = SIDES[side]
        near, line = self.boxes[room][(k + 2) % 4], self.boxes[other][k]
        return near <= line + TOLERANCE if side in ("west", "north") else near >= line - TOLERANCE


def linked(plan: Plan) -> None:
    doors = [tuple(between) for _, between in plan.doors if OUTSIDE not in between]
    assert plan.said("linked", 2) == {*doors, *((q, r) for r, q in doors)}
    for box, (one, other) in plan.doors:
        for room in (each for each in (one, other) if isinstance(each, int)):
            assert shared(box, plan.boxes[room]) or plan.side_of(box, room)


def from_(plan: Plan) -> None:
    ways = plan.said("from", 2)
    doors = [{*between} for _, between in plan.doors]
    assert len(ways) == len(plan.boxes) == len({room for room, _ in ways})
    assert all({*way} in doors for way in ways)
    types = {(room, plan.types[other] if other != OUTSIDE else OUTSIDE) for room, other in ways}
    assert plan.said("entered", 2) == types


def entrance(plan: Plan) -> None:
    (found,) = [(box, int(room)) for box, (room, other) in plan.doors if other == OUTSIDE]
    assert plan.said("entrance", 2) == {(found[1], plan.side_of(*found))}
    assert plan.leads_out(*found)


def adjacent(plan: Plan) -> None:
    found = neighbours(plan.boxes)
    assert plan.said("adjacent", 2) == {*found}
    assert plan.said("face", 2) >= {*found}
    assert min(found.values(), default=1) >= 0.1 - 1e-6


def window(plan: Plan) -> None:
    assert plan.said("window", 2) == {(room, plan.side_of(box, room)) for box, room in plan.windows}
    assert all(plan.leads_out(*each) for each in plan.windows)


def outer(plan: Plan) -> None:
    for room in range(len(plan.boxes)):
        for side in SIDES:
            whole, free = plan.free(room, side)
            assert ((room, side) in plan.said("outer", 2)) == (free > 1e-5), (room, side)
            assert plan.said("niche", 1) or min(free, whole - free) == pytest.approx(0, abs=1e-5), (
                room,
                side,
            )


def runs(plan: Plan) -> None:
    for room, axis in plan.said("runs", 2):
        west, north, east, south = plan.boxes[room]
        assert (east - west > south - north) == (axis == "x")


def edge(plan: Plan) -> None:
    places: dict[str, set[float]] = {}
    for room, side, line in plan.said("edge", 3):
        places.setdefault(line, set()).add(round(plan.boxes[room][SIDES[side]], 5))
    assert all(len(found) == 1 for found in places.values())
    bounds = [pick(box[k] for box in plan.boxes) for k, pick in enumerate((min, min, max, max))]
    assert all(places[f"outline({side})"] == {round(bounds[k], 5)} for side, k in SIDES.items())


def band(plan: Plan) -> None:
    bands = plan.said("band", 2)
    assert len(bands) == len(plan.boxes) - 1
    assert all(plan.beyond(room, 0, side) for room, side in bands)


def behind(plan: Plan) -> None:
    sides = dict(plan.said("band", 2))
    for (room,) in plan.said("behind", 1):
        assert plan.beyond(room, room - 1, sides[room])
        k = 1 - SIDES[sides[room]] % 2
        before, here = plan.boxes[room - 1], plan.boxes[room]
        assert shared(before, here) == pytest.approx(here[k + 2] - here[k]) == before[k + 2] - before[k]


def owns(plan: Plan) -> None:
    bounds = [pick(box[k] for box in plan.boxes) for k, pick in enumerate((min, min, max, max))]
    sides = plan.said("band", 2)
    for side, further in plan.said("owns", 2):
        k = SIDES[further]
        ends = [plan.boxes[room][k] for room, each in sides if each == side]
        assert any(abs(end - bounds[k]) <= TOLERANCE for end in ends)
        assert abs(plan.boxes[0][k] - bounds[k]) > 0.5


def in_row(plan: Plan) -> None:
    for room, row, number in plan.said("in_row", 3):
        if row in ("north", "south"):
            assert plan.beyond(room, 0, row)
            assert number == 1 or plan.boxes[room - 1][2] <= plan.boxes[room][0] + TOLERANCE
        else:
            wing, side = row.strip("()").split(",")
            assert plan.beyond(room, int(wing), side)
    for wing, side, _ in plan.said("wing", 3):
        assert plan.beyond(wing, 0, side)
    for (room,) in plan.said("niche", 1):
        assert any(whole - free == 0 < free for whole, free in (plan.free(room, side) for side in SIDES))


def lies(plan: Plan) -> None:
    ways = {side: plan.said(f"{side}_of", 2) for side in ("west", "north")}
    for side, pairs in ways.items():
        assert all(plan.beyond(room, other, side) for room, other in pairs)
    assert sorted(pair for pairs in ways.values() for pair in pairs) == list(
        combinations(range(len(plan.boxes)), 2)
    )


ALL: tuple[Callable[[Plan], None], ...] = (linked, from_, entrance, adjacent, window, outer, runs, edge)


@pytest.mark.second_part("every relation in every topology")
@pytest.mark.parametrize(
    ("base", "topology", "sizes", "more"),
    [
        ("home", "", (5, 11), (band, behind, owns)),
        ("home", "dissection", (4, 8), (lies,)),
        ("home", "rows", (7,), ()),
        ("clinic", "", (3, 16), (in_row,)),
    ],
)
def test_what_rules_say_of_rooms_is_so_in_the_plan(
    base: str, topology: str, sizes: tuple[int, ...], more: tuple[Callable[[Plan], None], ...], tmp_path: Path
) -> None:
    made = builder(copied(tmp_path, NAMED, base, topology))
    for size in sizes:
        program, _ = made.programs.rooms_for(HouseRequest(size))
        program.models = []
        for seed in range(3):
            plan, _ = unfurnished(made, size, [size, seed])
            for relation in (*ALL, *more):
                relation(Plan(plan, program.models[-1][1]))


def test_an_oblong_room_runs_along_its_longer_side_whatever_its_size_allows(tmp_path: Path) -> None:
    made = builder(copied(tmp_path, "oblong(kitchen;bedroom;living).\n"))
    for index in range(2):
        house = made.house(HouseRequest(5), 3, index)
        unfurnished = tuple(msgspec.structs.replace(room, type="", children=()) for room in house.rooms)
        plan = HouseRequest(5, plan=read_plan(House(unfurnished, (), ())))
        layouts = [made.origin.layout]
        found_in_plan = made.house(plan, 3, index)
        layouts.append(made.origin.layout)
        for layout, found in zip(layouts, (house, found_in_plan), strict=True):
            axes = {a.arguments[0].number: str(a.arguments[1]) for a in layout if a.match("runs", 2)}
            assert "kitchen" in {found.rooms[room].type for room in axes}
            for room, axis in axes.items():
                assert (found.rooms[room].width > found.rooms[room].height) == (axis == "x")


def test_what_rules_say_of_units_is_so_in_the_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    made = builder("apartments")
    kept: list[Any] = []
    furnish = UnitsDraft.furnish

    def kept_and_furnished(self: UnitsDraft, layout: Any, placed: Any) -> Any:
        kept[:] = [placed.units, {room.number: room.box for room in placed.whole.rooms}]
        return furnish(self, layout, placed)

    monkeypatch.setattr(UnitsDraft, "furnish", kept_and_furnished)
    for rooms in (8, 13):
        made.maker.made(HouseRequest(rooms), Work(np.random.default_rng(rooms), 10**8))
        drafts, boxes = kept
        for unit in (draft.unit for draft in drafts):
            near = {
                side
                for side, k in SIDES.items()
                for other, box in boxes.items()
                if other != unit.number
                and abs(box[(k + 2) % 4] - boxes[unit.number][k]) <= TOLERANCE
                and shared(box, boxes[unit.number])
            }
            assert unit.inner == near
            assert shared(boxes[unit.public], boxes[unit.number])
            k = SIDES[unit.access]
            assert abs(boxes[unit.public][(k + 2) % 4] - boxes[unit.number][k]) <= TOLERANCE
        assert not any(shared(a, b) < 0 for a, b in combinations(boxes.values(), 2))
