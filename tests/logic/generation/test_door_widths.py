"""Doors with widths by the types of both rooms, judged by coordinates."""

import shutil
from pathlib import Path

import pytest
from msgspec import structs

from tests.logic.workers.in_process import generate
from vitruvius.logic import GrammarError, RequestError, Unsatisfiable, check
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import OUTSIDE, Door

WIDTHS = {
    frozenset(("bathroom", "corridor")): 0.7,
    frozenset(("bathroom", "hall")): 0.65,
    frozenset(("hall", OUTSIDE)): 1.0,
    frozenset(("corridor", OUTSIDE)): 1.1,
}
OTHERS = 0.8
"""Width of all other doors of home, as in its file, metres."""

CLAUSES = """
door_width(bathroom, corridor, 0.7).   door_width(hall, bathroom, 0.65).
door_width(outside, hall, 1.0).        door_width(corridor, outside, 1.1).
"""


def grammar(folder: Path, clauses: str, base: str = "home") -> Path:
    shutil.copytree(SHIPPED / base, folder)
    (folder / "doors.pl").write_text(clauses)
    return folder


def types(house: House, door: Door) -> frozenset[str]:
    return frozenset(OUTSIDE if name == OUTSIDE else house.room(name).type for name in door.between)


@pytest.mark.second_part("many houses")
def test_doors_are_as_wide_as_their_pair_of_types_says_either_way_round(tmp_path: Path) -> None:
    met: set[frozenset[str]] = set()
    for house in generate(rooms=7, grammar=grammar(tmp_path / "doors", CLAUSES), count=12):
        assert check(house) == []
        for door in house.doors:
            pair = types(house, door)
            assert max(door.width, door.height) == pytest.approx(WIDTHS.get(pair, OTHERS), abs=1e-9)
            met |= {pair} & {*WIDTHS}
            narrow = structs.replace(door, width=door.width * 0.99, height=door.height * 0.99)
            doors = tuple(narrow if each is door else each for each in house.doors)
            least = f"(at least {WIDTHS.get(pair, OTHERS):g})"
            assert any(least in each for each in check(structs.replace(house, doors=doors)))
        if met == {*WIDTHS}:
            break
    assert met == {*WIDTHS}


@pytest.mark.second_part("many houses")
def test_without_such_clauses_houses_are_as_ever(tmp_path: Path) -> None:
    [one] = generate(rooms=6, grammar="home", seed=5)
    [other] = generate(rooms=6, grammar=grammar(tmp_path / "none", "% none\n"), seed=5)
    assert structs.replace(one, provenance=None) == structs.replace(other, provenance=None)


def test_a_door_wider_than_the_walls_can_be_is_proved_impossible_by_its_clause(tmp_path: Path) -> None:
    tiny = "topology(ring).  type(hall;bath).  empty(hall;bath).  central(hall).\n"
    rules = "opens(outside,hall).  opens(hall,bath).\n#program house.\n:- not room(_,bath).\n"
    (tmp_path / "rooms.lp").write_text(tiny + rules)
    sizes = "room_size(_, W, D) :- { W >= 1.6, W =< 3.2, D >= 1.6, D =< 3.2 }.\n"
    sizes += "house_size(W, D) :- { W =< 2.9, D =< 6.0 }.\n"
    lengths = "door_width(0.8).  door_clearance(0.45).  passage(0.42).  room_gap(0.0).\n"
    (tmp_path / "lengths.pl").write_text(sizes + lengths + "door_width(bath, hall, 3.0).\n")
    with pytest.raises(Unsatisfiable) as proof:
        list(generate(rooms=2, grammar=tmp_path))
    assert "door_width(bath, hall, 3.0)" in str(proof.value)


WRONG = {
    "door_width(bath, hall, 0.7).": ":1:1: door_width(bath, hall, 0.7): no room has the type bath",
    "door_width(outside, outside, 0.7).": ":1:1: door_width(outside, outside, 0.7): a door needs a room",
    "door_width(wc, hall, 0).": ":1:1: door_width(wc, hall, 0): must be a number of metres more than 0",
    "door_width(wc, hall, 0.7). door_width(hall, wc, 0.8).": ":1:28: door_width(hall, wc, 0.8): these doors",
    "door_width(wc, hall, 5).": ":1:1: door_width(wc, hall, 5): such a door needs 5.2 m of a wall with",
}


@pytest.mark.parametrize("clauses", WRONG)
def test_what_is_no_width_is_named_by_line_and_column(clauses: str, tmp_path: Path) -> None:
    with pytest.raises(GrammarError) as error:
        list(generate(rooms=4, grammar=grammar(tmp_path / "wrong", clauses)))
    assert f"doors.pl{WRONG[clauses]}" in str(error.value).replace("error: ", "")


@pytest.mark.second_part("grammars of their own")
def test_stars_units_and_own_plans_refuse_it(tmp_path: Path) -> None:
    clause = "door_width(bathroom, hall, 0.7).\n"
    with pytest.raises(GrammarError, match="not expressible in this topology: doors: in a star each room"):
        list(generate(rooms=4, grammar=grammar(tmp_path / "star", clause, "family")))
    with pytest.raises(GrammarError, match="all doors of units have one width: state only door_width/1"):
        list(generate(rooms=15, grammar=grammar(tmp_path / "units", clause, "apartments")))
    [house] = generate(rooms=5, grammar="home")
    with pytest.raises(
        RequestError, match="of both rooms, which given plans do not support: leave these clauses out"
    ):
        list(generate(plan=house, grammar=grammar(tmp_path / "own", clause)))
