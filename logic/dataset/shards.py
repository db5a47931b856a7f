"""Shards of a set: each is made whole or not at all, and one that is there is verified."""

import hashlib
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path

from logic.dataset.card import described
from logic.dataset.formats import in_groups, read, written
from logic.dataset.rows import LIMIT, Row, house_of, house_row, limit_row
from logic.dataset.sets import SET, Held, Manifest, Set, Shard, finish, read_set
from logic.errors import HouseFileError, Killed, MissingProgram, RequestError
from logic.house.house import House
from logic.workers.series import HouseSeries

Mapper = Callable[[Callable[[Shard], Held], list[Shard]], Iterable[Held]]
"""As the built-in ``map``."""

KILLS = 3
"""Times that a solver process may be killed from outside at one house."""


def make(
    folder: Path,
    of: Set,
    shard: Shard,
    series: HouseSeries,
    workers: int = 1,
    replace: bool = False,
    report: Callable[[int], None] = lambda rows: None,
) -> bool:
    """Make a shard; whether it was not there. ``report`` hears of rows as they are made.

    Raises ``RequestError`` if its place holds something else (which goes with ``replace``), and what
    ``generate`` raises but for limits of a house, which are rows.
    """
    path = folder / shard.place
    if path.exists():
        try:
            held(folder, of, shard)
        except ValueError as error:
            if not replace:
                why = f"--out {folder}: {shard.place} holds something else than its shard ({error})"
                raise RequestError(f"{why}: name another folder, or add --replace to lose it") from None
        else:
            return False
    try:
        with written(path, of.files) as write:
            for group in in_groups(_rows(of, shard, series, workers)):
                write(group)
                report(len(group))
    except FileNotFoundError:
        if not path.exists():  # else another process made it, and took our half for what a kill had left
            raise
    return True


def make_on_node(folder: Path, of: Set, replace: bool, shard: Shard) -> bool:
    """``make`` by another machine. Raises ``MissingProgram`` if it would make something else."""
    if read_set(folder) != of:
        raise MissingProgram(f"{folder}: the set is not there: the folder must be one that all nodes share")
    series = of.series(folder)
    versions, _ = series.described()
    for name, version in of.versions.items():
        if (own := versions.get(name)) != version:
            raise MissingProgram(f"houses of the set are made by {name} {version}, not {own}")
    return make(folder, of, shard, series, replace=replace)


def _rows(of: Set, shard: Shard, series: HouseSeries, workers: int) -> Iterator[Row]:
    """The rows of a shard, a house that a killed process worked on again."""
    kills, indices = 0, shard.indices
    while indices:
        for made in series.outcomes(shard.seed, indices, workers):
            if isinstance(made, Killed):
                if (kills := kills + 1) == KILLS:
                    raise made
                break
            kills, index, indices = 0, indices[0], indices[1:]
            if isinstance(made, House):
                yield house_row(made)
            else:
                yield limit_row(of.row_source(shard.seed, index), _why(str(made), series.late(index)))


def _why(said: str, late: str) -> str:
    """What limit a house ended in, without what it was at work on, which depends on the machine."""
    return late if said.startswith(late) else said.partition("\n")[0].partition(". ")[0]


def held(folder: Path, of: Set, shard: Shard) -> Held:
    """What a shard's file holds. Raises ``ValueError`` if that is not what it is to hold."""
    path = folder / shard.place
    limits, number, digest = list[int](), 0, hashlib.sha256()
    for number, row in enumerate(read(path), 1):
        if number > len(shard.indices):
            raise ValueError(f"it has more rows than {len(shard.indices)}")
        said = of.row_source(shard.seed, shard.indices[number - 1])
        if row != _made_again(row, said, of):
            raise ValueError(f"row {number - 1} is not that of {said['id']}")
        if row["verdict"] == LIMIT:
            limits.append(number - 1)
        digest.update(f"{row['sha256'] or ''}\n".encode())
    if number < len(shard.indices):
        raise ValueError(f"it has {number} of {len(shard.indices)} rows")
    with path.open("rb") as file:
        whole = hashlib.file_digest(file, "sha256").hexdigest()
    size = path.stat().st_size
    return Held(shard.place.as_posix(), shard.split, number, limits, size, whole, digest.hexdigest())


def _made_again(row: Row, said: Row, of: Set) -> Row | None:
    """The row that its house has, or its limit; None where it has neither."""
    try:
        house = house_of(row | said, of.versions, of.promises)
        return house_row(house) if house else limit_row(said, str(row["why"]))
    except (KeyError, TypeError, ValueError):
        return None


def missing(folder: Path, of: Set) -> list[Shard]:
    """The shards that are not there."""
    there = {path.name for path in (folder / "data").glob("*")}
    return [shard for shard in of.divided() if shard.place.name not in there]


def verified(folder: Path, of: Set, shard: Shard) -> Held:
    """``held``. Raises ``HouseFileError`` if a shard's file is not what it is to be."""
    try:
        return held(folder, of, shard)
    except ValueError as error:
        raise HouseFileError(f"{folder / shard.place}: is no shard of the set: {error}") from None


def complete(folder: Path, of: Set, each: Mapper = map) -> Manifest | None:
    """Write the manifest if all shards are there, and verify them before; None where some are missing.

    ``each`` calls what verifies a shard. Raises ``HouseFileError`` for one that is not what it is to be.
    """
    if missing(folder, of):
        return None
    files = list(each(partial(verified, folder, of), of.divided()))
    limits = sum(len(each.limits) for each in files)
    rows = sum(each.rows for each in files)
    digest = hashlib.sha256((folder / SET).read_bytes()).hexdigest()
    manifest = Manifest("vitruvius-manifest-1", digest, rows - limits, limits, files)
    finish(folder, described(of, manifest))
    return manifest
