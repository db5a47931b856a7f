"""Rooms of a plan are kept, with their walls and furniture, and the others are generated again."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from tests.logic.workers import in_process
from vitruvius.cli import main
from vitruvius.logic import House, RequestError, Unsatisfiable, check, generate, load, save
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.proofs.answer import house_or_proof
from vitruvius.logic.request.given_plan import keeping, read_plan
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.shared_walls import PlanWitness


@pytest.fixture(scope="module")
def house() -> House:
    return in_process.builder("home").house(HouseRequest.read({"rooms": 7, "types": {"storage": 1}}), 1, 0)


@pytest.fixture(scope="module")
def names(house: House) -> list[str]:
    """Return the names of the two rooms with the most furniture."""
    return [room.name for room in sorted(house.rooms, key=lambda each: -len(each.pieces))[:2]]


def made(home: Builder, house: House, names: Sequence[str], index: int = 0, **request: Any) -> House:
    """Return a house in which these rooms of another house stay, and the others may have any type."""
    free = tuple(room if room.name in names else replace(room, type="") for room in house.rooms)
    plan = keeping(read_plan(replace(house, rooms=free)), house.only(*names))
    wanted = HouseRequest.read(
        {"rooms": len(free), **HouseRequest(len(free), plan=plan).to_dict(), **request}
    )
    return house_or_proof(home, wanted, 7, index)


def test_kept_rooms_and_all_walls_doors_and_windows_stay_and_the_rest_is_new(
    home: Builder, house: House, names: list[str]
) -> None:
    houses = [made(home, house, names, index) for index in range(6)]
    for other in houses:
        assert check(other) == []
        assert all(other.room(name) == house.room(name) for name in names)
        assert [room.box for room in other.rooms] == [room.box for room in house.rooms]
        assert (sorted(map(str, other.doors)), other.windows) == (
            sorted(map(str, house.doors)),
            house.windows,
        )
        assert House.from_dict(other.to_dict()) == other
    others = {
        str([(room.type, room.children) for room in other.rooms if room.name not in names])
        for other in houses
    }
    assert len(others) == 6
    assert made(home, house, names, 3) == houses[3]


def test_a_count_of_furniture_does_not_bind_kept_rooms(home: Builder, house: House) -> None:
    bedroom = next(room for room in house.rooms if room.type == "bedroom")
    kept = sum(piece.type == "dresser" for piece in bedroom.pieces)
    other = made(home, house, [bedroom.name], furniture={"bedroom.dresser": 1 - kept})
    assert other.room(bedroom.name) == bedroom
    dressers = {
        room.name: sum(piece.type == "dresser" for piece in room.pieces)
        for room in other.rooms
        if room.type == "bedroom"
    }
    assert dressers.pop(bedroom.name) == kept
    assert set(dressers.values()) == {1 - kept}


def test_a_conflict_with_a_kept_room_names_it(home: Builder, house: House) -> None:
    storage = next(room.name for room in house.rooms if room.type == "storage")
    with pytest.raises(Unsatisfiable) as caught:
        made(home, house, [storage], types={"storage": 0})
    texts = [reason.text for reason in caught.value.reasons]
    assert sorted(texts) == ["--type storage=0", f"plan: {storage} is of type storage"]


def test_why_says_that_the_request_keeps_a_piece(home: Builder, house: House, names: list[str]) -> None:
    other = made(home, house, names)
    piece = f"{names[0]}.{other.room(names[0]).pieces[0].type}"
    assert "the request keeps it (keep)" in PlanWitness(home, other).why(piece).about


def test_rooms_that_cannot_be_kept_are_refused(house: House) -> None:
    with pytest.raises(RequestError, match="also give the plan, as in generate"):
        generate(keep=house.only("R1"), grammar="home")
    with pytest.raises(RequestError, match="no room to keep"):
        generate(plan=house, keep=house.only(), grammar="home")
    with pytest.raises(RequestError, match="the plan has no doors"):
        generate(plan=replace(house, doors=()), keep=house.only("R1"), grammar="home")
    moved = replace(
        house, rooms=tuple(replace(room, x=room.x + 1) for room in house.rooms), doors=(), windows=()
    )
    with pytest.raises(RequestError, match="the plan has no R1 at the same place"):
        generate(plan=house, keep=moved.only("R1"), grammar="home")


def test_the_command_keeps_rooms_of_a_house_file(house: House, names: list[str], tmp_path: Path) -> None:
    file, out = tmp_path / "house.jsonl", tmp_path / "kept.jsonl"
    save([house], file)
    options = ["--keep", str(file), "--keep-rooms", names[0], "--grammar", "home", "--out", str(out)]
    with pytest.raises(SystemExit) as end:
        main(["generate", *options])
    assert not end.value.code
    (other,) = load(out)
    assert other.room(names[0]) == house.room(names[0])
    assert check(other) == []
