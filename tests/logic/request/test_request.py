"""Requests for houses: read strictly, granted exactly, recorded in the house's provenance."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.logic.workers.in_process import generate
from vitruvius.logic import House, RequestError
from vitruvius.logic.request.counts import as_option, as_range, from_option, in_words
from vitruvius.logic.request.house_request import HouseRequest

RANGES = st.tuples(st.integers(0, 99), st.integers(0, 99)).map(sorted).map(tuple) | st.tuples(
    st.integers(0, 99), st.none()
)


def counted(house: House, type_: str, piece: str) -> list[int]:
    """Return the number of pieces of a type in each room of this type, with companions of others."""
    rooms = [room for room in house.star.rooms if room.type == type_]
    return [sum(each.type == piece for each in room.pieces) for room in rooms]


# Reading.


@given(RANGES)
def test_a_range_is_read_as_it_is_written(wanted: tuple[int, int | None]) -> None:
    assert as_range("type bedroom", from_option(as_option(wanted))) == wanted


@given(st.dictionaries(st.sampled_from(["bedroom", "hall"]), RANGES), st.floats(0.287, 2.0))
def test_a_request_is_its_json_form(types: dict, cell: float) -> None:
    request = HouseRequest(4, types, {"bedroom.bed": (1, None)}, cell)
    assert HouseRequest.read(request.to_dict()) == request


def test_an_exact_count_is_written_as_a_number() -> None:
    assert HouseRequest.read({"rooms": 3, "types": {"hall": (1, 1), "kitchen": [0, 2]}}).to_dict() == {
        "rooms": 3,
        "types": {"hall": 1, "kitchen": [0, 2]},
    }


@pytest.mark.parametrize(
    ("text", "wanted"), [("2", (2, 2)), ("..3", (0, 3)), ("1..", (1, None)), ("..", (0, None)), ("0", (0, 0))]
)
def test_options_leave_out_a_bound(text: str, wanted: tuple[int, int | None]) -> None:
    assert as_range("type bedroom", from_option(text)) == wanted


def test_ranges_are_said_in_words() -> None:
    assert [in_words(wanted) for wanted in ((2, 2), (1, 3), (2, None))] == ["2", "1 to 3", "2 or more"]


@pytest.mark.parametrize("count", [-1, (3, 1), (1,), (1, 2, 3), 1.5, "2", True, (None, 2), None, 2**31])
def test_a_count_without_sense_is_refused(count: object) -> None:
    with pytest.raises(RequestError, match="type bedroom"):
        as_range("type bedroom", count)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"types": {"bedrom": 1}}, "bedrom: did you mean bedroom"),
        ({"furniture": {"wardobe": 1}}, "wardobe: did you mean wardrobe"),
        ({"furniture": {"bedrom.bed": 1}}, "bedrom: did you mean bedroom"),
        ({"furniture": {"bathroom.bed": 1}}, "bed.*shower, sink, toilet"),
        ({"types": {"": 1}}, "there are bathroom, bedroom, hall, kitchen"),
    ],
)
def test_an_unknown_name_is_answered_by_those_that_exist(asked: dict, says: str) -> None:
    with pytest.raises(RequestError, match=says):
        next(generate(rooms=3, **asked))


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"types": [("bedroom", 1)]}, "type counts: give them by name"),
        ({"furniture": "bed"}, "piece counts: give them by name"),
        ({"cell": "0.5"}, "cell must be a number, not '0.5'"),
        ({"cell": None}, "cell must be a number, not None"),
        ({"seconds": 10**400}, "seconds must be a number, not 1000"),
        ({"keep": 1}, "keep: must be a house, as in .*, not 1"),
    ],
)
def test_an_argument_of_another_kind_is_refused_by_name(asked: dict, says: str) -> None:
    with pytest.raises(RequestError, match=says):
        next(generate(rooms=3, **asked))


# Granting.


def test_companions_count_as_pieces() -> None:
    """Chairs are requested like tables: a kitchen without a table would have none."""
    for house in generate(rooms=3, furniture={"kitchen.chair": (3, 3), "bedside": (0, 1)}, count=6):
        assert counted(house, "kitchen", "chair") == [3]
        assert all(count <= 1 for count in counted(house, "bedroom", "bedside"))


def test_a_count_without_a_room_type_binds_in_every_room_that_may_have_the_piece() -> None:
    for house in generate(rooms=6, types={"hall": (1, None)}, furniture={"chair": (2, None)}, count=4):
        chairs = [*counted(house, "kitchen", "chair"), *counted(house, "hall", "chair")]
        assert len(chairs) >= 2
        assert all(count >= 2 for count in chairs)


def test_a_request_asks_for_nothing_that_it_does_not_say() -> None:
    """A range that binds nothing permits both its ends."""
    houses = list(generate(rooms=3, furniture={"bedroom.wardrobe": (0, None)}, count=12))
    assert {n for house in houses for n in counted(house, "bedroom", "wardrobe")} == {0, 1, 2}


def test_a_house_is_made_again_from_its_provenance() -> None:
    asked: dict[str, Any] = {
        "rooms": 5,
        "types": {"bathroom": (1, 2), "hall": (0, None)},
        "furniture": {"bed": 1, "kitchen.chair": (1, 2)},
    }
    house = next(generate(**asked, seed=3, start=7))
    assert house.provenance
    request: dict[str, Any] = house.provenance.request
    assert request["types"] == {"bathroom": [1, 2], "hall": [0, None]}
    assert request["furniture"] == {"bed": 1, "kitchen.chair": [1, 2]}
    again = generate(**request, seed=house.provenance.seed, start=house.provenance.index)
    assert next(again) == house
