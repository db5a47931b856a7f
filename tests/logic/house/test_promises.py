"""Promises travel with houses, and ``check`` judges by them, or by other promises on request."""

import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import asdict, replace

from tests.logic.workers import in_process
from tests.plans import flat
from vitruvius.commands.houses import Check
from vitruvius.logic import House, RequestError, check, load, save
from vitruvius.logic.checking.figures import figure, number, percent
from vitruvius.logic.errors import HouseFileError
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.house.parts import Piece, Room
from vitruvius.logic.house.promises import OLD_PROMISES, Promises, Thickness
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.check import promises_by, promises_of

ROOMS = {"home": 5, "family": 4, "clinic": 6}
"""Numbers of rooms, as few as show most of what a grammar states."""

LENGTHS = {
    "home": (
        "lengths.pl",
        [("door_clearance(0.45)", "door_clearance(0.4)"), ("door_width(0.8)", "door_width(0.7)")],
    ),
    "family": (
        "sizes.pl",
        [
            ("passage(0.42)", "passage(0.6)"),
            ("bathroom, W, D) :- { W >= 2.4, W =< 3.7", "bathroom, W, D) :- { W >= 4.0, W =< 4.6"),
        ],
    ),
}
"""Copies of these grammars have other lengths, in one of their files."""


def stated(promises: Promises) -> dict[str, Any]:
    """Return the fields of promises that differ from the defaults."""
    defaults = asdict(Promises())
    return {name: value for name, value in asdict(promises).items() if value != defaults[name]}


def copy(grammar: str, folder: Path) -> Path:
    shutil.copytree(SHIPPED / grammar, folder / "mine")
    file, changes = LENGTHS[grammar]
    text = (folder / "mine" / file).read_text()
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    (folder / "mine" / file).write_text(text)
    return folder / "mine"


@pytest.fixture(scope="module")
def shipped() -> dict[str, House]:
    return {name: next(in_process.generate(rooms, grammar=name, seed=5)) for name, rooms in ROOMS.items()}


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, list[House]]]:
    """Return the copies of the grammars, and houses of each."""
    folders = {name: copy(name, tmp_path_factory.mktemp(name)) for name in LENGTHS}
    return {
        name: (folder, list(in_process.generate(ROOMS[name], grammar=folder, seed=5, count=4)))
        for name, folder in folders.items()
    }


@pytest.mark.parametrize("grammar", ROOMS)
def test_what_was_once_written_by_hand_of_a_shipped_grammar_follows_from_its_rules(
    grammar: str, shipped: dict[str, House]
) -> None:
    house = shipped[grammar]
    assert house.provenance
    assert house.provenance.promises
    found, old = stated(house.provenance.promises), stated(OLD_PROMISES[grammar])
    for name in old.keys() - UNSTATED - CHANGED:
        if isinstance(old[name], dict):
            for key, value in old[name].items():
                sizes = isinstance(value, tuple) and not isinstance(value[0], str)
                assert found[name][key] == (pytest.approx(value) if sizes else value), name
        else:
            assert found[name] == old[name] or {*found[name]} == {*old[name]}, name
    assert check(house) == check(house, house.provenance.promises) == []


