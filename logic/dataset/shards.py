"""Shards of a set: each is written whole or not at all, and an existing one is verified."""

import hashlib
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path

from vitruvius.logic.dataset import card
from vitruvius.logic.dataset.formats import in_groups, read, written
from vitruvius.logic.dataset.rows import LIMIT, Row, house_of, house_row, limit_row
from vitruvius.logic.dataset.sets import SET, Held, Manifest, Set, Shard, finish, read_set
from vitruvius.logic.errors import HouseFileError, Killed, MissingProgram, RequestError
from vitruvius.logic.house.house import House
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.pool import described, late, outcomes

Mapper = Callable[[Callable[[Shard], Held], list[Shard]], Iterable[Held]]
"""Function with the signature of the built-in ``map``."""

KILLS = 3
"""Number of kills from outside at the same house after which the set stops."""


def make(
    folder: Path,
    of: Set,
    shard: Shard,
    request: HouseRequest,
    workers: int = 1,
    replace: bool = False,
    report: Callable[[int], None] = lambda rows: None,
) -> bool:
    """Generate a shard. Return False if a correct one exists already.

    ``report`` is called with the number of rows as they are made. Raises ``RequestError`` if another file is
    in its place, unless ``replace`` is True. Raises the errors of ``generate``, except limits of a house,
    which become rows.
    """
    path = folder / shard.place
    if path.exists():
        try:
            held(folder, of, shard)
        except ValueError as error:
            if not replace:
                why = f"--out {folder}: {shard.place} is not the shard of this set ({error})"
                raise RequestError(
                    f"{why}: choose another folder, or add --replace to overwrite it"
                ) from None
        else:
            return False
    try:
        with written(path, of.files) as write:
            for group in in_groups(_rows(of, shard, request, workers)):
                write(group)
                report(len(group))
    except FileNotFoundError:
        if not path.exists():  # otherwise another process made it and removed our file
            raise
    return True


def make_on_node(folder: Path, of: Set, replace: bool, shard: Shard) -> bool:
    """Call ``make`` on another machine.

    Raises ``MissingProgram`` if the machine would generate other houses.
    """
    if read_set(folder) != of:
        raise MissingProgram(f"{folder}: the set is missing: all nodes must share this folder")
    request = of.request_in(folder)
    versions, _ = described(request)
    for name, version in of.versions.items():
        if (own := versions.get(name)) != version:
            raise MissingProgram(f"houses of the set need {name} {version}, not {own}")
    return make(folder, of, shard, request, replace=replace)


def _rows(of: Set, shard: Shard, request: HouseRequest, workers: int) -> Iterator[Row]:
    """Yield the rows of a shard. A house whose process was killed is generated again."""
    kills, indices = 0, shard.indices
    while indices:
        for made in outcomes(request, shard.seed, indices, workers):
            if isinstance(made, Killed):
                if (kills := kills + 1) == KILLS:
                    raise made
                break
            kills, index, indices = 0, indices[0], indices[1:]
            if isinstance(made, House):
                yield house_row(made)
            else:
                yield limit_row(of.row_source(shard.seed, index), _why(str(made), late(request, index)))


def _why(said: str, late: str) -> str:
    """Return the limit of a house, without the current work of the process, which depends on the machine."""
    return late if said.startswith(late) else said.partition("\n")[0].partition(". ")[0]


def held(folder: Path, of: Set, shard: Shard) -> Held:
    """Return the contents of a shard's file. Raises ``ValueError`` if they differ from the shard's."""
    path = folder / shard.place
    limits, number, digest = list[int](), 0, hashlib.sha256()
    for number, row in enumerate(read(path), 1):
        if number > len(shard.indices):
            raise ValueError(f"it has more rows than {len(shard.indices)}")
        said = of.row_source(shard.seed, shard.indices[number - 1])
        if row != _made_again(row, said, of):
            raise ValueError(f"row {number - 1} is not the row of {said['id']}")
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
    """Return the row for the house or limit in a row, or None if the row has neither."""
    try:
        house = house_of(row | said, of.versions, of.promises)
        return house_row(house) if house else limit_row(said, str(row["why"]))
    except (KeyError, TypeError, ValueError):
        return None


def missing(folder: Path, of: Set) -> list[Shard]:
    """Return the shards whose files are missing."""
    there = {path.name for path in (folder / "data").glob("*")}
    return [shard for shard in of.divided() if shard.place.name not in there]


def verified(folder: Path, of: Set, shard: Shard) -> Held:
    """Return ``held``. Raises ``HouseFileError`` if the contents of the file differ from the shard's."""
    try:
        return held(folder, of, shard)
    except ValueError as error:
        raise HouseFileError(f"{folder / shard.place}: is not a shard of the set: {error}") from None


def complete(folder: Path, of: Set, each: Mapper = map) -> Manifest | None:
    """Verify all shards and write the manifest; return None if shards are missing.

    ``each`` maps the verification over the shards. Raises ``HouseFileError`` for a wrong shard.
    """
    if missing(folder, of):
        return None
    files = list(each(partial(verified, folder, of), of.divided()))
    limits = sum(len(each.limits) for each in files)
    rows = sum(each.rows for each in files)
    digest = hashlib.sha256((folder / SET).read_bytes()).hexdigest()
    manifest = Manifest("vitruvius-manifest-1", digest, rows - limits, limits, files)
    finish(folder, card.described(of, manifest))
    return manifest
