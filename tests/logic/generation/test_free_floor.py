"""Free squares for wheelchairs, and windows of rooms that need none, as grammars require."""

import shutil
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from msgspec import structs

from tests.logic.workers import in_process
from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Piece, Room
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

TINY = """
topology(ring).  type(hall;bath).  empty(hall).  central(hall).
may(bath,tub,1,1).  stands(tub,(left;back;right)).
opens(outside,hall).  opens(hall,bath).
#program house.
:- not room(_,bath).
"""
TINY_SIZES = """
room_size(_, W, D) :- {{ W >= 1.6, W =< 3.2, D >= 1.6, D =< 3.2 }}.
piece_size(tub, L, D, _) :- {{ L = 1.6, D = 0.7 }}.
turning(bath, {}).
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
"""


def builder(folder: Path, rules: str = "", lengths: str = "", grammar: str = "home") -> Builder:
    """Return a builder for a copy of a shipped grammar with more rules and lengths."""
    shutil.copytree(SHIPPED / grammar, folder)
    (folder / "more.lp").write_text(rules)
    (folder / "more.pl").write_text(lengths)
    return Builder(find(folder))


def houses(of: Builder) -> Iterator[House]:
    """Yield houses as they are asked for."""
    return (of.house(HouseRequest(6), seed, 0) for seed in range(6))


def has_free_square(room: Room, side: float) -> bool:
    """Return True if a square fits somewhere without touching a piece.

    The places that are tried have a corner at edges of pieces.
    """
    west, north, east, south = room.box
    boxes = np.array([piece.box for piece in room.pieces]).reshape(-1, 4)
    for x in (west, *boxes[:, 2]):
        for y in (north, *boxes[:, 3]):
            if x + side > east + 1e-6 or y + side > south + 1e-6:
                continue
            apart = (boxes[:, 2] <= x + 1e-6) | (boxes[:, 0] >= x + side - 1e-6)
            apart |= (boxes[:, 3] <= y + 1e-6) | (boxes[:, 1] >= y + side - 1e-6)
            if apart.all():
                return True
    return False


@pytest.mark.second_part("many houses")
def test_a_wheelchair_turns_in_the_rooms_that_are_to_have_a_free_square(tmp_path: Path) -> None:
    made = houses(builder(tmp_path / "mine", lengths="turning(bathroom, 1.5).\nturning(bedroom, 1.4).\n"))
    wanted = {"bathroom": 1.5, "bedroom": 1.4}
    for house in islice(made, 3):
        assert check(house) == []
        for room in house.rooms:
            assert has_free_square(room, wanted.get(room.type, 0.0))
    homes = houses(in_process.builder("home"))
    plain = (room for house in homes for room in house.rooms if room.type in wanted)
    assert not all(has_free_square(room, wanted[room.type]) for room in plain), "homes have them anyway"


def test_check_finds_the_room_in_which_none_turns(tmp_path: Path) -> None:
    house = next(houses(builder(tmp_path / "mine", lengths="turning(bathroom, 1.5).\n")))
    room = next(room for room in house.rooms if room.type == "bathroom")
    west, north, east, south = room.box
    middle = Piece((west + east) / 2 - 0.1, (north + south) / 2 - 0.1, 0.2, 0.2, "sink")
    filled = structs.replace(room, children=(middle, *room.children))
    rooms = tuple(filled if each is room else each for each in house.rooms)
    faults = check(structs.replace(house, rooms=rooms))
    assert any("has no free square of 1.5 m" in fault for fault in faults)


def test_a_square_that_the_furniture_leaves_in_no_such_room_is_proved(tmp_path: Path) -> None:
    """A bath of at most 3.2 m by 3.2 m with a tub of 0.7 m has a free square of 2.5 m, and none of 2.6 m."""
    (tmp_path / "rooms.lp").write_text(TINY)
    sizes = tmp_path / "sizes.pl"
    sizes.write_text(TINY_SIZES.format(2.45))
    house = Builder(find(tmp_path)).house(HouseRequest(2), 0, 0)
    assert all(has_free_square(room, 2.45) for room in house.rooms if room.type == "bath")
    sizes.write_text(TINY_SIZES.format(2.6))
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(Builder(find(tmp_path)), HouseRequest(2), 0, 0)
    reasons = " ".join(reason.text for reason in caught.value.reasons)
    assert all(each in reasons for each in ("turning(bath", "piece_size(tub", "room_size(_"))


def test_rooms_that_may_be_lit_have_windows_now_and_then(tmp_path: Path) -> None:
    made = houses(builder(tmp_path / "mine", "may_be_lit(bathroom; corridor).\n"))
    having = {"bathroom": set[bool](), "corridor": set[bool](), "wc": set[bool]()}
    for house in made:
        assert check(house) == []
        for room in house.rooms:
            if room.type in having:
                having[room.type].add(any(window.room == room.name for window in house.windows))
        if having["bathroom"] == {True, False}:
            break
    assert having["bathroom"] == {True, False}
    assert having["wc"] <= {False}
