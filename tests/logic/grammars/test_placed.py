"""The counter finds each oddity that is present; homes have no television under a window."""

from collections import Counter

import pytest

from tests.logic.grammars.placed import counted
from tests.logic.workers.in_process import generate
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door, Piece, Room, Window


def house(
    *types: str, ways: tuple[tuple[str, str], ...], pieces: tuple[Piece, ...] = (), windows: int = 0
) -> House:
    """Return a house with rooms of 4 by 4 m in a row, R0 first; pieces and windows are in R0."""
    rooms = tuple(
        Room(4 * k, 0, 4, 4, f"R{k}", type_, pieces if k == 0 else ()) for k, type_ in enumerate(types)
    )
    doors = tuple(Door(0, 0, 1, 0, way) for way in ways)
    return House(rooms, doors, tuple(Window(1, 0, 2, 0, "R0") for _ in range(windows)))


TOILET = Piece(0, 0, 0.4, 0.7, "toilet")
CHAIR = Piece(1, 1, 0.4, 0.4, "chair")
SOFA, SCREEN = Piece(1, 3.1, 2, 0.9, "sofa", "N"), Piece(1.2, 0, 1.4, 0.4, "tvBench", "S")


@pytest.mark.parametrize(
    ("name", "odd", "fine"),
    [
        (
            "bedroom behind a living room alone",
            house("living", "bedroom", ways=((OUTSIDE, "R0"), ("R0", "R1"))),
            house("living", "bedroom", ways=((OUTSIDE, "R0"), ("R0", "R1"), (OUTSIDE, "R1"))),
        ),
        (
            "storage behind a bedroom alone",
            house("hall", "bedroom", "storage", ways=((OUTSIDE, "R0"), ("R0", "R1"), ("R1", "R2"))),
            house("hall", "bedroom", "storage", ways=((OUTSIDE, "R0"), ("R0", "R1"), ("R0", "R2"))),
        ),
        (
            "bathroom with two toilets",
            house("bathroom", ways=(), pieces=(TOILET, TOILET)),
            house("bathroom", ways=(), pieces=(TOILET,)),
        ),
        (
            "treatment without a window",
            house("treatment", ways=()),
            house("treatment", ways=(), windows=1),
        ),
        (
            "television under a window",
            house("living", ways=(), pieces=(SCREEN,), windows=1),
            house("living", ways=(), pieces=(SCREEN,)),
        ),
        (
            "sofa with its front to a wall",
            house("living", ways=(), pieces=(Piece(1, 1, 2, 0.9, "sofa", "N"),)),
            house("living", ways=(), pieces=(SOFA,)),
        ),
        (
            "sofa with its back or side to the television",
            house("living", ways=(), pieces=(Piece(1, 1.5, 2, 0.9, "sofa", "S"), SCREEN)),
            house("living", ways=(), pieces=(SOFA, SCREEN)),
        ),
        (
            "desk without a chair",
            house("study", ways=(), pieces=(Piece(0, 0, 1, 0.6, "writingDesk", "S"),)),
            house("study", ways=(), pieces=(Piece(0, 0, 1, 0.6, "writingDesk", "S", (CHAIR,)),)),
        ),
    ],
)  # fmt: skip
def test_each_oddity_is_counted_where_it_is_and_nowhere_else(name: str, odd: House, fine: House) -> None:
    for plan, count in ((odd, 1), (fine, 0)):
        found, of = counted([plan])
        assert (found[name], of[name]) == (count, 1)


def test_homes_of_five_rooms_or_more_have_none_of_all_that() -> None:
    homes = [home for rooms in (5, 8, 11) for home in generate(rooms, grammar="home", seed=3, count=6)]
    found, of = counted(homes)
    assert of["television under a window"] == len(homes)
    assert of["desk without a chair"]
    assert of["sofa with its front to a wall"]
    assert +found == Counter()