MORE_RULES = """
type(bay; patio).  empty(bay; patio).  opens(living,(bay; patio)).  part(bay,living).  outdoor(patio).
opening(living,kitchen).  same_size(bedroom).  at_head(bed,bedside).
promise(basic,(kitchen; bathroom)).  promise(a_side,2).  promise(meet,worktop).
"""
MORE_LENGTHS = """
room_size(bay,   W, D) :- { W >= 1.5, W =< 3.2, D >= 1.5, D =< 3.2, W + D =< 6.0 }.
room_size(patio, W, W) :- { W >= 2.0, W =< 4.0 }.
whole_area(living, 22.0, 36.0).  house_area(60.0, 95.0).  turning(bathroom, 1.1).
door_width(bathroom, corridor, 0.7).  wall_thickness(inner, 0.1).  wall_thickness(outer, 0.3).
"""
SIZES = {
    "coatRack,       L, D, _) :- { L >= 0.5,  L =< 1.2,": "coatRack, L, D, W) :- { 4*L >= W, 2*L =< W,",
    "table,          L, D, _) :- { L >= 0.6,  L =< 1.2, D >= 0.6,  D =< 0.8 }": (
        "table, L, D, W-A) :- { L >= 0.2*W, L =< 0.4*W, 5*D >= A, D =< 0.4*A }"
    ),
}
"""Sizes that depend on those of the room."""
STATED = {
    "whole_area": {"living": (22.0, 36.0)},
    "house_area": (60.0, 95.0),
    "turning": {"bathroom": 1.1},
    "door_widths": {"bathroom": {"corridor": 0.7}},
    "wall_thickness": Thickness(0.1, 0.3),
    "degree": {"corridor": (3, 9), "hall": (1, 4), "kitchen": (1, 2)},
    "parts": {"bay": ("living",)},
    "openings": {"living": ("kitchen",)},
    "outdoor": ("patio",),
    "same_size": {"bedroom": False},
    "at_head": ("bed",),
    "door_clearance": 0.4,
    "door_width": 0.7,
    "basic": ("bathroom", "kitchen"),
    "a_side": 2,
    "free_foot": ("singleBed",),
    "meet": ("worktop",),
    "spans": {"coatRack": (0.25, 0.5)},
    "shares": {"table": (0.2, 0.4)},
}
RELATIONS = {
    "bay": {(1.0, 1.0, 6.0)},
    "patio": {(-1.0, 1.0, 0.0), (1.0, -1.0, 0.0)},
    "house": {(-2.2, 1.0, 0.0), (1.0, -2.2, 0.0)},
    "toilet": {(1.0, -1.0, -0.33), (-1.0, 1.0, 0.33)},
}
"""Numbers a, b, c of relations: a times the width plus b times the depth is at most c."""
OF_OTHERS = {"room_gap", "public", "courts", "even_rows"}
"""Promises of stars, of houses of units, of dissections and of rooms with rows in the middle."""
UNSTATED = {"narrowest", "tops"}
"""Promises of old houses and of standards only. Grammars promise sizes and relations instead."""
CHANGED = {"opens", "free_foot"}
"""Promises of home that have changed since."""


def test_all_that_a_grammar_states_together_is_promised(tmp_path: Path) -> None:
    folder = copy("home", tmp_path)
    (folder / "more.lp").write_text(MORE_RULES)
    (folder / "more.pl").write_text(MORE_LENGTHS)
    lengths = folder / "lengths.pl"
    lengths.write_text(lengths.read_text().replace("passage(0.42)", "passage(0.4)"))
    sizes = folder / "furniture.pl"
    for old, new in SIZES.items():
        assert old in sizes.read_text()
        sizes.write_text(sizes.read_text().replace(old, new))
    promised = stated(Builder(find(folder)).promises(HouseRequest(6)))
    assert promised.keys() == set(Promises.__struct_fields__) - OF_OTHERS - UNSTATED
    for name, value in STATED.items():
        assert promised[name] == value, name
    relations = promised["room_relations"] | promised["piece_relations"] | {"house": promised["house_size"]}
    for name, rows in RELATIONS.items():
        assert {*relations[name]} == rows, name


@pytest.mark.parametrize("grammar", LENGTHS)
def test_houses_of_other_lengths_are_judged_by_these(
    grammar: str, copied: dict[str, tuple[Path, list[House]]]
) -> None:
    _, houses = copied[grammar]
    assert not [line for house in houses for line in check(house)]
    assert all(check(house, grammar) for house in houses)


def nearer(house: House, away: float) -> tuple[House, str]:
    """Return the house with a piece moved to this distance from its room's only door.

    The piece is the first one that has the door straight to one side.
    """
    for room in house.rooms:
        for piece, door in ((piece, door) for piece in room.children for door in house.doors_of(room.name)):
            gaps = [_gap(piece, door, axis) for axis in (0, 1)]
            if piece.children or sum(map(bool, gaps)) != 1:
                continue
            axis = 0 if gaps[0] else 1
            move = gaps[axis] - (away if gaps[axis] > 0 else -away)
            changed = replace(piece, **{"xy"[axis]: piece.box[axis] + move})
            others = tuple(changed if each is piece else each for each in room.children)
            rooms = tuple(replace(each, children=others) if each is room else each for each in house.rooms)
            return replace(house, rooms=rooms), room.name
    pytest.fail("no piece has a door to one side of it")


