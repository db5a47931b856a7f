"""The shipped grammars: their houses keep their promises, and every rule has an effect."""

import os
import re
import shutil
import tracemalloc
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from clingo.ast import ASTType, parse_files

from tests import architect
from tests.logic.workers import in_process
from vitruvius.logic import GrammarError, House, VitruviusError, check
from vitruvius.logic.grammar import SHIPPED, find, shipped
from vitruvius.logic.house.promises import Promises

BASE = SHIPPED / "family"


ROOMS = {
    "clinic": (1, 2, 3, 5, 9, 16, 32),
    "apartments": (6, 12, 24),
    "plain": (1, 3, 6, 9),
}
"""Numbers of rooms of the houses of grammars that differ from the usual ones."""


@pytest.mark.second_part("all grammars at all sizes")
@pytest.mark.parametrize(
    ("grammar", "rooms"),
    [
        (name, rooms)
        for name in shipped()
        for rooms in ROOMS.get(name, (1, 2, 3, 4, 6, 9, 16))
        if name not in ("family", "home")
    ],
)
def test_houses_of_every_grammar_keep_every_promise(grammar: str, rooms: int) -> None:
    """For family see test_generate.py, for home test_shared_walls.py.

    Plans are also plausible for an architect, except those of plain.
    """
    for house in in_process.generate(rooms, grammar=grammar, seed=rooms, count=2):
        assert check(house) == []
        assert len(house.counted) == rooms
        assert house.main_room or grammar == "plain" or list(architect.faults(house)) == []


@pytest.mark.parametrize("name", ["rooms.lp", "sizes.pl"])
def test_little_is_read_of_a_rule_file_of_many_gigabytes(tmp_path: Path, name: str) -> None:
    folder = Path(shutil.copytree(BASE, tmp_path / "mine"))
    os.truncate(folder / name, 5 << 30)  # of zeros, which take no disk
    tracemalloc.start()
    try:
        with pytest.raises(GrammarError, match="holds more than 16 MiB: it is not read") as caught:
            find(folder)
        assert tracemalloc.get_traced_memory()[1] < 64 << 20
    finally:
        tracemalloc.stop()
    assert caught.value.file == folder / name


def test_a_grammar_may_name_the_star_that_it_is_without_a_name(tmp_path: Path) -> None:
    folder = Path(shutil.copytree(BASE, tmp_path / "mine"))
    rooms = folder / "rooms.lp"
    rooms.write_text("topology(star).\n" + rooms.read_text())
    made = [next(iter(in_process.generate(3, grammar=grammar, seed=1))) for grammar in (folder, "family")]
    assert made[0].rooms == made[1].rooms


def test_the_clinic_grammar_has_room_types_that_family_lacks() -> None:
    family, clinic = (
        {room.type for house in in_process.generate(12, grammar=name, count=5) for room in house.counted}
        for name in ("family", "clinic")
    )
    assert len(clinic) >= 6
    assert not clinic & family


def test_nothing_stands_in_front_of_a_piece_whose_front_a_grammar_states_to_be_clear(tmp_path: Path) -> None:
    """Without the statement a piece sooner or later stands there, such as one in a corner with another."""
    kinds = "bed", "wardrobe", "toilet", "shower", "sink", "desk", "sofa", "cupboard"
    promises = Promises(clear_front=tuple(kinds))
    clear = Path(shutil.copytree(BASE, tmp_path / "clear"))
    (clear / "clear.lp").write_text(f"clear_front({'; '.join(kinds)}).")
    text = (clear / "arrangement.lp").read_text()
    for own in (":- turned(bed,K,near), touched(bed,K,far).", ":- turned(bed,K,far), touched(bed,K,near)."):
        assert own in text
        text = text.replace(own, "")  # The rule states the same of beds.
    (clear / "arrangement.lp").write_text(text)

    def obstructed(grammar: str | Path) -> int:
        made = in_process.generate(rooms=12, seed=3, count=6, grammar=grammar)
        return sum(any(" in front of it" in line for line in check(house, promises)) for house in made)

    assert obstructed(clear) == 0 < obstructed("family")


