"""What docs/plans.md tells its reader to write and to run, written and run."""

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from agent.cli import main
from logic import House, load
from logic.grammar import SHIPPED

PAGE = Path(__file__).parents[2] / "docs" / "plans.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def run(command: str, folder: Path) -> int:
    """Run a line of the page; the exit code. Ours runs in this process."""
    program, *words = command.split()
    if program != "./run":
        return subprocess.run(command, shell=True, cwd=folder, check=False).returncode
    try:
        main(words)
    except SystemExit as done:
        return int(done.code or 0)
    return 0


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder where all of the page was followed."""
    folder = tmp_path_factory.mktemp("reader")
    for name in ("home", "apartments"):
        shutil.copytree(SHIPPED / name, folder / "logic" / "grammars" / name)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for language, text in BLOCK.findall(PAGE.read_text()):
            if language == "sh":
                assert [line for line in text.splitlines() if run(line, folder)] == []
            else:
                (folder / text.split()[1]).write_text(text)
        yield folder


def entered_from(house: House, type_: str) -> set[str]:
    """The types of the rooms that those of this type have doors to."""
    doors = [door.between for room in house.rooms if room.type == type_ for door in house.doors_of(room.name)]
    names = {name for between in doors for name in between}
    return {room.type for room in house.rooms if room.name in names} - {type_}


def test_a_room_type_that_the_page_adds_opens_off_the_corridor(reader: Path) -> None:
    houses = list(load(reader / "utility.jsonl"))
    assert len(houses) == 4
    assert all(entered_from(house, "utility") == {"corridor"} for house in houses)
    pieces = [piece.type for house in houses for room in house.rooms for piece in room.pieces]
    assert "washingMachine" in pieces


def test_the_topology_that_the_page_adds_has_rooms_on_both_sides_of_a_corridor(reader: Path) -> None:
    for house in load(reader / "corridor.jsonl"):
        corridor, *others = house.rooms
        assert (house.topology, corridor.type, len(others)) == ("corridor", "corridor", 7)
        assert corridor.width == pytest.approx(max(room.x + room.width for room in others))
        north = [room for room in others if room.y + room.height == pytest.approx(corridor.y)]
        south = [room for room in others if room.y == pytest.approx(corridor.y + corridor.height)]
        assert north
        assert south
        assert len(north) + len(south) == 7


def test_the_building_of_the_page_is_entered_from_the_west(reader: Path) -> None:
    (house,) = load(reader / "flats.jsonl")
    entrances = [door for door in house.doors if door.is_entrance]
    assert house.main.x in [door.x for door in entrances if not door.width]
    assert any(room.type == "dining" for room in house.rooms)


def test_the_page_says_how_long_the_topology_is() -> None:
    (rules,) = [text for _, text in BLOCK.findall(PAGE.read_text()) if "mine/corridor.lp" in text]
    assert "in ten lines" in PAGE.read_text()
    assert len(rules.splitlines()) - len(["its name", "#program house."]) == 10
