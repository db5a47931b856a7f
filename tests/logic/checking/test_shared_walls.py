"""The independent check of houses that are not stars: each mistake in a correct plan has its own answer."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from msgspec.structs import replace

from tests.plans import PLANS, flat, random_plan
from tests.thick import thickened
from vitruvius.logic import Door, House, Piece, Room, Window, check
from vitruvius.logic.checking import openings as checked
from vitruvius.logic.house.parts import Rect
from vitruvius.logic.house.promises import Promises

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
    """The furniture is in the kitchen's corner, beside the door between corridor and bathroom."""
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


def test_rooms_that_overlap_by_a_centimetre_are_found() -> None:
    found = check(with_room("R3", x=5.69, width=4.51))
    assert found == ["R2 (bathroom) overlaps R3 (bedroom) by 0.01 m"]


def test_a_door_is_as_wide_as_a_passage_where_no_width_is_promised() -> None:
    assert check(with_door(("R0", "R3"), width=0.42), Promises()) == []
    assert check(with_door(("R0", "R3"), width=0.41), Promises()) == [
        "door between R0 (corridor) and R3 (bedroom): is 0.410 m wide (at least 0.42)"
    ]


def test_the_number_of_other_rooms_that_a_room_has_doors_to_is_a_promise() -> None:
    """The corridor has six; entrances and doors to public rooms do not count."""
    assert check(FLAT, Promises(degree={"corridor": (6, 6), "hall": (1, 1), "living": (2, 2)})) == []
    assert check(FLAT, Promises(degree={"corridor": (1, 5)})) == [
        "R0 (corridor): has doors to 6 other rooms (must be 1 to 5)"
    ]
    public = Promises(degree={"living": (2, 2)}, public=("corridor",))
    assert "R7 (living): has doors to 1 other room (must be 2 to 2)" in check(FLAT, public)


def test_what_the_sides_of_a_house_keep_together_is_a_promise() -> None:
    """The house has 10.2 by 8.4 m."""
    assert check(FLAT, Promises(house_size=((1.0, -1.0, 1.8), (0.0, 1.0, 8.4)))) == []
    assert check(FLAT, Promises(house_size=((1.0, -1.0, 1.7), (0.0, 1.0, 8.3)))) == [
        "house: it is 10.200 m long and 8.400 m deep (must be: length <= depth + 1.7)",
        "house: it is 10.200 m long and 8.400 m deep (must be: depth <= 8.3)",
    ]


def test_what_the_sides_of_a_room_keep_together_holds_one_way_or_the_other() -> None:
    """The hall has 1.8 by 3.6 m."""
    assert check(FLAT, Promises(room_relations={"hall": ((2.0, -1.0, 0.0), (-2.0, 1.0, 0.0))})) == []
    assert check(FLAT, Promises(room_relations={"hall": ((-2.0, 1.0, 0.0), (2.0, -1.0, 0.0))})) == []
    assert check(FLAT, Promises(room_relations={"hall": ((1.0, -1.0, 0.0), (-1.0, 1.0, 0.0))})) == [
        "R4 (hall): it is 1.800 m long and 3.600 m deep (must be: depth <= length)"
    ]


def test_what_the_sides_of_a_piece_keep_together_is_a_promise() -> None:
    """Beds have 1.5 by 2.1 m, each with its back to the north wall."""
    deeper = Promises(piece_relations={"bed": ((1.0, -1.0, -0.6),)})
    assert check(FLAT, deeper) == []
    rooms = tuple(replace(room, children=tuple(map(turned, room.children))) for room in FLAT.rooms)
    words = "R1 (bedroom): bed is 2.100 m long and 1.500 m deep (must be: length + 0.6 <= depth)"
    assert words in check(replace(FLAT, rooms=rooms), deeper)


def turned(piece: Piece) -> Piece:
    return replace(piece, orientation="E") if piece.type == "bed" else piece


THICK = thickened(FLAT)
"""The flat with walls of 0.3 m between its rooms."""


def test_a_door_reaches_as_far_as_the_wall_across_and_no_farther() -> None:
    (door,) = (each for each in THICK.doors if each.between == ("R0", "R1"))
    end = THICK.room("R1").box[2]
    at_corner, past_it = (
        replace(THICK, doors=tuple(replace(door, x=x) if each is door else each for each in THICK.doors))
        for x in (end - door.width, end - door.width + 0.1)
    )
    assert check(at_corner) == check(THICK) == []
    assert check(past_it) == [
        "door between R0 (corridor) and R1 (bedroom): reaches 0.10 m into the wall across"
    ]