def _gap(piece: Piece, door: Any, axis: int) -> float:
    """Return the signed distance of the door from the piece along an axis; 0 if they overlap there."""
    if door.box[axis] > piece.box[axis + 2]:
        return door.box[axis] - piece.box[axis + 2]
    return min(0.0, door.box[axis + 2] - piece.box[axis])


@pytest.mark.parametrize("away", [0.31, 0.399, 0.3999, 0.39999])
def test_furniture_moved_nearer_to_a_door_than_its_grammar_promises_is_found(
    away: float, copied: dict[str, tuple[Path, list[House]]]
) -> None:
    house = copied["home"][1][0]
    moved, room = nearer(house, away)
    (line,) = {line for line in check(moved) if line.startswith(room) and "(at least 0.4)" in line}
    found = re.search(r"stands ([\d.]+) m from", line)
    assert found
    assert float(found[1]) == pytest.approx(away, abs=1e-5)
    assert float(found[1]) < 0.4


def test_a_piece_whose_sides_do_not_go_together_is_found_within_the_bounds_of_each(
    shipped: dict[str, House],
) -> None:
    """A toilet is 0.36 to 0.4 m long, and 0.33 m deeper than long."""
    house = shipped["home"]
    room = next(room for room in house.rooms if any(piece.type == "toilet" for piece in room.children))
    toilet = next(piece for piece in room.children if piece.type == "toilet")
    deep = "height" if toilet.orientation in {"N", "S"} else "width"
    changed = getattr(toilet, deep) + (0.01 if getattr(toilet, deep) < 0.71 else -0.01)
    pieces = tuple(replace(each, **{deep: changed}) if each is toilet else each for each in room.children)
    rooms = tuple(replace(each, children=pieces) if each is room else each for each in house.rooms)
    (found,) = (line for line in check(replace(house, rooms=rooms)) if "toilet is" in line)
    assert "(must be: depth <= length + 0.33)" in found or "(must be: length + 0.33 <= depth)" in found


def test_promises_survive_files_their_first_line_and_files_one_after_the_other(
    tmp_path: Path, shipped: dict[str, House]
) -> None:
    houses = [*shipped.values(), flat()]
    for name in ("a.jsonl", "b.jsonl"):
        save(houses, tmp_path / name)
    content = (tmp_path / "a.jsonl").read_bytes() + (tmp_path / "b.jsonl").read_bytes()
    (tmp_path / "both.jsonl").write_bytes(content)
    (tmp_path / "last.jsonl").write_bytes(content.splitlines()[-2] + b"\n")
    assert load(tmp_path / "both.jsonl") == [*houses, *houses]
    assert load(tmp_path / "last.jsonl") == [houses[-2]]
    assert [House.from_dict(json.loads(json.dumps(house.to_dict()))) for house in houses] == houses
    assert promises_of(houses[-1]) == Promises()


def test_a_house_without_promises_is_judged_by_what_is_said_of_its_grammar(
    shipped: dict[str, House],
) -> None:
    for grammar, house in shipped.items():
        assert house.provenance
        old = replace(house, provenance=replace(house.provenance, promises=None))
        assert promises_of(old) == OLD_PROMISES[grammar]
        assert "promises" not in old.to_dict()["provenance"]


WHEELS = {"door_width": 0.9, "door_clearance": 0.9, "passage": 0.9}


