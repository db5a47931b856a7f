"""Banks of houses: seeds reserved for training, validation and test, and the frozen banks of the benchmark.

A house is a function of its grammar, request, seed and index, so different seeds give different houses. This
holds for all grammars. Houses of `vitruvius generate --seed 0` and the seeds after it are for training.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import msgspec

from vitruvius.logic import House, HouseFileError, Houses, HouseSet, HouseStream, RequestError, load
from vitruvius.logic.dataset.splits import TEST, TRAINING
from vitruvius.logic.opener import STANDARD
from vitruvius.logic.spelling import unknown


class FrozenBank(NamedTuple):
    """256 houses of a grammar from seeds of ``TEST``: house i has ``rooms[i % len(rooms)]`` rooms."""

    grammar: str
    rooms: range
    hash: str
    """Hash of the houses: see ``bank_hash``. A bank is frozen: other houses get another name."""


BANKS = {
    "test-v1": FrozenBank(
        "family", range(2, 7), "9b80dfd60e196e70935b5a2befd59fce20acd0a206309273cbdc237d33f397a9"
    ),
    "home-test-v1": FrozenBank(
        "home", range(4, 11), "5a8daf1d35f302516c96b8b2459da00515caf1a6eb5ed8b60b699e65d7acd5d4"
    ),
    "large-test-v1": FrozenBank(
        "family", range(8, 13), "590c7346f4cb94d0385f2c70261cb217411579a10bb6d27d0eeeeeb7c1274823"
    ),
    "home-large-test-v1": FrozenBank(
        "home", range(8, 13), "dc346454637e41b95cd82eb3adbd6fd4db7f54feea72af9208baa7d3de7cea50"
    ),
}
"""Banks of the benchmark, by name; each is a file of ``agent/houses``."""

PAPER_HOUSE = "paper-house"
"""Value of ``sim.environment.arguments.PAPER_HOUSE``, without an import of Taichi."""

NAME = "test-v1"
"""Bank that agents are evaluated on by default."""


def geometry_hash(house: House) -> str:
    """Return a hash of the house's shape: the same rooms, doors and furniture give the same, in any format.

    The hash of a star covers its ``floor`` and ``rooms``, by which ``test-v1`` was frozen.
    """
    star = house.star if house.main_room else None
    shape = (star.floor, star.rooms) if star else (house.rooms, house.doors, house.windows)
    return hashlib.sha256(msgspec.json.encode(shape)).hexdigest()


def bank_hash(houses: Iterable[House]) -> str:
    """Return a hash of the houses' shapes in their order, in whatever file they are.

    A set and a stream have a hash of their own, as they may have more houses than can be read.
    """
    if isinstance(houses, HouseSet | HouseStream):
        return houses.hash
    return hashlib.sha256("\n".join(map(geometry_hash, houses)).encode()).hexdigest()


def house_key(house: House) -> int:
    """Return the start of ``geometry_hash`` as a 64-bit number, unique among a million houses."""
    return int.from_bytes(bytes.fromhex(geometry_hash(house))[:8], "big", signed=True)


def benchmark_path(name: str = NAME) -> Path:
    """Return the path of a bank of ``BANKS``, in a checkout and in an installed wheel."""
    return Path(__file__).with_name("houses") / f"{name}.jsonl.gz"


def benchmark(name: str = NAME) -> list[House]:
    """Return the houses of a bank of ``BANKS``, to evaluate agents on.

    Raises ``HouseFileError`` if there is no such bank, or if its houses are not the frozen ones.
    """
    if name not in BANKS:
        raise HouseFileError(unknown("bank", name, BANKS))
    return Houses(_frozen(benchmark_path(name), BANKS[name].hash))


@cache
def _frozen(path: Path, frozen: str) -> Houses:
    """Return the houses of a file if they have this hash.

    Each process reads them once, as they are frozen.
    """
    houses = Houses(load(path))
    if bank_hash(houses) != frozen:
        raise HouseFileError(f"{path}: not the held-out set ({frozen[:12]}). Restore it from Git")
    return houses


@cache
def _tested() -> Mapping[str, str]:
    """Return the bank of each house of ``BANKS``, by the house's ``geometry_hash``."""
    return {geometry_hash(house): bank for bank in BANKS for house in benchmark(bank)}


def named(houses: str | Path) -> list[House]:
    """Return the houses of a house file, of a bank of ``BANKS`` by its name, or of ``PAPER_HOUSE``.

    Raises ``HouseFileError``.
    """
    from vitruvius.sim.environment.arguments import house_list  # here: it imports Taichi

    if str(houses) in BANKS:
        return benchmark(str(houses))
    if str(houses) == PAPER_HOUSE:
        return house_list(PAPER_HOUSE)
    if Path(houses) != STANDARD and not Path(houses).suffix and not Path(houses).exists():
        known = unknown("bank", houses, [*BANKS, PAPER_HOUSE])
        raise HouseFileError(f"{known}; or name a house file, such as houses.jsonl")
    return list(load(houses))


def require_places(targets: str, houses: str | Path) -> None:
    """Raise ``RequestError`` for a task of the paper in another house, which lacks its target places."""
    from vitruvius.sim.tasks.tasks import PAPER_TASKS

    if targets in PAPER_TASKS and str(houses) != PAPER_HOUSE:
        raise RequestError(f"{targets}: its targets are points of the house {PAPER_HOUSE}, not of {houses}")


def require_training(houses: Sequence[House], name: str | Path) -> None:
    """Raise ``HouseFileError`` if a house is reserved for evaluation.

    A house is reserved by its seed, or by its shape in any of ``BANKS``, whatever seed it states.
    """
    for index, why in enumerate(kept(houses)):
        if why:
            raise HouseFileError(
                f"{name}: house {index}: {why} reserved for evaluation. Train on houses with seeds below "
                f"{TRAINING.stop}"
            )


def require_training_seeds(houses: HouseSet | HouseStream) -> None:
    """Raise ``RequestError`` for a set or a stream with seeds that are not for training."""
    if isinstance(houses, HouseSet) and houses.splits != {"train"}:
        raise RequestError('training uses the split train of a set: HouseSet(folder, "train")')
    if isinstance(houses, HouseStream) and houses.seed not in TRAINING:
        raise RequestError(
            f"seed {houses.seed} of a stream: train on houses with seeds below {TRAINING.stop}"
        )


def kept(houses: Sequence[House]) -> Iterator[str]:
    """Yield for each house the reason why it is reserved for evaluation, or an empty string.

    No agent is trained on reserved houses.
    """
    tested = _tested()
    for house in houses:
        seed = house.provenance.seed if house.provenance else None
        # Without this test for None, ``in`` would search the range number by number.
        if seed is not None and seed in TEST:
            yield f"its seed {seed} is"
        else:
            bank = tested.get(geometry_hash(house))
            yield f"it is in the held-out set {bank}," if bank else ""
