"""Banks of houses: seeds set apart for training, validation and test, and the frozen bank of the benchmark.

A house is a function of its grammar, request, seed and index, so apart seeds are apart houses. That holds for
all grammars; `vitruvius generate --seed 0` and what follows it is for training.
"""

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec

from logic import House, HouseFileError, load

TRAINING, VALIDATION, TEST = range(10**9), range(10**9, 2 * 10**9), range(2 * 10**9, 2**31)
"""Seeds of the generator: to learn from, to choose settings by, and to be measured by alone."""

NAME = "test-v1.jsonl.gz"

HASH = "9b80dfd60e196e70935b5a2befd59fce20acd0a206309273cbdc237d33f397a9"
"""Of the benchmark bank: see ``bank_hash``. It is frozen: another bank gets another name."""


def geometry_hash(house: House) -> str:
    """A name for the house's shape alone: the same rooms, doors and pieces have the same, in any format.

    Of a star it is that of its ``floor`` and ``rooms``, by which the benchmark bank was frozen.
    """
    star = house.star if house.is_star else None
    shape = (star.floor, star.rooms) if star else (house.rooms, house.doors, house.windows)
    return hashlib.sha256(msgspec.json.encode(shape)).hexdigest()


def bank_hash(houses: Iterable[House]) -> str:
    """A name for the houses' shapes in their order, whatever file they are in."""
    return hashlib.sha256("\n".join(map(geometry_hash, houses)).encode()).hexdigest()


def benchmark_path() -> Path:
    """Where the benchmark bank is, in a checkout as in an installed wheel."""
    return Path(__file__).resolve().parents[1] / "benchmarks" / "houses" / NAME


def benchmark() -> list[House]:
    """The 256 houses that agents are measured in: `family`, 2 to 6 rooms; house i has 2 + i % 5.

    Raises ``HouseFileError`` where they are not those that were frozen.
    """
    houses = load(benchmark_path())
    if bank_hash(houses) != HASH:
        raise HouseFileError(f"{benchmark_path()}: not the frozen bank ({HASH[:12]}). Restore it from Git")
    return houses


def require_training(houses: Sequence[House], name: str | Path) -> None:
    """Raise ``HouseFileError`` where a house is one to be measured by: by its seed, or by its shape, whatever
    its seed is said to be.
    """
    tested = {geometry_hash(house) for house in benchmark()}
    for index, house in enumerate(houses):
        seed = house.provenance.seed if house.provenance else None
        # Without a seed the range would be searched number by number.
        reserved = seed is not None and seed in TEST
        if reserved or geometry_hash(house) in tested:
            why = f"its seed {seed} is" if reserved else "it is in the benchmark bank,"
            raise HouseFileError(
                f"{name}: house {index}: {why} kept for measuring. "
                f"Learn in houses of seeds below {TRAINING.stop}"
            )