@pytest.mark.parametrize("cell", [0.0, 0.3])
def test_who_goes_with_a_piece_at_a_wall_is_in_front_of_it(tmp_path: Path, cell: float) -> None:
    mine = Path(shutil.copytree(BASE, tmp_path / "mine"))
    (mine / "seats.lp").write_text("around(cupboard,chair,0,1).  around(desk,chair,1,1).")
    seats: dict[str, set[int]] = {"cupboard": set(), "desk": set()}
    for house in in_process.generate(8, grammar=mine, cell=cell, count=8):
        assert check(house) == []
        for piece in (each for room in house.rooms for each in room.children if each.type in seats):
            seats[piece.type].add(len(piece.children))
            assert cell or all(architect.in_front(piece, each) for each in piece.children)
    assert seats == {"cupboard": {0, 1}, "desk": {1}}


# Rule by rule: without the rule, the independent check finds violations.


def constraints() -> Iterator[tuple[str, int, int, str]]:
    """Yield each constraint of the family's .lp files: file, start and end in the text, and replacement."""
    for file in sorted(BASE.glob("*.lp")):
        text = file.read_text()
        starts = [0, *(match.end() for match in re.finditer("\n", text))]
        found: list[Any] = []
        parse_files([str(file)], found.append)
        for statement in found:
            if statement.ast_type == ASTType.Rule and str(statement.head) == "#false":
                if text.split("\n")[statement.location.begin.line - 2].startswith("% Redundant"):
                    continue
                begin, end = statement.location.begin, statement.location.end
                first, last = starts[begin.line - 1] + begin.column - 1, starts[end.line - 1] + end.column - 1
                yield file.name, first, last, ""


def bounds() -> Iterator[tuple[str, int, int, str]]:
    """Yield each bound of the family's sizes moved by a quarter, and each named length cut to a tenth."""
    text = (BASE / "sizes.pl").read_text()
    for bound in re.finditer(r"([WLD]) (>=|=<) +([\d.]+)(\*Wall)?", text):
        factor = 0.75 if bound[2] == ">=" else 1.25
        yield "sizes.pl", bound.start(3), bound.end(3), f"{float(bound[3]) * factor:.4f}"
    for length in re.finditer(r"^(?:door_width|door_clearance|passage|room_gap)\(([\d.]+)\)", text, re.M):
        yield "sizes.pl", length.start(1), length.end(1), f"{float(length[1]) / 10:.4f}"


def counts() -> Iterator[tuple[str, int, int, str]]:
    """Yield the upper counts of the family's furniture, each plus one, except those of desks.

    A wall has one desk.
    """
    text = (BASE / "furniture.lp").read_text()
    for count in re.finditer(r"may\(\w+,(?!desk)\w+,\d,(\d)\)", text):
        yield "furniture.lp", count.start(1), count.end(1), str(int(count[1]) + 1)


MUTANTS = [*constraints(), *bounds(), *counts()]


def mutated(mutant: tuple[str, int, int, str], folder: Path) -> Path:
    file, first, last, new = mutant
    shutil.copytree(BASE, folder)
    text = (folder / file).read_text()
    (folder / file).write_text(text[:first] + new + text[last:])
    return folder


def named(mutant: tuple[str, int, int, str]) -> str:
    file, first, last, new = mutant
    text = (BASE / file).read_text()
    line = text.count("\n", 0, first) + 1
    return f"{file}:{line}:{' '.join(text[first:last].split())[:30]}->{new}"


@pytest.mark.second_part("a grammar without each of its rules")
@pytest.mark.parametrize("mutant", MUTANTS, ids=named)
def test_every_rule_of_the_family_grammar_matters(mutant: tuple[str, int, int, str], tmp_path: Path) -> None:
    """With a change in one place, the grammar generates houses that break family's promises."""
    folder = mutated(mutant, tmp_path / "family")
    for house in sample(folder):
        if check(house, family()):
            return
    pytest.fail("no house of the sample breaks a promise: the rule is dead, or nothing is promised of it")


@cache
def family() -> Promises:
    """Return the promises of the shipped grammar."""
    [house] = in_process.generate(4)
    assert house.provenance
    assert house.provenance.promises
    return house.provenance.promises


def sample(grammar: Path) -> Iterator[House]:
    """Yield houses with much furniture, many rooms, and few rooms, until the check finds a violation."""
    for rooms, seed, furniture in ((4, 3, {"bed": 2}), (24, 4, {}), (2, 0, {})):
        try:
            yield from in_process.generate(rooms, seed=seed, count=15, grammar=grammar, furniture=furniture)
        except VitruviusError as error:
            if "no house" not in str(error):
                raise
