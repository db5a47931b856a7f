"""Rooms of one type with equal sizes, by `same_size`: in houses, plans, proofs and the check."""

import shutil
from pathlib import Path

import pytest
from msgspec import structs

from tests.logic.request.test_given_plan import Box, geojson
from tests.logic.workers.in_process import generate
from vitruvius.logic import Unsatisfiable, check, nearest_plan
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.house import House
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

HOTEL = Path(__file__).parents[3] / "examples" / "hotel"
PAIR = """
topology(corridor).  type(corridor; cell).  empty(corridor; cell).  central(corridor).  oblong(corridor).
degree(corridor,1,9).  opens(outside,corridor).  opens(corridor,cell).
#program house.
:- not opposite_rows.
opposite_rows :- in_row(_,north,2), in_row(_,south,1).
"""
PAIR_SIZES = """
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
room_size(corridor, W, D) :- { W = 1.5, D >= 3.0, D =< 20.0 }.
room_size(cell, W, D) :- { W >= 2.0, W =< 5.0, D >= 2.0, D =< 5.0 }.
"""


@pytest.fixture
def hotel(tmp_path: Path) -> Builder:
    folder = shutil.copytree(HOTEL, tmp_path / "hotel")
    (folder / "more.lp").write_text("same_size(guest; bath).\n")
    return Builder(find(folder))


def sizes(house: House, type_: str) -> list[tuple[float, float]]:
    return [(room.width, room.height) for room in house.rooms if room.type == type_]


def test_all_guest_rooms_of_a_hotel_are_one_by_their_walls(hotel: Builder) -> None:
    for seed in range(3):
        house = hotel.house(HouseRequest(17), seed, 0)
        assert check(house) == []
        guests = sizes(house, "guest")
        assert len(guests) == 8
        assert all(abs(a - b) < 1e-6 for size in guests for a, b in zip(size, guests[0], strict=True))


def test_check_finds_the_one_that_is_larger(hotel: Builder) -> None:
    house = hotel.house(HouseRequest(9), 0, 0)
    guest = next(room for room in house.rooms if room.type == "guest")
    rooms = tuple(
        structs.replace(room, width=room.width + 0.01) if room is guest else room for room in house.rooms
    )
    assert any("(must be the same)" in fault for fault in check(structs.replace(house, rooms=rooms)))


def test_rooms_that_cannot_be_equally_large_are_proved(tmp_path: Path) -> None:
    """Two rooms north of a corridor are as long as one south of it, unless their sizes are equal."""
    (tmp_path / "rooms.lp").write_text(PAIR)
    (tmp_path / "sizes.pl").write_text(PAIR_SIZES)
    assert len(sizes(Builder(find(tmp_path)).house(HouseRequest(4), 0, 0), "cell")) == 3
    (tmp_path / "more.lp").write_text("same_size(cell).\n")
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(Builder(find(tmp_path)), HouseRequest(4), 0, 0)
    assert "same_size(cell)" in " ".join(reason.text for reason in caught.value.reasons)


def test_oblong_rooms_that_lie_across_are_compared_by_their_shorter_sides(tmp_path: Path) -> None:
    folder = shutil.copytree(SHIPPED / "clinic", tmp_path / "clinic")
    (folder / "more.lp").write_text("same_size(washroom).\n")
    clinic, across = Builder(find(folder)), 0
    for seed in range(8):
        house = clinic.house(HouseRequest(20), seed, 0)
        assert check(house) == []
        washrooms = sizes(house, "washroom")
        across += any(w < d for w, d in washrooms) and any(w > d for w, d in washrooms)
        first = sorted(washrooms[0])
        assert all(abs(a - b) < 1e-6 for size in washrooms for a, b in zip(sorted(size), first, strict=True))
    assert across, "none lies across another"


def test_a_plan_with_two_sizes_is_refuted_and_the_nearest_with_one_has_its_house(tmp_path: Path) -> None:
    boxes: dict[str, Box] = {"way": (0, 4, 7.4, 5.5), "one": (0, 0, 3.4, 4), "two": (3.4, 0, 7.4, 4)}
    plan = geojson(boxes, way="corridor", one="cell", two="cell")
    (tmp_path / "rooms.lp").write_text(PAIR.split("#program", maxsplit=1)[0])
    (tmp_path / "sizes.pl").write_text(PAIR_SIZES)
    assert check(next(generate(plan=plan, grammar=tmp_path))) == []
    (tmp_path / "more.lp").write_text("same_size(cell).\n")
    with pytest.raises(Unsatisfiable, match="same_size"):
        next(generate(plan=plan, grammar=tmp_path))
    found = nearest_plan(plan, grammar=tmp_path)
    house = next(generate(plan=found.plan, grammar=tmp_path))
    assert check(house) == []
    (one, deep), (two, as_deep) = sizes(house, "cell")
    assert (one, deep) == pytest.approx((two, as_deep), abs=1e-6)


@pytest.mark.usefixtures("hotel")
def test_both_sides_of_a_hotel_are_mirror_images_by_same_size_and_rules(tmp_path: Path) -> None:
    rule = """
#program house.
:- in_row(R,north,K), in_row(Q,south,K), room(R,T), not room(Q,T).
:- in_row(R,north,K), not in_row(_,south,K).
:- in_row(R,south,K), not in_row(_,north,K).
:- niche(_).
"""
    folder = tmp_path / "hotel"
    (folder / "more.lp").write_text("same_size(guest; bath).\n" + rule)
    builder = Builder(find(folder))
    for rooms in (9, 13):
        house = builder.house(HouseRequest(rooms), 0, 0)
        assert check(house) == []
        (corridor,) = [room for room in house.rooms if room.type == "corridor"]
        middle = 2 * corridor.y + corridor.height
        for room in house.rooms:
            mirrored = (room.x, middle - room.y - room.height, room.width, room.height)
            assert any(
                other.type == room.type
                and (other.x, other.y, other.width, other.height) == pytest.approx(mirrored, abs=1e-6)
                for other in house.rooms
            )
