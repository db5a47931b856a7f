"""Banks: what is kept for measuring is whole, simulable, and never learnt from."""

import msgspec
import pytest
from msgspec.structs import replace

from agent import banks
from agent.banks import TEST, TRAINING, VALIDATION, bank_hash, benchmark, geometry_hash, require_training
from agent.commands import Train
from agent.config import PQNConfig
from logic import House, HouseFileError, Rect, Star, check, generate, load, save
from logic.promises import PROMISES
from sim.arguments import BANK


@pytest.fixture(scope="module")
def bank():
    return benchmark()


def test_the_benchmark_bank_is_256_houses_of_family_with_2_to_6_rooms(bank):
    assert [len(house.star.rooms) for house in bank] == [2 + i % 5 for i in range(256)]
    assert {house.provenance.grammar for house in bank} == {"family"}
    assert all(house.provenance.seed in TEST for house in bank)


def test_the_benchmark_bank_is_the_one_that_was_frozen(bank):
    assert bank_hash(bank) == banks.HASH


def test_its_houses_keep_their_promises_and_are_all_different(bank):
    # The frozen bank is older than one promise, which 52 of its houses do not keep: that fronts are clear.
    promised = replace(PROMISES["family"], clear_front=frozenset())
    assert not any(check(house, promised) for house in bank[::16])
    assert len(set(map(geometry_hash, bank))) == len(bank)


def test_the_seeds_set_apart_are_apart():
    assert not set(TRAINING[:: 10**6]) & set(VALIDATION[:: 10**6]) & set(TEST[:: 10**6])
    assert TRAINING.stop == VALIDATION.start
    assert VALIDATION.stop == TEST.start
    assert TEST.stop == 2**31  # the generator takes no seed from there on


def test_another_bank_in_its_place_is_refused(bank, tmp_path, monkeypatch):
    save(bank[:2], tmp_path / "test-v1.jsonl.gz")
    monkeypatch.setattr(banks, "benchmark_path", lambda: tmp_path / "test-v1.jsonl.gz")
    with pytest.raises(HouseFileError, match="not the frozen bank"):
        benchmark()


def test_houses_of_the_test_seeds_or_of_a_test_houses_shape_are_not_learnt_from(bank):
    seeded = House.of_star(
        Star(Rect(0, 0, 5, 5)), provenance=msgspec.structs.replace(bank[0].provenance, index=10**6)
    )
    nameless = msgspec.structs.replace(bank[7], provenance=None)
    innocent = House.of_star(Star(Rect(0, 0, 5, 5)))
    require_training([innocent], "mine.jsonl")
    with pytest.raises(HouseFileError, match=r"mine.jsonl: house 1: its seed 2000000000 is kept"):
        require_training([innocent, seeded], "mine.jsonl")
    with pytest.raises(HouseFileError, match=r"mine.jsonl: house 0: it is in the benchmark bank, kept"):
        require_training([nameless], "mine.jsonl")


def test_training_in_the_benchmark_bank_is_refused_before_anything_is_written(bank, tmp_path):
    save(bank[:2], tmp_path / "mine.jsonl")
    with pytest.raises(HouseFileError, match="kept for measuring"):
        Train(tmp_path / "mine.jsonl", out=tmp_path / "out", config=PQNConfig(steps=1)).run()
    assert not (tmp_path / "out").exists()


def test_the_houses_that_come_with_the_simulator_may_be_learnt_from_and_have_a_kitchen():
    """So a task may ask for one."""
    houses = load(BANK)
    assert len(houses) == 32
    require_training(houses, BANK)
    assert not any(check(house) for house in houses)
    assert all("kitchen" in [room.type for room in house.star.rooms] for house in houses)


@pytest.mark.parametrize(
    ("path", "request_"), [(banks.benchmark_path(), {"rooms": 2, "seed": TEST.start}), (BANK, {"rooms": 4})]
)
def test_todays_rules_make_the_houses_of_the_banks_again_where_the_solvers_are_the_same(path, request_):
    first, [again] = load(path)[0], generate(**request_)
    assert again.provenance
    assert first.provenance
    if again.provenance.versions != first.provenance.versions:
        pytest.skip("other versions of the solvers than the bank's: it stays as it was made")
    assert geometry_hash(again) == geometry_hash(first)
