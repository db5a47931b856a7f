"""A row holds its whole house, and its hash is that of the house alone."""

import json
from pathlib import Path

import pytest
from msgspec import structs

from tests.logic.workers import in_process
from vitruvius.logic.dataset.formats import read, written
from vitruvius.logic.dataset.rows import house_of, house_row, house_sha256, limit_row, source
from vitruvius.logic.dataset.sets import Set
from vitruvius.logic.dataset.splits import SPLITS, split_of
from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import Promises

SIZES = {"family": 4, "home": 6, "apartments": 8}


@pytest.fixture(scope="module", params=SIZES)
def house(request: pytest.FixtureRequest) -> House:
    return next(in_process.generate(SIZES[request.param], grammar=request.param))


def test_a_house_is_in_its_row_bit_for_bit(house: House) -> None:
    assert house.provenance
    row = json.loads(json.dumps(house_row(house)))
    back = house_of(row, house.provenance.versions, house.provenance.promises)
    assert back == house.converted()
    assert back
    assert house_row(back) == row
    assert row["types"] == [room.type for room in house.counted]
    inside = [room.area for room in house.rooms if room.type not in house.outdoor]
    assert row["area"] == pytest.approx(sum(inside))


def test_the_hash_is_of_the_house_and_not_of_where_it_comes_from(house: House) -> None:
    assert house.provenance
    elsewhere = structs.replace(house, provenance=structs.replace(house.provenance, seed=7, versions={}))
    assert house_sha256(elsewhere) == house_sha256(house.converted()) == house_sha256(house)
    [first, *others] = house.rooms
    moved = structs.replace(first, x=first.x + 1e-15 + abs(first.x) * 1e-15)
    assert house_sha256(structs.replace(house, rooms=(moved, *others))) != house_sha256(house)


@pytest.fixture(scope="module")
def made() -> list[House]:
    return [*in_process.generate(3, count=3), *in_process.generate(5, grammar="home", count=3)]


@pytest.mark.parametrize("files", ["parquet", "jsonl"])
def test_rows_are_read_as_they_were_written_and_written_in_the_same_bytes(
    files, made: list[House], tmp_path: Path
) -> None:
    rows = [house_row(house) for house in made]
    rows.append(limit_row(source("home", "0", {"rooms": 5, "types": {}}, 0, 3), "house 3 reached its limit"))
    paths = [tmp_path / f"{name}.{files}" for name in ("one", "other")]
    for path in paths:
        with written(path, files) as write:
            write(rows[:4])
            write(rows[4:])
    assert paths[0].read_bytes() == paths[1].read_bytes()
    for first in range(len(rows) + 1):
        assert list(read(paths[0], first)) == rows[first:]


def test_a_seed_is_of_one_split() -> None:
    assert [split_of(seed) for seed in (0, 10**9 - 1, 10**9, 2 * 10**9, 2**31 - 1)] == [
        *("train", "train", "validation"),
        *("test", "test"),
    ]
    assert sum(map(len, SPLITS.values())) == 2**31


@pytest.mark.parametrize("shards", [3, 4, 7, 50, 113])
def test_every_house_of_a_set_is_in_one_shard(shards: int) -> None:
    houses = {"train": 100, "validation": 7, "test": 6}
    of = Set(
        "vitruvius-set-1", "home", "", {"rooms": 4}, 5, 20, houses, shards, "jsonl", 1, 1.0, {}, Promises()
    )
    divided = of.divided()
    assert [shard.number for shard in divided] == list(range(shards))
    assert len({shard.place for shard in divided}) == shards
    for split, number in houses.items():
        own = [shard for shard in divided if shard.split == split]
        assert [index for shard in own for index in shard.indices] == list(range(20, 20 + number))
        assert {shard.seed for shard in own} == {SPLITS[split][5]}
        assert all(shard.indices for shard in own)