def test_a_stricter_standard_is_some_promises_in_a_mapping_or_a_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], shipped: dict[str, House]
) -> None:
    house = shipped["home"]
    (tmp_path / "wheels.json").write_text(json.dumps(WHEELS))
    found = check(house, WHEELS)
    assert found == check(house, tmp_path / "wheels.json") == check(house, str(tmp_path / "wheels.json"))
    assert all(
        any(words in line for line in found) for words in ("wide (at least 0.9)", "door (at least 0.9)")
    )
    assert check(house, {}) == check(house) == []
    save([house], tmp_path / "h.jsonl")
    assert Check(tmp_path / "h.jsonl", promises=str(tmp_path / "wheels.json")).run() == 1
    assert capsys.readouterr().out.splitlines() == [
        f"{tmp_path / 'h.jsonl'}: house 0: {line}" for line in found
    ]


def test_a_wide_passage_is_asked_of_narrower_doors_too() -> None:
    """A square as wide as the passage reaches the door, though it does not fit through."""
    house = replace(flat(), provenance=None)
    assert not [line for line in check(house, {"passage": 1.0}) if "R3" in line]


def test_a_grammar_judges_the_houses_of_another(
    shipped: dict[str, House], copied: dict[str, tuple[Path, list[House]]]
) -> None:
    folder, houses = copied["home"]
    assert check(houses[0], folder) == []
    found = check(replace(shipped["home"], doors=houses[0].doors[:0]), folder)
    assert "house: has no door to the outside" in found


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ('{"door_clearence": 0.9}', "there is no promise door_clearence: did you mean door_clearance?"),
        ('{"passage": "wide"}', "Expected `float`, got `str` - at `$.passage`"),
        ('{"passage": -1}', "Expected `float` >= 0"),
        ("[1]", "Expected `object`"),
        ('{"passage"', "its end is missing"),
    ],
)
def test_a_misspelt_or_impossible_promise_is_an_error_that_says_where(
    content: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / "standard.json").write_text(content)
    with pytest.raises(HouseFileError, match=re.escape(words)) as error:
        promises_by(tmp_path / "standard.json")
    assert str(error.value).startswith(str(tmp_path / "standard.json"))
    if content == '{"door_clearence": 0.9}':
        with pytest.raises(RequestError, match=re.escape(words)):
            check(flat(), json.loads(content))
    with pytest.raises(HouseFileError, match="no such JSON file of promises, and there is no grammar"):
        promises_by(tmp_path / "absent")


lengths = st.floats(1e-5, 60.0)


@given(lengths, lengths, st.integers(0, 3))
def test_a_value_and_a_bound_that_it_violates_never_read_alike_nor_is_it_nothing(
    value: float, bound: float, digits: int
) -> None:
    bound = round(bound, 4)
    assume(abs(value - bound) > 1e-6)
    shown, against = float(figure(value, bound, digits=digits)), float(number(bound))
    assert shown > 0
    assert (shown < against) == (value < bound)
    assert (shown > against) == (value > bound)
    assert float(percent(value / 100, bound / 100)[:-1]) == pytest.approx(value, abs=0.51)


def texts(house: House, standards: Promises) -> Iterator[tuple[float, float]]:
    """Yield the found length and the bound of each violation of a least length."""
    for line in check(house, standards):
        found = re.search(r"([\d.]+) m[^(]*\(at least ([\d.]+)\)", line)
        assert not re.search(r"\b0\.0+\b", line), line
        if found:
            yield float(found[1]), float(found[2])


@settings(max_examples=15)
@given(st.floats(1e-5, 0.6), st.floats(1e-5, 0.6))
def test_no_violation_states_two_lengths_that_read_alike(by: float, less: float) -> None:
    """The furniture of the plan is moved, and the standards are slightly above the plan's lengths."""
    house = flat()
    room = next(room for room in house.rooms if room.children)
    moved = _moved(house, room, by)
    strict = Promises(
        door_width=0.9 + less, door_clearance=0.45 + less, passage=0.42 + less, narrowest={"hall": 1 + less}
    )
    assert all(found < bound for found, bound in texts(moved, strict))


def _moved(house: House, room: Room, by: float) -> House:
    pieces = tuple(replace(piece, x=piece.x + by) for piece in room.children)
    return replace(
        house, rooms=tuple(replace(each, children=pieces) if each is room else each for each in house.rooms)
    )
