"""The houses of a stream are those of ``generate``, for numbers of rooms in turn, generated on access."""

import pytest

from vitruvius.logic import HouseStream, RequestError, generate
from vitruvius.logic.dataset.stream import MOST_HOUSES


def test_each_house_is_that_of_its_request_seed_and_index() -> None:
    stream = HouseStream(range(2, 5), grammar="family", seed=3, types={"kitchen": 1})
    assert len(stream) == MOST_HOUSES
    for index in (0, 1, 5, 999_999_999):
        rooms = 2 + index % 3
        assert stream[index] == next(generate(rooms=rooms, seed=3, start=index, types={"kitchen": 1}))
    assert stream[1:3] == [stream[1], stream[2]]
    few = HouseStream(2, count=3)
    assert [*few] == list(generate(rooms=2, count=3))
    assert few[-1] == few[2]
    with pytest.raises(IndexError):
        few[3]


def test_a_stream_is_named_by_all_that_its_houses_are_a_function_of() -> None:
    names = [
        HouseStream(2).hash,
        HouseStream(3).hash,
        HouseStream([2, 3]).hash,
        HouseStream(2, seed=1).hash,
        HouseStream(2, grammar="plain").hash,
        HouseStream(2, count=5).hash,
        HouseStream(2, cell=0.3).hash,
    ]
    assert len({*names}) == len(names)
    assert HouseStream([2]).hash == names[0]


def test_it_is_read_from_a_line() -> None:
    stream = HouseStream.read("home:rooms=4..6")
    assert stream is not None
    assert stream.hash == HouseStream(range(4, 7), grammar="home").hash
    one = HouseStream.read("family:rooms=4")
    assert one is not None
    assert one.hash == HouseStream(4).hash
    for text in ("houses.jsonl", "home", "home:rooms=", "home:rooms=4..", "home:rooms=4..5,seed=3"):
        assert HouseStream.read(text) is None
    for text in ("home:rooms=6..4", "home:rooms=0", "home:rooms=4..129"):
        with pytest.raises(RequestError, match="give 1 to 128 rooms, the smaller number first"):
            HouseStream.read(text)
    with pytest.raises(RequestError, match="the list is empty"):
        HouseStream([])
