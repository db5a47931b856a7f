"""The topology of the shipped clinic: rooms along a corridor, from 14 rooms on in wings too."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from clingo import Symbol

from tests.logic.workers import in_process
from vitruvius.logic import Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Room
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.house_request import HouseRequest


@pytest.fixture
def clinic() -> Builder:
    return in_process.builder("clinic")


def houses(made: Builder, rooms: int, count: int) -> Iterator[House]:
    return (made.house(HouseRequest(rooms), 3, index) for index in range(count))


def share_a_wall(one: Room, other: Room) -> bool:
    (a, b, c, d), (e, f, g, h) = one.box, other.box
    across, along = min(c, g) - max(a, e), min(d, h) - max(b, f)
    return min(across, along) == pytest.approx(0, abs=1e-6) and max(across, along) > 1e-3


@pytest.mark.parametrize("rooms", [6, 13, 14, 40])
def test_every_room_lies_along_a_corridor(clinic: Builder, rooms: int) -> None:
    for house in houses(clinic, rooms, 2):
        assert check(house) == []
        corridors = [room for room in house.rooms if room.type == "corridor"]
        for room in house.rooms[1:]:
            assert any(share_a_wall(room, corridor) for corridor in corridors if corridor is not room)


def test_rooms_stand_on_both_sides_of_a_corridor_through_the_whole_plan(clinic: Builder) -> None:
    for house in houses(clinic, 10, 4):
        corridor = house.rooms[0]
        west, _, east, south = (
            pick(room.box[side] for room in house.rooms)
            for pick, side in ((min, 0), (min, 1), (max, 2), (max, 3))
        )
        assert (corridor.x, corridor.width) == pytest.approx((west, east - west))
        assert 0.5 < corridor.y < corridor.y + corridor.height < south - 0.5


def test_wings_branch_off_the_corridor_and_their_rooms_look_onto_the_courts_between(clinic: Builder) -> None:
    for house in houses(clinic, 40, 2):
        spine, *wings = (room for room in house.rooms if room.type == "corridor")
        assert len(wings) in (2, 3)
        assert all(share_a_wall(spine, wing) and wing.height > wing.width for wing in wings)
        east, south = (max(room.box[side] for room in house.rooms) for side in (2, 3))
        inner = [w for w in house.windows if w.height and 1e-6 < w.x < east - 1e-6]
        assert inner
        assert sum(room.area for room in house.rooms) < 0.9 * east * south


def test_one_enters_by_the_reception_and_waits_beside_it_and_not_beside_a_ward(clinic: Builder) -> None:
    for house in houses(clinic, 13, 6):
        types = {room.name: room.type for room in house.rooms} | {OUTSIDE: OUTSIDE}
        doors = {frozenset(types[name] for name in door.between) for door in house.doors}
        assert frozenset({OUTSIDE, "reception"}) in doors
        assert frozenset({"waiting", "reception"}) in doors
        waiting, wards = ([r for r in house.rooms if r.type == each] for each in ("waiting", "ward"))
        assert not any(share_a_wall(one, other) for one in waiting for other in wards)


SERVICE = """
topology(corridor).
type(corridor; office; toilet).
opens(outside,corridor).  opens(corridor,(office; toilet)).
central(corridor).  oblong(corridor).  degree(corridor,1,40).  lit(office).  empty(corridor; office; toilet).
#program house.
:- { room(_,corridor) } != 1.
:- { room(_,toilet) } != (rooms+1)/4.
"""
SIZES = """
door_width(0.8).  door_margin(0.1).  window_margin(0.3).
door_clearance(0.45).  passage(0.42).  room_gap(0.0).
room_size(corridor, W, D) :- { W >= 1.5, W =< 2.0, D >= 4.0, D =< 40.0 }.
room_size(office,   W, D) :- { W >= 3.0, W =< 6.0, D >= 5.0, D =< 6.0 }.
room_size(toilet,   W, D) :- { W >= 1.6, W =< 3.0, D >= 1.6, D =< 3.0 }.
window_size(_, L, Wall) :- { L >= 0.6, L =< 0.6*Wall }.
"""


def test_rooms_that_need_no_window_may_be_less_deep_than_those_beside_them(tmp_path: Path) -> None:
    (tmp_path / "rooms.lp").write_text(SERVICE)
    (tmp_path / "sizes.pl").write_text(SIZES)
    for house in chain.from_iterable(in_process.generate(n, grammar=tmp_path, count=4) for n in (8, 14)):
        assert check(house) == []
        sizes = {kind: [r.box for r in house.rooms if r.type == kind] for kind in ("office", "toilet")}
        assert all(5.0 <= south - north <= 6.0 + 1e-9 for _, north, _, south in sizes["office"])
        assert all(south - north <= 3.0 + 1e-9 for _, north, _, south in sizes["toilet"])


def test_hardly_two_clinics_have_the_same_topology(clinic: Builder) -> None:
    program, assumed = clinic.programs.rooms_for(HouseRequest(8))
    found: set[tuple[str, ...]] = set()
    for seed in range(60):
        layout: list[Symbol] | None = program.sample(np.random.default_rng(seed), assumed)
        assert layout is not None
        found.add(tuple(map(str, layout)))
    assert len(found) >= 59


def test_that_there_is_no_clinic_is_proved_by_its_own_lines(clinic: Builder) -> None:
    with pytest.raises(Unsatisfiable) as error:
        house_or_proof(clinic, HouseRequest.read({"rooms": 5, "types": {"washroom": 0}}), 0, 0)
    assert ":- rooms >= 3, not for_all." in str(error.value)
