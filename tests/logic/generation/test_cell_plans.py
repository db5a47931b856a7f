"""Plans on a grid: all their lengths are whole cells."""

from collections.abc import Iterator

import pytest
from msgspec.structs import replace

from tests.logic.workers.in_process import generate
from vitruvius.logic import check
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Rect

CELL = 0.3


@pytest.fixture(scope="module")
def houses() -> list[House]:
    return [house for rooms in (4, 8) for house in generate(rooms, grammar="home", cell=CELL, count=2)]


def parts(house: House) -> Iterator[Rect]:
    yield from (*house.rooms, *house.doors, *house.windows)
    for room in house.rooms:
        yield from room.pieces


def test_walls_doors_windows_and_furniture_of_a_plan_lie_on_the_grid(houses: list[House]) -> None:
    for house in houses:
        assert check(house) == []
        assert sum(len(room.children) for room in house.rooms) > 3
        for part in parts(house):
            for metres in part.box:
                assert metres / CELL == pytest.approx(round(metres / CELL), abs=1e-6)
        assert all(door.length == pytest.approx(0.9) for door in house.doors)  # 0.8 m, rounded up


def test_the_check_finds_a_window_and_a_wall_that_are_off_the_grid(houses: list[House]) -> None:
    house = houses[0]
    window, room = house.windows[0], house.rooms[1]
    moved = replace(house, windows=(replace(window, x=window.x + 0.1), *house.windows[1:]))
    assert any("its window stands" in line and "off the grid" in line for line in check(moved))
    wider = tuple(replace(each, width=each.width + 0.1) if each is room else each for each in house.rooms)
    assert any("the room stands" in line for line in check(replace(house, rooms=wider)))
