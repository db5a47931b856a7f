"""Commands and files of pages, written and run; all other commands, parsed."""

import re
import shlex
from codeop import CommandCompiler
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.agent.evaluation.cases import short_episodes
from tests.docs.reader import ROOT, Block, Reader, blocks, commands, pictures
from vitruvius.cli import parse
from vitruvius.logic import House, load

pytestmark = pytest.mark.second_part("all commands of pages are run, and the site is opened in a browser")

DOCS = ROOT / "docs"
PAGES = [*sorted((DOCS / "tutorials").glob("*.md")), DOCS / "gallery.md", DOCS / "plans.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_can_be_followed_and_shows_the_pictures_that_come_out(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)  # in a worker, pytest-benchmark times nothing
    with short_episodes():
        Reader(tmp_path, monkeypatch).follow(page)
    for file, picture in pictures(page).items():
        same = file.read_bytes() == picture.read_bytes()
        assert same, f"{picture.name} is another: ./run python -m tests.docs.reader draws all pictures again"
    CLAIMS.get(page.stem, lambda: None)()


@pytest.mark.parametrize("page", PAGES[:-2], ids=lambda page: page.stem)
def test_a_tutorial_says_where_its_python_runs_and_a_session_takes_each_block_as_it_stands(
    page: Path,
) -> None:
    text = page.read_text()
    for block in blocks(text):
        if block.language == "python":
            assert "`./run python" in text.split("\n\n")[1], "in the first paragraph"
            assert block.file or is_taken(block.text), block.line


def is_taken(text: str) -> bool:
    """Return True if a Python session takes these lines one by one: a blank line ends what is indented."""
    compiled, waiting = CommandCompiler(), list[str]()
    try:
        for line in [*text.splitlines(), ""]:
            waiting.append(line)
            if compiled("\n".join(waiting), symbol="single"):
                waiting.clear()
    except SyntaxError:
        return False
    return not any(waiting)


def test_each_entry_of_the_changelog_is_an_item_of_a_list() -> None:
    lines = (ROOT / "CHANGELOG.md").read_text().splitlines()
    assert [line for line in lines if line and not re.match("#+ |- |  ", line)] == []
    titles = re.findall("^### (.*)", "\n".join(lines), re.MULTILINE)
    assert {*titles} <= {"Added", "Changed", "Fixed", "Removed"}


ELSEWHERE = {
    "demo",
    "test",
    "site",
    "play",
    "info",
    "report",
    "watch",
    "playground",
    "train",
    "evaluate",
    "bench",
}
"""Commands of these pages that take minutes or a window: other tests run them, and the tutorials on a small
scale."""


def test_the_first_page_can_be_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reader = Reader(tmp_path, monkeypatch)
    sh, python, _ = blocks((ROOT / "README.md").read_text())
    install, *ours, demo = commands(sh.text)
    assert (install.split()[:2], demo) == (["pip", "install"], "./run demo")
    for line in ours:
        code, said = reader.run(line.replace("vitruvius", "./run", 1))
        assert not code, said
    assert reader.matches(python.shown or "", reader.do(python)[1])


def test_the_first_page_is_short_and_its_results_are_those_of_the_page_of_results() -> None:
    text = (ROOT / "README.md").read_text()
    assert len(text.splitlines()) <= 110
    first, all_of_them = rows(text, "| agent |"), rows((DOCS / "results.md").read_text(), "| agent or")
    assert len(first) <= 6
    for agent, (knows, *ratios) in first.items():
        assert [knows, *ratios] == [cell.partition(" [")[0] for cell in all_of_them[agent]]


def rows(text: str, head: str) -> dict[str, list[str]]:
    """Return the rows of the table with this head, by their first cells."""
    _, _, *lines = text[text.index(head) :].partition("\n\n")[0].splitlines()
    cells = ([cell.strip() for cell in line.split("|")[1:-1]] for line in lines)
    return {first: others for first, *others in cells}


def test_the_page_of_use_can_be_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With fewer houses. ``test_libraries`` has its simulator, ``test_examples`` its layer of behaviour."""
    reader = Reader(tmp_path, monkeypatch)
    use, rules = (section(DOCS / "use.md", title) for title in ("## Commands", "## Your own rules"))
    for block in use:
        for line in commands(block.text) if block.language == "sh" else ():
            for command in line.replace("--count 100", "--count 2").split(" && "):
                if command.split()[1] not in ELSEWHERE:
                    code, said = reader.run(command)
                    assert not code, f"{command}: {said}"
        if block.language == "python":
            reader.python(block.text)
    shown = [block for block in rules if block.shown]
    assert [reader.matches(block.shown or "", reader.do(block)[1]) for block in shown] == [True]


def section(page: Path, title: str) -> list[Block]:
    """Return the blocks of one section of a page."""
    (text,) = re.findall(rf"^{title}\n(.*?)(?=^## |\Z)", page.read_text(), re.DOTALL | re.MULTILINE)
    return [*blocks(text)]


COMMAND = re.compile(r"^(?: {4}|[$] )?(?:\./run|vitruvius) (?!python |test|docs)(.*)$", re.MULTILINE)


@pytest.mark.parametrize("page", [*sorted(DOCS.glob("*.md")), ROOT / "README.md"], ids=lambda page: page.stem)
def test_every_command_of_a_page_is_one_that_the_command_line_takes(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Some are long studies or open windows, so they are parsed and not run."""
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").touch()  # settings, which are read at once
    for command in COMMAND.findall(page.read_text().replace("\\\n", " ")):
        for part in command.partition("#")[0].split(" && "):
            words = shlex.split(part.removeprefix("./run ").split(" | ")[0].split(" > ")[0])
            if words and not {*words} & {"...", "FILE", "GRAMMAR", "COMMAND"}:
                parse(words)


def entered_from(house: House, type_: str) -> set[str]:
    """Return the types of the rooms to which rooms of this type have doors."""
    doors = [door.between for room in house.rooms if room.type == type_ for door in house.doors_of(room.name)]
    names = {name for between in doors for name in between}
    return {room.type for room in house.rooms if room.name in names} - {type_}


def the_room_type_opens_off_the_corridor() -> None:
    houses = load("utility.jsonl")
    assert [entered_from(house, "utility") for house in houses] == [{"corridor"}] * 4
    assert "washingMachine" in {
        piece.type for house in houses for room in house.rooms for piece in room.pieces
    }


def the_topology_of_ten_lines_has_rooms_on_both_sides_of_a_corridor() -> None:
    assert len(Path("mine/rows.lp").read_text().splitlines()) - len(["its name", "#program house."]) == 9
    for house in load("rows.jsonl"):
        corridor, *others = house.rooms
        assert (house.topology, corridor.type, len(others)) == ("rows", "corridor", 7)
        assert corridor.width == pytest.approx(max(room.x + room.width for room in others))
        north = [room for room in others if room.y + room.height == pytest.approx(corridor.y)]
        south = [room for room in others if room.y == pytest.approx(corridor.y + corridor.height)]
        assert north
        assert south
        assert len(north) + len(south) == 7


def the_building_is_entered_from_the_west() -> None:
    (house,) = load("flats.jsonl")
    entrances = [door for door in house.doors if door.is_entrance]
    assert house.main.x in [door.x for door in entrances if not door.width]
    assert any(room.type == "dining" for room in house.rooms)


CLAIMS: dict[str, Callable[[], None]] = {
    "room-type": the_room_type_opens_off_the_corridor,
    "topology": the_topology_of_ten_lines_has_rooms_on_both_sides_of_a_corridor,
    "plans": the_building_is_entered_from_the_west,
}
"""Claims about a page's files, by its name."""
