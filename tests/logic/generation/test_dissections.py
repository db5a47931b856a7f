"""Dissections of a grammar: large ones, and voids that the grammar states, which are courts and notches."""

import shutil
import time
from pathlib import Path
from typing import Any

import pytest
import shapely

from tests.logic.workers.in_process import generate
from vitruvius.logic import GrammarError, check
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import find
from vitruvius.logic.house.house import House
from vitruvius.logic.request.house_request import HouseRequest

DISSECTION = Path(__file__).parents[3] / "examples" / "dissection"

SIZE = "room_size(void, W, D) :- { W >= 2, W =< 4, D >= 2, D =< 4 }.\n"


def stated(folder: Path, rules: str, lengths: str = "") -> Path:
    """Return the grammar of homes in any plan, with more rules about a house and more lengths."""
    grammar = folder / "grammar"
    shutil.copytree(DISSECTION, grammar)
    for name, text in (("rooms.lp", rules), ("lengths.pl", lengths)):
        with open(grammar / name, "a", encoding="utf-8") as file:
            file.write(f"\n{text}\n")
    return grammar


def floor_of(house: House) -> Any:
    """Return all rooms of a house as one polygon."""
    return shapely.union_all([shapely.box(*room.box).buffer(1e-6) for room in house.rooms])


@pytest.mark.second_part("large plans")
@pytest.mark.parametrize(
    ("where", "holes"),
    [(":- edge(rooms,_,outline(_)).", 1), (":- not edge(rooms,north,outline(_)).", 0)],
    ids=["a court", "a notch"],
)
def test_a_void_is_free_where_the_rules_say_and_as_large_as_they_say(
    where: str, holes: int, tmp_path: Path
) -> None:
    [house] = generate(6, grammar=stated(tmp_path, f"void(rooms). {where}", SIZE))
    assert check(house) == []
    floor = floor_of(house)
    void = shapely.box(*floor.bounds).difference(floor).buffer(-1e-5)
    west, north, east, south = void.bounds
    assert void.area == pytest.approx((east - west) * (south - north))
    assert 2 - 1e-3 < min(east - west, south - north) <= max(east - west, south - north) < 4 + 1e-3
    assert len(floor.interiors) == holes


def test_a_void_with_the_number_of_a_room_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(GrammarError, match="the numbers of voids follow"):
        next(generate(6, grammar=stated(tmp_path, "void(0).")))


def test_a_ring_has_no_voids(tmp_path: Path) -> None:
    grammar = stated(tmp_path, "void(rooms).")
    rooms = grammar / "rooms.lp"
    rooms.write_text(rooms.read_text().replace("topology(dissection)", "topology(ring)"))
    with pytest.raises(GrammarError, match="only a dissection has voids"):
        next(generate(6, grammar=grammar))


@pytest.mark.second_part("large plans")
def test_a_dissection_of_twelve_rooms_is_soon_found_and_the_same_whatever_was_made_before() -> None:
    builder = Builder(find(DISSECTION))
    begin = time.process_time()
    first, _, again = (builder.house(HouseRequest(12), 1, index) for index in (0, 1, 0))
    assert time.process_time() - begin < 3 * 4  # seconds; one took 11 by its picks one after the other
    assert check(first) == []
    assert again.rooms == first.rooms
