"""Differences between two houses are found, described and drawn, and nothing else is."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from msgspec.structs import replace

from tests.logic.house.handmade import built, sketches, turned_house
from tests.plans import PLANS
from vitruvius.cli import main
from vitruvius.logic import House, save
from vitruvius.logic.drawing.canvas import Line, flat
from vitruvius.logic.drawing.difference import COLOURS, diff_drawing, diff_svg
from vitruvius.logic.house.diff import changes
from vitruvius.logic.house.part_names import target_in

FLAT = PLANS["flat"]


def with_room(house: House, name: str, **changed: object) -> House:
    """Return the house with one changed room."""
    rooms = tuple(replace(room, **changed) if room.name == name else room for room in house.rooms)
    return replace(house, rooms=rooms)


def edited() -> House:
    """Return the flat with a moved bed and window, a turned wardrobe, a removed toilet and an added bed."""
    bed, wardrobe = FLAT.room("R1").children
    house = with_room(FLAT, "R1", children=(replace(bed, x=bed.x + 0.5), replace(wardrobe, orientation="N")))
    house = with_room(house, "R2", children=FLAT.room("R2").children[1:])
    three = FLAT.room("R3").children
    house = with_room(house, "R3", children=(*three, replace(three[0], y=three[0].y + 2.0)))
    first, *others = house.windows
    moved = replace(first, x=first.x + 0.25) if first.width else replace(first, y=first.y + 0.25)
    return replace(house, windows=(moved, *others))


@pytest.mark.parametrize(
    "house", [*PLANS.values(), built(4.2, 4.2, tuple((sketch,) for sketch in sketches()))]
)
def test_a_house_does_not_differ_from_itself_nor_from_one_whose_rooms_have_other_names(house: House) -> None:
    assert changes(house, house) == []
    assert "nothing differs" in diff_svg(house, house)
    if not house.main_room:
        called = {room.name: f"Q{index}" for index, room in enumerate(reversed(house.rooms))} | {
            "outside": "outside"
        }
        rooms = tuple(replace(room, name=called[room.name]) for room in house.rooms)
        doors = tuple(
            replace(door, between=tuple(called[name] for name in door.between)) for door in house.doors
        )
        windows = tuple(replace(window, room=called[window.room]) for window in house.windows)
        assert changes(house, House(rooms, doors, windows, called.get(house.hub, ""), house.topology)) == []


def test_what_came_went_and_moved_is_named_as_explain_takes_it() -> None:
    after, window = edited(), f"{FLAT.windows[0].room}.window"
    found = changes(FLAT, after)
    whole = {(each.what, now.name) for each in found if (now := each.after or each.before)}
    assert whole == {
        ("moved", "R1.bed"),
        ("moved", "R1.wardrobe"),
        ("went", "R2.toilet"),
        ("came", "R3.bed2"),
        ("moved", window),
    }
    for change in found:
        for house, item in ((FLAT, change.before), (after, change.after)):
            if item:
                target_in(house, item.name)
    said = {str(change) for change in found}
    assert {
        "R1.bed moved 0.50 m east",
        "R1.wardrobe faces N, faced E",
        "R2.toilet went",
        "R3.bed2 came",
    } < said


def test_the_other_way_round_came_is_went() -> None:
    other = {"came": "went", "went": "came", "moved": "moved"}
    there, back = changes(FLAT, edited()), changes(edited(), FLAT)
    assert {(other[each.what], each.after, each.before) for each in there} == {
        (each.what, each.before, each.after) for each in back
    }


def test_a_room_of_another_size_says_both() -> None:
    hall = FLAT.room("R4")
    after = with_room(FLAT, "R4", width=hall.width + 1.0)
    assert [str(change) for change in changes(FLAT, after)] == [
        f"R4 (hall) is {hall.width + 1:.2f} x {hall.height:.2f} m, "
        f"was {hall.width:.2f} x {hall.height:.2f} m, moved 0.50 m east"
    ]


def test_a_house_turned_by_half_has_other_places_for_all_and_still_all_of_its_rooms() -> None:
    house = built(4.2, 4.2, tuple((sketch,) for sketch in sketches()))
    found = changes(house, turned_house(house, 2))
    rooms = [each for each in found if each.after and "." not in each.after.name]
    assert [each.what for each in rooms] == ["moved"] * len(rooms)
    assert len(rooms) >= 4


def test_each_change_is_drawn_in_its_place_with_its_line() -> None:
    after = edited()
    found = changes(FLAT, after)
    drawing = diff_drawing(FLAT, after, found)
    lines = [shape for shape in flat(drawing.shapes) if isinstance(shape, Line)]
    for what, colour in COLOURS.items():
        frames = [
            line
            for line in lines
            if line.stroke == colour and len(line.points) == 5 and line.points[0] == line.points[4]
        ]
        frames = frames[:-1]  # without the frame of the key
        count = sum(each.what == what for each in found)
        assert sum(bool(line.dash) for line in frames) == count * (what != "came")
        assert sum(not line.dash for line in frames) == count * (what != "went")


def test_the_command_draws_and_says_each_pair(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save([FLAT, FLAT], tmp_path / "a.jsonl")
    save([edited(), FLAT], tmp_path / "b.jsonl")

    def run(*options: str) -> int | str | None:
        with pytest.raises(SystemExit) as end:
            main(["draw", str(tmp_path / "a.jsonl"), "--out", str(tmp_path / "out"), *options])
        return end.value.code

    assert run("--diff", str(tmp_path / "b.jsonl")) == 0
    assert "house 0: R1.bed moved 0.50 m east" in capsys.readouterr().out
    assert [path.name for path in sorted((tmp_path / "out").iterdir())] == ["diff-0.svg", "diff-1.svg"]
    ET.parse(tmp_path / "out/diff-0.svg")
    assert run("--diff", str(tmp_path / "b.jsonl"), "--json", "--format", "png") == 0
    answer = json.loads(capsys.readouterr().out)["answer"]
    assert answer["files"] == [str(tmp_path / f"out/diff-{house}.png") for house in range(2)]
    first, second = answer["differences"]
    assert (first["house"], len(first["changes"]), second["changes"]) == (0, 5, [])
    save([FLAT], tmp_path / "c.jsonl")
    assert run("--diff", str(tmp_path / "c.jsonl")) == 2
    assert "has 2 houses" in capsys.readouterr().err