@pytest.mark.parametrize("at_end", [False, True])
def test_a_window_and_an_entrance_reach_no_farther_than_the_wall_across(at_end: bool) -> None:
    """Half of the wall of 0.3 m belongs to a room. An opening further out is on no wall of the room."""
    for kind, name, words in (
        ("windows", "R3", r"R3 \(bedroom\): its window at \(.*\) reaches 0.14 m into the wall across"),
        ("doors", "R4", r"door between R4 \(hall\) and outside: reaches 0.14 m into the wall across"),
    ):
        room, openings = THICK.room(name), getattr(THICK, kind)
        opening = openings[1] if kind == "windows" else openings[-1]
        for by, found in ((0.0, False), (0.14, True)):
            x = room.box[2] - opening.width + by if at_end else room.x - by
            moved = tuple(replace(each, x=x) if each is opening else each for each in openings)
            lines = check(replace(THICK, **{kind: moved}))
            assert [bool(re.match(words, line)) for line in lines] == [True] * found


@pytest.mark.parametrize(("start", "behind"), [(1.75, False), (1.95, True)])
def test_an_opening_behind_another_room_s_outer_wall_is_found(start: float, behind: bool) -> None:
    """One of two adjacent rooms reaches farther south, with an outer wall from 2.8 m on."""
    room = {"type": "a", "x": 0, "y": 0, "width": 3, "height": 3}
    rooms = [{**room, "name": "A"}, {**room, "name": "B", "x": 3.1, "height": 6}]
    opening, door = {"x": start, "y": 3.05, "width": 1, "height": 0}, {"x": 3.05, "y": 1, "width": 0}
    doors = [{**door, "height": 0.9, "between": ["A", "B"]}]
    record = {"format": "vitruvius-2", "unit": "m", "wall_thickness": {"inner": 0.1, "outer": 0.3}}
    for openings in (
        {"doors": doors, "windows": [{**opening, "room": "A"}]},
        {"doors": [*doors, {**opening, "between": ["A", "outside"]}]},
    ):
        found = check(House.from_dict({**record, "rooms": rooms, **openings}))
        assert [line.endswith("is behind an outer wall of B (a)") for line in found] == [True] * behind


@pytest.mark.parametrize("words", MISTAKES)
def test_each_mistake_has_its_answer(words: str) -> None:
    promises = HOME
    if "9 to 10" in words:
        promises = replace(HOME, room_area={"bathroom": (9.0, 10.0)})
    if "at least 1.3" in words:
        promises = replace(HOME, narrowest={"corridor": 1.3})
    found = check(MISTAKES[words](), promises)
    assert any(re.match(words, line) for line in found), found


def test_a_crowd_has_a_thousand_violations_and_a_line_that_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """The 512 doors in one place make 130,816 pairs."""
    (one, *_), asked = [door for door in FLAT.doors if not door.opening], []
    monkeypatch.setattr(checked, "_between", lambda *_: asked.append(1) or "door")
    said = check(replace(FLAT, doors=(one,) * 512), HOME)
    assert len(said) == 1001
    assert "more than 1,000 violations" in said[-1]
    assert len(asked) < 3000


def test_the_check_compares_openings_and_rooms_by_array_not_pair_by_pair(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In a row of rooms with windows and doors, four times the rooms take four times the reads."""
    read, box = [0], Rect.box.fget
    assert box

    def counted(rect: Rect) -> Any:
        read[0] += 1
        return box(rect)

    monkeypatch.setattr(Rect, "box", property(counted))

    def reads(number: int) -> int:
        rooms = tuple(Room(3.0 * k, 0, 3, 3, name=f"R{k}", type="bedroom") for k in range(number))
        doors = tuple(Door(3.0 * k, 1, 0, 0.9, between=(f"R{k - 1}", f"R{k}")) for k in range(1, number))
        windows = tuple(Window(3.0 * k + 1, 0, 1, 0, room=f"R{k}") for k in range(number))
        read[0] = 0
        house = House(rooms, doors, windows)
        for each in (checked.plan_doors, checked.plan_windows):
            assert list(each(house, Promises())) == []
        return read[0]

    assert reads(64) < 5 * reads(16)
