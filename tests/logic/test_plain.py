"""Python code may give NumPy's numbers wherever it gives numbers."""

import json
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from tests.plans import flat
from tests.sample_houses import RANDOM
from vitruvius.logic import Door, FreeWall, House, Piece, RequestError, Room, Window, check, load, save
from vitruvius.logic.exports.geojson import to_geojson
from vitruvius.logic.house.promises import Promises, read_promises
from vitruvius.logic.request.arguments import house_request

NUMBERS = pytest.mark.parametrize("number", [np.float64, np.float32, np.int64, np.uint8, np.array])
"""Functions that make a number of NumPy."""


def with_numbers(value: Any, number: Any) -> Any:
    """Return a value with NumPy's numbers in all its lists and objects."""
    if isinstance(value, dict):
        return {key: with_numbers(each, number) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [with_numbers(each, number) for each in value]
    return number(value) if type(value) in (int, float) else value


@NUMBERS
def test_houses_of_such_numbers_are_written_and_read_again(number: Any, tmp_path: Path) -> None:
    zero, one, three, four = map(number, (0, 1, 3, 4))
    bed = Piece(zero, one, one, one, "bed", children=(Piece(one, one, one, one, "bedside"),))
    house = House(
        (Room(zero, zero, three, four, "R0", "hall", (bed,)),),
        (Door(one, zero, one, zero, ("R0", "outside")),),
        (Window(one, four, one, zero, "R0"),),
        hub="R0",
        topology="own",
        free_walls=(FreeWall(zero, zero, one, three, one),),
    )
    save([house], tmp_path / "house.jsonl")
    assert load(tmp_path / "house.jsonl") == [house]
    assert json.loads(msgspec.json.encode(to_geojson(house)))["features"][0]["properties"]["name"] == "R0"
    check(house)


@pytest.mark.parametrize("house", [flat(), RANDOM[0], House.from_grid(np.eye(4, dtype=bool), 0.5)])
def test_records_of_such_numbers_are_read_as_the_same_house(house: House) -> None:
    assert House.from_dict(with_numbers(house.to_dict(), lambda value: np.asarray(value)[()])) == house


@NUMBERS
def test_requests_of_such_numbers_are_requests_of_numbers(number: Any) -> None:
    rooms = [{"name": "A", "area": 12, "size": [3, [4, 5]]}, {"name": "B", "area": [9, 16]}]
    brief = {"rooms": rooms, "outline": {"width": 8}, "doors": [["A", "B"]]}
    assert house_request(brief=with_numbers(brief, number)) == house_request(brief=brief)
    corners = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]
    plan = {"type": "Polygon", "coordinates": [corners]}
    asked = house_request(plan=with_numbers(plan, number), grammar="home")
    assert msgspec.json.encode(asked) == msgspec.json.encode(house_request(plan=plan, grammar="home"))
    assert read_promises(with_numbers({"passage": 1}, number), Promises()).passage == 1


@pytest.mark.parametrize("count", [np.int64(2), (np.int8(1), None), np.array([1, 2]), [np.uint8(1), 2]])
def test_counts_of_such_numbers_are_counts(count: Any) -> None:
    five: Any = np.int64(5)
    assert msgspec.json.encode(house_request(five, types={"bedroom": count}, furniture={"bed": count}))
    half: Any = np.float64(2.5)
    with pytest.raises(RequestError, match=r"a count is a whole number or a pair of them, not 2\.5$"):
        house_request(5, types={"bedroom": half})
