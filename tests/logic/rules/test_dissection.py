"""Every dissection of a rectangle is chosen once, and the second order is what it says."""

import clingo
import pytest

from logic.grammar import RULES, TOPOLOGIES

BAXTER = [1, 2, 6, 22, 92, 422]
"""How many mosaic floorplans 1, 2, ... rooms have (https://oeis.org/A001181)."""


def dissections(rooms: int) -> list[frozenset[str]]:
    """The relations of each dissection: all stable models of the topology alone."""
    control = clingo.Control(["0", f"-crooms={rooms}"], logger=lambda code, message: None)
    control.load(str(RULES / "pick.lp"))
    control.load(str(TOPOLOGIES / "dissection.lp"))
    control.ground([("base", []), ("pick", []), ("house", [])])
    with control.solve(yield_=True) as models:
        return [frozenset(map(str, model.symbols(atoms=True))) for model in models]


@pytest.mark.parametrize("rooms", range(1, len(BAXTER) + 1))
def test_there_are_as_many_dissections_as_baxter_permutations_and_none_comes_twice(rooms: int) -> None:
    found = dissections(rooms)
    walls = {frozenset(atom for atom in model if atom.startswith("edge(")) for model in found}
    assert len(found) == len(walls) == BAXTER[rooms - 1]


def test_a_room_has_four_edges_and_a_wall_more_makes_a_room_more() -> None:
    for model in dissections(5):
        edges = [clingo.parse_term(atom).arguments for atom in model if atom.startswith("edge(")]
        assert sorted((room.number, side.name) for room, side, _ in edges) == [
            (room, side) for room in range(5) for side in ("east", "north", "south", "west")
        ]
        assert len({str(line) for *_, line in edges if line.name == "wall"}) == 4
