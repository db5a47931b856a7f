"""Rooms of another house are fixed, and the rest is generated around them."""

import shutil
from pathlib import Path

import msgspec
import pytest

import vitruvius
from tests.logic.workers.in_process import generate
from vitruvius.logic import House, RequestError, Unsatisfiable, check
from vitruvius.logic.grammar import SHIPPED
from vitruvius.logic.request.fixed_rooms import fixed_rooms


@pytest.fixture(scope="module")
def house() -> House:
    return next(generate(rooms=5, seed=3))


@pytest.mark.parametrize("names", [("R0",), ("R1", "R3"), ("R0", "R2", "R4"), ("R0", "R1", "R2", "R3", "R4")])
@pytest.mark.parametrize("rooms", [5, 6])
def test_fixed_rooms_are_in_every_house_and_all_else_is_new(
    house: House, names: tuple[str, ...], rooms: int
) -> None:
    fixed = house.only(*names)
    for made in generate(rooms=rooms, keep=fixed, seed=9, count=3):
        assert check(made) == []
        assert len(made.star.rooms) == rooms
        assert all(room in made.star.rooms for room in fixed.star.rooms)
        assert not any(room in made.star.rooms for room in house.star.rooms if room not in fixed.star.rooms)
        assert made.star.floor != house.star.floor


def test_a_house_with_fixed_rooms_can_be_made_again(house: House) -> None:
    made = list(vitruvius.generate(rooms=6, keep=house.only("R1"), seed=2, count=4))
    again = generate(rooms=6, keep=house.only("R1"), seed=2, count=2, start=2)
    assert [each.rooms for each in again] == [each.rooms for each in made[2:]]
    assert House.from_dict(msgspec.json.decode(msgspec.json.encode(made[0].to_dict()))) == made[0]


def test_fixed_rooms_count_among_the_types(house: House) -> None:
    fixed = house.only("R0")
    type_ = fixed.star.rooms[0].type
    (made,) = generate(rooms=4, keep=fixed, types={type_: 1})
    assert [room.type for room in made.star.rooms].count(type_) == 1
    with pytest.raises(Unsatisfiable, match=f"{type_} fixed on the"):
        next(generate(rooms=4, keep=fixed, types={type_: 0}))


def test_rooms_that_no_main_room_joins_are_proved_impossible(house: House) -> None:
    """Two rooms on one side have their walls with doors half a metre apart. No straight wall holds both."""
    one = fixed_rooms(house)[0]
    along, away = ("x", "y") if one.side in {"north", "south"} else ("y", "x")

    def moved(rect):
        changes = {along: getattr(rect, along) + 20, away: getattr(rect, away) + 0.5}
        return msgspec.structs.replace(rect, **changes)

    other = msgspec.structs.replace(moved(one.room), door=moved(one.room.door), children=())
    both = House.of_star(msgspec.structs.replace(house.star, rooms=(one.room, other)))
    with pytest.raises(Unsatisfiable) as caught:
        next(generate(rooms=4, keep=both))
    assert sum("keep: the" in reason.text for reason in caught.value.reasons) == 2


def test_rooms_that_cannot_be_fixed_are_refused(house: House, tmp_path: Path) -> None:
    folder = shutil.copytree(SHIPPED / "family", tmp_path / "washrooms")
    for file in folder.iterdir():
        file.write_text(file.read_text().replace("bathroom", "washroom"))
    with pytest.raises(ValueError, match="no room R7"):
        house.only("R7")
    with pytest.raises(RequestError, match="5 rooms to keep, but rooms=2: ask for rooms=5 or more"):
        next(generate(rooms=2, keep=house))
    with pytest.raises(RequestError, match="grid"):
        next(generate(rooms=6, keep=house, cell=0.3))
    with pytest.raises(RequestError, match="overlap the main room"):
        next(generate(rooms=6, keep=House.of_star(house.star, "original")))
    with pytest.raises(RequestError, match="no room type"):
        next(generate(rooms=6, keep=house, grammar=folder))


def test_fixed_rooms_are_counted_clockwise(house: House) -> None:
    sides = [fixed.side for fixed in fixed_rooms(house)]
    assert sides == sorted(sides, key=["north", "east", "south", "west"].index)
    assert [fixed.room for fixed in fixed_rooms(house)] == list(house.star.rooms)


def test_a_count_of_furniture_does_not_bind_fixed_rooms(house: House) -> None:
    """The count binds only rooms that are still to be furnished, and so do proofs about them."""
    fixed = house.only(*(f"R{n}" for n, room in enumerate(house.star.rooms) if room.type == "bedroom"))
    for made in generate(rooms=4 + len(fixed.star.rooms), keep=fixed, furniture={"bed": 0}, count=6):
        assert [room for room in made.star.rooms if room.type == "bedroom"] == list(fixed.star.rooms)


def test_a_fixed_room_is_named_where_it_is_part_of_a_conflict() -> None:
    fixed = next(generate(rooms=1, types={"hall": 1}))
    with pytest.raises(Unsatisfiable) as caught:
        next(generate(rooms=5, keep=fixed, types={"hall": 0, "bedroom": (1, None)}))
    count, fixed_room = (reason.text for reason in caught.value.reasons)
    assert count == "--type hall=0"
    assert fixed_room.startswith(f"keep: the hall at x {fixed.star.rooms[0].x:.2f}")
