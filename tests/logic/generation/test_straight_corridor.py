"""A straight corridor, by `straight` in the topology `corridor`: a hotel's floor of many similar rooms."""

import time
from pathlib import Path

import pytest

from tests.logic.workers import in_process
from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Room
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest

HOTEL = Path(__file__).parents[3] / "examples" / "hotel"
SECONDS = 20.0
"""CPU seconds in which a house is generated, or proved infeasible: a third of the limit of ``generate``."""


@pytest.fixture
def hotel() -> Builder:
    return in_process.builder(HOTEL)


def of_type(house: House, type_: str) -> list[Room]:
    return [room for room in house.rooms if room.type == type_]


@pytest.mark.parametrize("rooms", [9, 17, 33, 41])
def test_a_straight_corridor_is_one_rectangle_with_rooms_along_both_its_long_sides(
    hotel: Builder, rooms: int
) -> None:
    begin = time.process_time()
    house = hotel.house(HouseRequest(rooms), 4, 0)
    assert time.process_time() - begin < SECONDS
    assert check(house) == []
    (corridor,) = of_type(house, "corridor")
    west, north, east, south = corridor.box
    others = [room.box for room in house.rooms if room is not corridor]
    assert (west, east) == pytest.approx((min(b[0] for b in others), max(b[2] for b in others)))
    above = [box for box in others if box[3] == pytest.approx(north)]
    below = [box for box in others if box[1] == pytest.approx(south)]
    assert len(above) + len(below) == rooms - 1
    assert abs(len(above) - len(below)) <= 2
    for row in (above, below):
        assert sum(box[2] - box[0] for box in row) == pytest.approx(east - west)


def test_each_of_twenty_guest_rooms_has_its_bath_and_its_bed(hotel: Builder) -> None:
    house = hotel.house(HouseRequest(41), 0, 1)
    types = {room.name: room.type for room in house.rooms} | {OUTSIDE: OUTSIDE}
    guests = of_type(house, "guest")
    assert len(guests) == 20
    for guest in guests:
        doors = [door.between for door in house.doors if guest.name in door.between]
        beyond = sorted(types[name] for between in doors for name in between if name != guest.name)
        assert beyond == ["bath", "corridor"]
        assert "bed" in {piece.type for piece in guest.children}


def test_that_a_hotel_has_too_few_baths_is_proved(hotel: Builder) -> None:
    begin = time.process_time()
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(hotel, HouseRequest.read({"rooms": 9, "types": {"guest": 5}}), 0, 0)
    assert time.process_time() - begin < SECONDS
    reasons = [reason.text for reason in caught.value.reasons]
    assert ":- room(R,guest), { from(Q,R) } != 1." in reasons
    assert "--type guest=5" in reasons


@pytest.mark.second_part("a floor of a hotel")
def test_that_a_floor_of_many_alike_rooms_has_too_few_or_too_many_baths_is_proved(hotel: Builder) -> None:
    with pytest.raises(Unsatisfiable) as caught:
        house_or_proof(hotel, HouseRequest.read({"rooms": 15, "types": {"guest": 8}}), 0, 0)
    reasons = [reason.text for reason in caught.value.reasons]
    assert "--type guest=8" in reasons
    assert any("opens(" in text or "from(" in text for text in reasons)
