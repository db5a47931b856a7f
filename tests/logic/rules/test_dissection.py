"""Every dissection of a rectangle has exactly one choice, and the second order is correct."""

import clingo
import pytest

from vitruvius.logic.grammar import RULES, TOPOLOGIES

SIDES = ("north", "east", "south", "west")

BAXTER = [1, 2, 6, 22, 92, 422]
"""Numbers of mosaic floorplans with 1, 2, ... rooms (https://oeis.org/A001181)."""


def dissections(rooms: int, *facts: str) -> list[frozenset[str]]:
    """Return the relations of each dissection: all stable models of the topology alone, or with facts."""
    control = clingo.Control(["0", f"-crooms={rooms}"], logger=lambda code, message: None)
    control.load(str(RULES / "pick.lp"))
    control.load(str(TOPOLOGIES / "dissection.lp"))
    control.add("house", [], " ".join(facts))
    control.ground([("base", []), ("pick", []), ("house", [])])
    with control.solve(yield_=True) as models:
        return [frozenset(map(str, model.symbols(atoms=True))) for model in models]


@pytest.mark.parametrize("rooms", range(1, len(BAXTER) + 1))
def test_there_are_as_many_dissections_as_baxter_permutations_and_none_comes_twice(rooms: int) -> None:
    found = dissections(rooms)
    walls = {frozenset(atom for atom in model if atom.startswith("edge(")) for model in found}
    assert len(found) == len(walls) == BAXTER[rooms - 1]


@pytest.mark.parametrize("rooms", range(1, 5))
def test_a_void_is_each_box_of_each_dissection_that_is_no_side_of_the_outline_alone(rooms: int) -> None:
    expected = 0
    for model in dissections(rooms + 1):
        at_side = {side: sum(f",{side},outline(" in atom for atom in model) for side in SIDES}
        expected += sum(
            not any(f"edge({box},{side},outline({side}))" in model and at_side[side] == 1 for side in SIDES)
            for box in range(rooms + 1)
        )
    found = dissections(rooms, "void(rooms).")
    orders, walls = (
        {frozenset(atom for atom in model if atom.startswith(name)) for model in found}
        for name in ("pick(order(", "edge(")
    )
    assert len(orders) == len(walls) == expected


def test_a_room_has_four_edges_and_a_wall_more_makes_a_room_more() -> None:
    for model in dissections(5):
        edges = [clingo.parse_term(atom).arguments for atom in model if atom.startswith("edge(")]
        assert sorted((room.number, side.name) for room, side, _ in edges) == [
            (room, side) for room in range(5) for side in ("east", "north", "south", "west")
        ]
        assert len({str(line) for *_, line in edges if line.name == "wall"}) == 4
