"""A grammar's lengths that pass lint hold in its houses, by plain geometry."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from clingo import Function, Number

from tests.logic.workers.in_process import builder, generate
from vitruvius.logic import House, LimitReached, Unsatisfiable, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.language.loaded import LoadedGrammar
from vitruvius.logic.layout.account import BY_AREA, REMEDIES
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.house_request import HouseRequest

KITCHEN = "room_size(kitchen,  W, D) :- { W >= 2.0, W =< 4.2, D >= 2.0, D =< 4.2 }."
AREA = "room_area(kitchen,   6.0, 16.0)."
WINDOW = "window_size(_, L, Wall) :- { L >= 0.6, L >= 0.7*Wall - 1.0, L =< 0.8*Wall }."

TWO_ROOMS = """
topology(dissection).  type(hall;bath).  empty(hall;bath).  central(hall).
opens(outside,hall).   opens(hall,bath).
#program house.
:- not room(_,bath).
"""
TWO_SIZES = """
room_size(hall, W, D) :- {{ W + D = 6, W >= 1, D >= 1 }}.
room_size(bath, W, D) :- {{ W + D = 9, W >= 1, D >= 1 }}.
house_area({}, 29).
door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).
"""


def edited(folder: Path, edits: dict[str, str], grammar: str = "home") -> Path:
    """Write a copy of a shipped grammar with other clauses in its sizes."""
    shutil.copytree(SHIPPED / grammar, folder)
    for old, new in edits.items():
        (file,) = (each for each in folder.glob("*.pl") if old in each.read_text())
        text = file.read_text()
        assert text.count(old) == 1
        file.write_text(text.replace(old, new))
    return folder


def sides(house: House, type_: str) -> list[tuple[float, float]]:
    """Return the shorter and the longer side of each room of a type."""
    return [
        (min(room.width, room.height), max(room.width, room.height))
        for room in house.rooms
        if room.type == type_
    ]


def lengths(house: House, type_: str) -> list[tuple[float, float]]:
    """Return the length of each window of rooms of a type, and of its wall."""
    rooms = {room.name: room for room in house.rooms}
    found = []
    for window in house.windows:
        room = rooms[window.room]
        if room.type == type_:
            found.append((max(window.width, window.height), room.width if window.width else room.height))
    return found


def area(least: float, most: float) -> Callable[[House], bool]:
    return lambda house: all(least - 1e-6 <= a * b <= most + 1e-6 for a, b in sides(house, "kitchen"))


HOLDS: dict[str, tuple[dict[str, str], Callable[[House], bool]]] = {
    "near the most that the size allows": ({AREA: "room_area(kitchen, 16.5, 30.0)."}, area(16.5, 17.64)),
    "near the least": (
        {AREA: "room_area(kitchen, 0.5, 6.1).", KITCHEN: KITCHEN.replace("2.0", "2.3")},
        area(5.29, 6.1),
    ),
    "a thin band": ({AREA: "room_area(kitchen, 9.0, 9.05)."}, area(9.0, 9.05)),
    "one area": ({AREA: "room_area(kitchen, 9.0, 9.0)."}, area(9.0, 9.0)),
    "square rooms": (
        {
            AREA: "room_area(kitchen, 8.0, 8.5).",
            KITCHEN: "room_size(kitchen, W, D) :- { W >= 2.0, W =< 4.2, D = W }.",
        },
        lambda house: all(8 <= a * b <= 8.5 and abs(a - b) < 1e-6 for a, b in sides(house, "kitchen")),
    ),
    "one width": (
        {
            AREA: "room_area(kitchen, 8.0, 8.5).",
            KITCHEN: "room_size(kitchen, W, D) :- { W = 2.5, D >= 2.0, D =< 6.0 }.",
        },
        lambda house: all(
            8 - 1e-6 <= a * b <= 8.5 + 1e-6 and abs(a - 2.5) < 1e-6 for a, b in sides(house, "kitchen")
        ),
    ),
    "an area by a rule for two types": (
        {
            AREA: "room_area(T, L, M) :- member(T-L-M, [kitchen-10.0-10.5]).",
            "room_area(living,   15.0, 30.0).": "",
        },
        area(10.0, 10.5),
    ),
    "windows in walls of one length": (
        {WINDOW: "window_size(_, L, Wall) :- { L >= 0.6, L =< 0.6*Wall, Wall =< 4.0 }."},
        lambda house: all(
            0.6 - 1e-6 <= a <= 0.6 * w + 1e-6 and w <= 4 + 1e-6 for a, w in lengths(house, "living")
        ),
    ),
}


TOTALS: dict[str, tuple[str, str, dict[str, Any], tuple[float, float]]] = {
    "a band": ("home", "", {"rooms": 6}, (60.0, 61.0)),
    "one area": ("home", "", {"rooms": 4}, (40.0, 40.0)),
    "near the least": ("home", "", {"rooms": 4}, (20.0, 34.0)),
    "near the most": ("home", "", {"rooms": 4}, (64.0, 66.0)),
    "a dissection": ("home", "dissection", {"rooms": 5}, (50.0, 51.0)),
    "rooms along a corridor": ("clinic", "", {"rooms": 9}, (250.0, 255.0)),
    "on a grid": ("home", "", {"rooms": 4, "cell": 0.5}, (40.0, 42.0)),
    "a star": ("family", "", {"rooms": 5}, (130.0, 131.0)),
    "one area of a star": ("family", "", {"rooms": 3}, (60.0, 60.0)),
    "near the least of a star": ("family", "", {"rooms": 4}, (20.0, 43.0)),
    "near the most of a star": ("family", "", {"rooms": 1}, (73.5, 90.0)),
    "a star on a grid": ("family", "", {"rooms": 4, "cell": 0.5}, (60.0, 64.0)),
}


@pytest.mark.parametrize("title", TOTALS)
def test_the_area_of_a_house_holds_in_what_is_made(title: str, tmp_path: Path) -> None:
    """The houses are rectangles, rectangles without corners or with niches, and stars."""
    grammar, topology, request, (least, most) = TOTALS[title]
    folder = edited(tmp_path / "mine", {}, grammar)
    (folder / "area.pl").write_text(f"house_area({least}, {most}).")
    if topology:
        rooms = folder / "rooms.lp"
        rooms.write_text(rooms.read_text().replace("topology(ring)", f"topology({topology})"))
    for house in generate(**request, grammar=folder, count=2):
        corners = [(room.x, room.y, room.x + room.width, room.y + room.height) for room in house.rooms]
        assert least - 1e-6 <= sum((x2 - x1) * (y2 - y1) for x1, y1, x2, y2 in corners) <= most + 1e-6
        assert check(house) == []
        narrow = msgspec.structs.replace(Promises(), house_area=(least / 2, least - 1))
        assert any(line.startswith("house: is of ") for line in check(house, narrow))


def test_the_area_of_a_star_holds_around_fixed_rooms(tmp_path: Path) -> None:
    folder = edited(tmp_path / "mine", {}, "family")
    (kept,) = generate(2, grammar=folder, count=1)
    whole = sum(room.area for room in kept.rooms)
    for least in (whole + 20, whole + 60):
        (folder / "area.pl").write_text(f"house_area({least}, {least + 2}).")
        (house,) = generate(3, grammar=folder, keep=kept.only("R0"), count=1)
        assert kept.star.rooms[0] in house.star.rooms
        assert least - 1e-6 <= sum(room.width * room.height for room in house.rooms) <= least + 2 + 1e-6
        assert check(house) == []


def test_no_star_that_is_made_is_refuted_by_its_area(tmp_path: Path) -> None:
    """Facts about areas in stage 1, and in stage 2 before there is furniture, exclude no such house."""
    folder = edited(tmp_path / "mine", {}, "family")
    for rooms in (1, 2, 4, 7):
        free = builder("family")
        house, layout = free.house(HouseRequest(rooms), 1, rooms), free.origin
        atoms = [Function("room", [Number(each.number), each.type]) for each in layout.rooms]
        atoms += [Function("side", [Number(each.number), each.side]) for each in layout.rooms]
        whole = sum(room.area for room in house.rooms)
        (folder / "area.pl").write_text(f"house_area({whole}, {whole}).")
        tight = Builder(find(folder))
        program, _ = tight.programs.rooms_for(HouseRequest(rooms))
        assert program.possible([*atoms, *layout.corners])
        assert tight.placer.area_conflict(layout, (), sorted(tight.loaded.furniture)) is None


@pytest.mark.parametrize(
    ("rooms", "area", "others"),
    [(4, (30.0, 40.0), 3), (1, (115.0, 125.0), 2)],
    ids=["too small for the rooms", "too large for them"],
)
def test_a_star_that_its_area_does_not_allow_is_proved_impossible_by_that_line(
    rooms: int, area: tuple[float, float], others: int, tmp_path: Path
) -> None:
    folder = edited(tmp_path / "mine", {}, "family")
    (folder / "area.pl").write_text(f"house_area({area[0]}, {area[1]}).")
    with pytest.raises(Unsatisfiable) as error:
        next(generate(rooms, grammar=folder))
    assert f"area.pl:1:1: house_area({area[0]}, {area[1]})." in str(error.value)
    assert f"There may be a house with --rooms {others}." in str(error.value)
    (other,) = generate(others, grammar=folder, count=1)
    assert area[0] <= sum(room.width * room.height for room in other.rooms) <= area[1]


def test_a_limit_names_the_area_of_a_star_that_is_nearly_too_small(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vitruvius.logic.generation.star.MOST_MISFITS", 3)
    monkeypatch.setattr("vitruvius.logic.generation.star.MOST_AREAS", 3)
    folder = edited(tmp_path / "mine", {}, "family")
    (folder / "area.pl").write_text("house_area(40.0, 41.0).")
    made = Builder(find(folder))
    with pytest.raises(LimitReached) as error:
        made.house(HouseRequest(4), 0, 0)
    first, *_ = str(error.value).partition("Most were refuted by\n")[2].split("\n")
    assert first.endswith("area.pl:1:1: house_area(40.0, 41.0).")
    for stage in REMEDIES:
        made.account.begin()
        made.account.at(stage, "a house")
        assert ("house_area/2" in str(made.account)) == (stage in BY_AREA)


def test_a_house_that_its_area_does_not_allow_is_proved_impossible_by_that_line(tmp_path: Path) -> None:
    folder = edited(tmp_path / "mine", {})
    (folder / "area.pl").write_text("house_area(20.0, 35.0).")
    with pytest.raises(Unsatisfiable) as error:
        next(generate(6, grammar=folder))
    assert "area.pl:1:1: house_area(20.0, 35.0)." in str(error.value)
    assert "There is a house with --rooms 4." in str(error.value)


def test_an_area_that_each_room_reaches_but_not_both_is_proved_impossible(tmp_path: Path) -> None:
    """L (6 - L) is at most 9, L (9 - L) at most 20.25, and their sum at most 28.125, with L = 3.75."""
    (tmp_path / "rooms.lp").write_text(TWO_ROOMS)
    for least, possible in ((28.1, True), (28.2, False)):
        (tmp_path / "sizes.pl").write_text(TWO_SIZES.format(least))
        if possible:
            (house,) = generate(2, grammar=tmp_path, count=1)
            assert sum(room.area for room in house.rooms) >= least - 1e-6
        else:
            with pytest.raises(Unsatisfiable, match=r"house_area\(28.2, 29\)"):
                next(generate(2, grammar=tmp_path))


def test_the_area_of_a_plan_that_is_given_is_judged(tmp_path: Path) -> None:
    folder = edited(tmp_path / "mine", {})
    (house,) = generate(4, grammar=folder, count=1)
    whole = sum(room.area for room in house.rooms)
    for least, possible in ((whole - 1, True), (whole + 1, False)):
        (folder / "area.pl").write_text(f"house_area({least}, {whole + 5}).")
        made, plan = Builder(find(folder)), HouseRequest(4, plan=read_plan(house))
        if possible:
            assert made.house(plan, 0, 0)
        else:
            with pytest.raises(Unsatisfiable, match=r"area.pl:1:1: house_area"):
                house_or_proof(made, plan, 0, 0)


@pytest.mark.second_part("every length of every grammar")
@pytest.mark.parametrize("title", HOLDS)
def test_a_length_that_lint_lets_through_holds_in_what_is_made(title: str, tmp_path: Path) -> None:
    edits, holds = HOLDS[title]
    folder = edited(tmp_path / "mine", edits)
    for house in generate(4, grammar=folder, count=2):
        assert holds(house), [room.box for room in house.rooms]


def test_a_clause_of_a_piece_that_holds_at_no_wall_is_an_error(tmp_path: Path) -> None:
    folder = edited(tmp_path / "mine", {})
    file = folder / "furniture.pl"
    lines = file.read_text().splitlines()
    more = "piece_size(sofa, L, D, Wall) :- { Wall >= 90, L >= 1.5, L =< 2, D >= 0.8, D =< 1 }."
    file.write_text("\n".join([*lines, more, ""]))
    (error,) = LoadedGrammar(find(folder)).errors
    assert error.line == len(lines) + 1
    assert "no wall satisfies this clause: walls of rooms are 0.9 to 9.0 m long" in error.message
