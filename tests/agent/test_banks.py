"""Banks: houses reserved for evaluation are complete, can be simulated, and are never trained on."""

import msgspec
import pytest
from msgspec.structs import replace

from vitruvius.agent import banks
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.banks import BANKS, benchmark, geometry_hash, named, require_training
from vitruvius.commands.train import Train
from vitruvius.logic import House, HouseFileError, Rect, Star, check, generate, load, save
from vitruvius.logic.dataset.splits import TEST, TRAINING, VALIDATION
from vitruvius.logic.house.promises import OLD_PROMISES
from vitruvius.sim.environment.arguments import BANK

GRAMMAR_AND_LEAST_MOST_ROOMS = {
    "test-v1": ("family", 2, 6),
    "home-test-v1": ("home", 4, 10),
    "large-test-v1": ("family", 8, 12),
    "home-large-test-v1": ("home", 8, 12),
}

OPENS = OLD_PROMISES["home"].opens | {"bedroom": ("bathroom", "storage")}
"""Promises of homes without a newer one: the banks may have storage behind a bedroom."""

PROMISED = {
    # This bank is older than the promise that fronts are clear, which 52 of its houses do not keep.
    "test-v1": replace(OLD_PROMISES["family"], clear_front=()),
    # This bank is older than the sizes of some rooms.
    "home-test-v1": replace(
        OLD_PROMISES["home"],
        room_area=OLD_PROMISES["home"].room_area
        | {"hall": (3.0, 11.0), "living": (15.0, 36.0), "bathroom": (3.4, 9.5), "storage": (1.2, 6.0)},
        narrowest=OLD_PROMISES["home"].narrowest | {"hall": 1.5, "kitchen": 2.0},
        opens=OPENS,
    ),
    "large-test-v1": OLD_PROMISES["family"],
    "home-large-test-v1": replace(OLD_PROMISES["home"], opens=OPENS),
}


@pytest.fixture(scope="module")
def frozen():
    """Return the houses of each bank; reading them compares their hash."""
    return {name: benchmark(name) for name in BANKS}


@pytest.fixture(scope="module")
def bank(frozen):
    return frozen["test-v1"]


@pytest.mark.parametrize("name", BANKS)
def test_a_frozen_bank_is_256_houses_of_a_grammar_with_each_number_of_rooms_in_turn(name, frozen):
    grammar, least, most = GRAMMAR_AND_LEAST_MOST_ROOMS[name]
    turns = [least + i % (most - least + 1) for i in range(256)]
    assert [len(house.counted) for house in frozen[name]] == turns
    assert {house.provenance.grammar for house in frozen[name]} == {grammar}
    assert all(house.provenance.seed in TEST for house in frozen[name])


@pytest.mark.parametrize("name", BANKS)
def test_its_houses_keep_their_promises_and_are_all_different(name, frozen):
    assert not any(check(house, PROMISED[name]) for house in frozen[name][::16])
    assert len(set(map(geometry_hash, frozen[name]))) == 256


def test_a_bank_is_named_where_a_house_file_may_stand_and_a_misspelt_name_is_shown_the_right_one(frozen):
    assert named("home-test-v1") == frozen["home-test-v1"]
    with pytest.raises(HouseFileError, match=r"no bank home-test: did you mean home-test-v1\?.*house file"):
        named("home-test")


def test_all_houses_of_homes_have_a_hub_so_that_targets_may_lie_in_it(frozen):
    assert all(house.hub for name in ("home-test-v1", "home-large-test-v1") for house in frozen[name])


def test_the_seeds_set_apart_are_apart():
    assert not set(TRAINING[:: 10**6]) & set(VALIDATION[:: 10**6]) & set(TEST[:: 10**6])
    assert TRAINING.stop == VALIDATION.start
    assert VALIDATION.stop == TEST.start
    assert TEST.stop == 2**31  # the generator takes no seed from there on


def test_another_bank_in_its_place_is_refused(bank, tmp_path, monkeypatch):
    save(bank[:2], tmp_path / "test-v1.jsonl.gz")
    monkeypatch.setattr(banks, "benchmark_path", lambda name: tmp_path / f"{name}.jsonl.gz")
    with pytest.raises(HouseFileError, match="not the held-out set"):
        benchmark()


def test_houses_of_the_test_seeds_or_of_a_test_houses_shape_are_not_learnt_from(bank, frozen):
    seeded = House.of_star(
        Star(Rect(0, 0, 5, 5)), provenance=msgspec.structs.replace(bank[0].provenance, index=10**6)
    )
    nameless = msgspec.structs.replace(bank[7], provenance=None)
    home = msgspec.structs.replace(frozen["home-test-v1"][7], provenance=None)
    innocent = House.of_star(Star(Rect(0, 0, 5, 5)))
    require_training([innocent], "mine.jsonl")
    with pytest.raises(HouseFileError, match=r"mine.jsonl: house 1: its seed 2000000000 is reserved"):
        require_training([innocent, seeded], "mine.jsonl")
    for house, where in ((nameless, "test-v1"), (home, "home-test-v1")):
        with pytest.raises(HouseFileError, match=rf"mine.jsonl: house 1: it is in the held-out set {where}"):
            require_training([innocent, house], "mine.jsonl")


def test_training_in_the_benchmark_bank_is_refused_before_anything_is_written(bank, tmp_path):
    save(bank[:2], tmp_path / "mine.jsonl")
    with pytest.raises(HouseFileError, match="reserved for evaluation"):
        Train(tmp_path / "mine.jsonl", out=tmp_path / "out", learning=PQNConfig(steps=1)).run()
    assert not (tmp_path / "out").exists()


def test_the_houses_that_come_with_the_simulator_may_be_learnt_from_and_have_a_kitchen():
    """A task may ask for one."""
    houses = load(BANK)
    assert len(houses) == 32
    require_training(houses, BANK)
    assert not any(check(house) for house in houses)
    assert all("kitchen" in [room.type for room in house.star.rooms] for house in houses)


@pytest.mark.parametrize(
    ("path", "request_"),
    [
        (banks.benchmark_path("test-v1"), {"rooms": 2, "seed": TEST.start}),
        (BANK, {"rooms": 4}),
    ],
)
def test_todays_rules_make_the_houses_of_the_banks_again_where_the_solvers_are_the_same(path, request_):
    first, [again] = load(path)[0], generate(**request_)
    assert again.provenance
    assert first.provenance
    if again.provenance.versions != first.provenance.versions:
        pytest.skip("other versions of the solvers than the bank's: it stays as it was made")
    assert geometry_hash(again) == geometry_hash(first)
