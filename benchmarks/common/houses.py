"""Houses that several studies use."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

from benchmarks.common.processes import say
from vitruvius.agent.banks import bank_hash
from vitruvius.logic import House, generate, load, save
from vitruvius.logic.errors import VitruviusError

INFERENCES = 10**9
"""Largest number of inferences of stage 2 for a house: more than any house takes."""

ROOMS, COUNT = (2, 3, 4, 5, 6), 205
TRAINING = "c2ea75684f2e20a7a5e345a28735399b0c29d98f65e694bcd754ae49f1b160fc"
"""Hash of the training houses: COUNT of `family` with each number of rooms, seeds 102 to 106."""


class OtherHouses(VitruviusError):
    """A file holds other houses than those that a study is based on."""

    exit_code = 1


def kept_houses(path: Path, make: Callable[[], Iterable[House]]) -> list[House]:
    """Return the houses of a file, after making the file if it does not exist."""
    if not path.exists():
        say(f"{path}: making its houses")
        save(list(make()), path)
    return list(load(path))


def by_rooms(rooms: Iterable[int], count: int, seed: int, **request: Any) -> Iterator[House]:
    """Yield ``count`` houses of each number of rooms, which is added to the seed."""
    for number in rooms:
        yield from generate(number, seed=seed + number, count=count, **request)


def training_houses(path: Path, workers: int) -> Path:
    """Return the file of the training houses, after making it if it does not exist.

    Raises ``OtherHouses``.
    """
    houses = kept_houses(path, lambda: by_rooms(ROOMS, COUNT, seed=100, workers=workers))
    if (found := bank_hash(houses)) != TRAINING:
        raise OtherHouses(f"{path}: other houses ({found[:12]}) than the study's ({TRAINING[:12]})")
    return path


def in_turns(rooms: Sequence[int], count: int, **request: Any) -> list[House]:
    """Return ``count`` houses, of which house i has ``rooms[i % len(rooms)]`` rooms.

    So every part of the list has houses of all sizes.
    """
    counts = [len(range(place, count, len(rooms))) for place in range(len(rooms))]
    series = [
        list(generate(number, count=some, workers=2, **request)) if some else []
        for number, some in zip(rooms, counts, strict=True)
    ]
    return [house for row in zip_longest(*series) for house in row if house is not None]
