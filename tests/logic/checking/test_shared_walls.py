"""The independent check of houses that are no stars: each mistake in a correct plan has its own answer."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from msgspec.structs import replace

from logic import Door, House, Piece, Window, check
from logic.house.promises import Promises
from tests.plans import PLANS, flat, random_plan

HOME = Promises(
    door_width=0.8,
    room_area={"bedroom": (9.0, 20.0), "bathroom": (4.0, 10.0)},
    narrowest={"corridor": 1.1, "hall": 1.5},
    opens={
        "corridor": (
            "bedroom",
            "bathroom",
            "hall",
            "kitchen",
            "living",
        ),
        "bedroom": ("bathroom",),
        "kitchen": ("living",),
        "outside": ("hall",),
    },
    entrance=True,
    lit=(
        "bedroom",
        "kitchen",
        "living",
    ),
    hides=("wardrobe",),
)
FLAT = flat()


def with_room(name: str, **changes: Any) -> House:
    rooms = tuple(replace(room, **changes) if room.name == name else room for room in FLAT.rooms)
    return replace(FLAT, rooms=rooms)


def with_door(between: tuple[str, str], **changes: Any) -> House:
    doors = tuple(replace(door, **changes) if door.between == between else door for door in FLAT.doors)
    return replace(FLAT, doors=doors)


def with_window(room: str, **changes: Any) -> House:
    windows = tuple(replace(window, **changes) if window.room == room else window for window in FLAT.windows)
    return replace(FLAT, windows=windows)


def with_piece(room: str, *box: float, kind: str = "table") -> House:
    return with_room(room, children=(*FLAT.room(room).children, Piece(*box, type=kind)))


@pytest.mark.parametrize("seed", range(12))
def test_rooms_cut_out_of_a_rectangle_have_no_violation_but_where_none_leads_on(seed: int) -> None:
    house = random_plan(seed)
    assert not [line for line in check(house) if "cannot get into it" not in line]
    assert House.from_dict(house.to_dict()) == house


@pytest.mark.parametrize("name", PLANS)
def test_a_correct_plan_has_no_violation(name: str) -> None:
    assert check(PLANS[name]) == []
    if name == "flat":
        assert check(PLANS[name], HOME) == []


def test_furniture_may_stand_behind_the_wall_beside_a_door_of_other_rooms() -> None:
    """In the kitchen's corner, beside the door between corridor and bathroom."""
    house = with_door(("R0", "R5"), x=2.9)
    rooms = with_piece("R6", 3.9, 4.8, 0.15, 0.3).rooms
    assert check(replace(house, rooms=rooms)) == []


MISTAKES: dict[str, Callable[[], House]] = {
    r"R2 \(bathroom\) overlaps R3 \(bedroom\) by 0.30 m": lambda: with_room("R3", x=5.4, width=4.8),
    r"house: 1.08 m² between its rooms are no room's": lambda: with_room("R3", x=6.0, width=4.2),
    r"house: its rooms lie in 2 parts that do not touch": lambda: with_room("R7", x=60.0, children=()),
    r"R2 \(bathroom\) is of 7.56 m² \(9 to 10\)": lambda: FLAT,
    r"R0 \(corridor\) is 1.200 m wide at its shorter side \(at least 1.3\)": lambda: FLAT,
    r"door between R0 \(corridor\) and R3 \(bedroom\): is 0.600 m wide \(at least 0.8\)": lambda: with_door(
        ("R0", "R3"), width=0.6
    ),
    r"door between R0 \(corridor\) and R3 \(bedroom\): is not on a wall that they share": lambda: with_door(
        ("R0", "R3"), x=5.1
    ),
    r"R3 \(bedroom\): the body \(0.287 m square\) cannot get into it from R4 \(hall\)": lambda: replace(
        FLAT, doors=tuple(door for door in FLAT.doors if "R3" not in door.between)
    ),
    r"door between R4 \(hall\) and outside: is not on a wall of the room": lambda: with_door(
        ("R4", "outside"), y=8.0
    ),
    r"door between R4 \(hall\) and outside: leads into R5 \(bathroom\), not outside": lambda: with_door(
        ("R4", "outside"), x=1.8, y=5.7, width=0.0, height=0.9
    ),
    r"door between R1 .* and R4 \(hall\): bedroom and hall do not open into each other": lambda: replace(
        FLAT, doors=(*FLAT.doors, Door(0.0, 3.6, 0.9, 0.0, ("R1", "R4")))
    ),
    r"door between R0 .* and R6 .*: meets the door between R0 .* and R6": lambda: replace(
        FLAT, doors=(*FLAT.doors, Door(5.4, 4.8, 0.9, 0.0, ("R0", "R6")))
    ),
    r"house: has no door to the outside": lambda: replace(
        FLAT, doors=tuple(door for door in FLAT.doors if not door.is_entrance)
    ),
    r"R3 .*: its window at \(7.20, 3.60\) leads into R0 \(corridor\), not outside": lambda: with_window(
        "R3", y=3.6
    ),
    r"R3 .*: its window at \(7.20, 1.00\) is not on a wall of the room": lambda: with_window("R3", y=1.0),
    r"R6 \(kitchen\): its window at \(4.50, 8.40\) meets another window": lambda: replace(
        FLAT, windows=(Window(5.4, 8.4, 0.9, 0.0, "R6"), *FLAT.windows)
    ),
    r"R1 \(bedroom\): its window at \(0.90, 0.00\) is behind a wardrobe": lambda: with_piece(
        "R1", 1.2, 0.2, 0.6, 0.6, kind="wardrobe"
    ),
    r"R7 \(living\): has no window": lambda: replace(FLAT, windows=FLAT.windows[:3]),
    r"R0 \(corridor\): table stands 0.30 m from its door \(at least 0.45\)": lambda: with_piece(
        "R0", 2.7, 3.9, 0.3, 0.3
    ),
    r"R1 \(bedroom\): table stands 0.30 m from its door \(at least 0.45\)": lambda: with_piece(
        "R1", 3.0, 2.1, 0.3, 0.6
    ),
    r"R0 \(corridor\): no passage of 0.42 m joins its doors inside it": lambda: with_piece(
        "R0", 4.85, 3.6, 0.3, 1.2
    ),
}


@pytest.mark.parametrize("words", MISTAKES)
def test_each_mistake_has_its_answer(words: str) -> None:
    promises = HOME
    if "9 to 10" in words:
        promises = replace(HOME, room_area={"bathroom": (9.0, 10.0)})
    if "at least 1.3" in words:
        promises = replace(HOME, narrowest={"corridor": 1.3})
    found = check(MISTAKES[words](), promises)
    assert any(re.match(words, line) for line in found), found
