"""Sets for a comparison: houses of a grammar, files of houses, or a folder with plans of other programs."""

import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.realism.figures import PlanFigures, measured
from vitruvius.logic import generate, load
from vitruvius.logic.errors import HouseFileError, RequestError
from vitruvius.logic.request.given_plan import read_plan

HOUSES = (".jsonl", ".gz")
"""File name endings of files of houses."""


def plans_of(source: str, rooms: Sequence[int], count: int, seed: int) -> list[PlanFigures]:
    """Return the plans of a file or a folder, or ``count`` houses of a grammar for each number of rooms."""
    path = Path(source)
    if path.is_file():
        found = list(_read(path))
    elif path.is_dir() and not any(path.glob("*.lp")):
        found = [plan for file in sorted(path.iterdir()) if file.is_file() for plan in _read(file)]
    else:
        found = made(source, rooms, count, seed)
    if len(found) < 2:
        raise RequestError(
            f"{source}: {len(found)} plans were read, but a set needs 2 or more: name more plans"
        )
    return found


def made(grammar: str | Path, rooms: Sequence[int], count: int, seed: int) -> list[PlanFigures]:
    """Return ``count`` houses of a grammar for each number of rooms."""
    return [measured(house) for n in rooms for house in generate(n, grammar=grammar, seed=seed, count=count)]


def _read(path: Path) -> Iterator[PlanFigures]:
    """Yield the plans of a file.

    A file that is no plan, such as rooms that do not touch, is skipped with a message.
    """
    if path.name.endswith(HOUSES):
        yield from map(measured, load(path))
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield measured(read_plan(path))
    except (HouseFileError, RequestError) as error:
        print(f"skipped: {path.name}: {error}", flush=True)
