"""Set as a list of houses, read on access, with only one group of rows in memory."""

import hashlib
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import accumulate, islice
from pathlib import Path
from typing import Any, BinaryIO, SupportsIndex, overload

import msgspec

from vitruvius.logic.dataset.formats import GROUP, read
from vitruvius.logic.dataset.parquet import MAX_FILE_BYTES
from vitruvius.logic.dataset.rows import Row, house_of, house_sha256
from vitruvius.logic.dataset.sets import MANIFEST, SET, Held, Set, inside, read_manifest, read_set
from vitruvius.logic.dataset.splits import SPLITS
from vitruvius.logic.errors import HouseFileError, RequestError
from vitruvius.logic.files.gallery import Houses
from vitruvius.logic.files.house_files import load as load_file
from vitruvius.logic.house.house import House
from vitruvius.logic.opener import content_of, opened
from vitruvius.logic.readers.world import MOST_BYTES, read_world
from vitruvius.logic.spelling import numbered, unknown

WORLDS = (".json", ".geojson", ".geojsonl", ".geojsons")
"""Suffixes of the names of plans that are read as houses to simulate."""


class Counts(msgspec.Struct, frozen=True):
    """Numbers of shards, rows, houses and limits in a set."""

    shards: int
    rows: int
    houses: int
    limits: int

    def __str__(self) -> str:
        """Return the numbers as in ``5 shards, 17 rows: 16 houses, 1 limit``."""
        shards, rows = numbered(self.shards, "shard"), numbered(self.rows, "row")
        return f"{shards}, {rows}: {numbered(self.houses, 'house')}, {numbered(self.limits, 'limit')}"


class HouseSet(Sequence[House]):
    """Houses of a complete set, or of some of its splits, in order, without rows of limits.

    Iteration reads file after file. Indexing reads the group of rows around the house.
    """

    def __init__(self, folder: str | Path, *splits: str) -> None:
        """Read the manifest.

        Raises ``HouseFileError`` if there is none, and ``RequestError`` for an unknown split.
        """
        self.folder = Path(folder)
        self.of, self._shards = _opened(self.folder)
        if wrong := [split for split in splits if split not in self.of.houses]:
            raise RequestError(f"{folder}: {unknown('split', wrong[0], self.of.houses)}")
        self._shards = [each for each in self._shards if each.split in (splits or SPLITS)]
        self._ends = list(accumulate(each.rows - len(each.limits) for each in self._shards))
        self._group: tuple[Held, int, list[Row]] | None = None
        self._compared = set[str]()

    @property
    def splits(self) -> set[str]:
        """Splits of its houses."""
        return {each.split for each in self._shards}

    @property
    def hash(self) -> str:
        """Hash that names the houses in their order: SHA-256 of their hashes in the manifest."""
        return hashlib.sha256("\n".join(each.rows_sha256 for each in self._shards).encode()).hexdigest()

    def __len__(self) -> int:
        """Return the number of houses."""
        return self._ends[-1] if self._ends else 0

    def __iter__(self) -> Iterator[House]:
        """Yield all houses, file after file."""
        for shard in self._shards:
            for row in self._rows(shard):
                if row.get("house") is not None:
                    yield self._house(row)

    def verified(self) -> Iterator[House]:
        """Yield all houses. Raises ``HouseFileError`` for a house that differs from its row's SHA-256."""
        for shard in self._shards:
            for row in self._rows(shard):
                if row.get("house") is not None:
                    house = self._house(row)
                    if house_sha256(house) != row["sha256"]:
                        raise HouseFileError(
                            f"{self.folder / shard.file}: {row['id']}: its house differs from its SHA-256"
                        )
                    yield house

    def counts(self) -> Counts:
        """Return the numbers of shards, rows, houses and limits."""
        rows = sum(each.rows for each in self._shards)
        return Counts(len(self._shards), rows, len(self), rows - len(self))

    @overload
    def __getitem__(self, index: SupportsIndex) -> House: ...
    @overload
    def __getitem__(self, index: slice) -> Houses: ...
    def __getitem__(self, index: SupportsIndex | slice) -> House | Houses:
        """Return the house at an index, or a list of the houses of a slice."""
        places = range(len(self))[index]
        if isinstance(places, range):
            return Houses(self[place] for place in places)
        number = bisect_right(self._ends, places)
        shard = self._shards[number]
        row = places - (self._ends[number - 1] if number else 0)
        for limit in shard.limits:
            row += limit <= row
        return self._house(self._row(shard, row))

    def rows(self) -> Iterator[Row]:
        """Yield all rows, with those of limits."""
        for shard in self._shards:
            yield from self._rows(shard)

    def _row(self, shard: Held, place: int) -> Row:
        first = place - place % GROUP
        group = self._group  # another thread may replace it meanwhile
        if group is None or group[:2] != (shard, first):
            self._group = group = shard, first, list(islice(self._rows(shard, first), GROUP))
        if place - first >= len(group[2]):
            raise HouseFileError(f"{self.folder / shard.file}: has fewer rows than {MANIFEST} states")
        return group[2][place - first]

    def _rows(self, shard: Held, first: int = 0) -> Iterator[Row]:
        """Yield the rows of a shard from number ``first`` on.

        The file is compared with the manifest before the first row, and the rows after the last one. Raises
        ``HouseFileError`` for a difference.
        """
        path = self.folder / shard.file
        try:
            self._compare(shard)
            if first:
                yield from read(path, first)
            else:
                yield from _as_stated(read(path), shard)
        except FileNotFoundError:
            raise HouseFileError(f"{path}: is missing: regenerate it with generate --shard") from None
        except OSError as error:
            raise HouseFileError(f"{path}: cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise HouseFileError(f"{path}: is not a shard of a set: {error}") from None

    def _compare(self, shard: Held) -> None:
        """Compare the file of a shard with the manifest, once. Raises ``ValueError`` if they differ."""
        if shard.file in self._compared:
            return
        path = inside(self.folder, shard.file)
        size = path.stat().st_size
        with opened(path, MAX_FILE_BYTES, unpack=False) as file:
            if size != shard.bytes:
                raise ValueError(f"it has {size:,} bytes, but {MANIFEST} states {shard.bytes:,}")
            digest = hashlib.file_digest(file, "sha256")  # pyright: ignore[reportArgumentType]
            if digest.hexdigest() != shard.sha256:
                raise ValueError(f"its SHA-256 differs from the one in {MANIFEST}")
        self._compared.add(shard.file)

    def _house(self, row: Row) -> House:
        try:
            house = house_of(row, self.of.versions, self.of.promises)
        except ValueError as error:
            raise HouseFileError(f"{self.folder}: {row.get('id')}: is not a row of a set: {error}") from None
        if house is None:
            raise HouseFileError(f"{self.folder}: {row['id']}: is a limit, but {MANIFEST} states a house")
        return house


def _as_stated(rows: Iterator[Row], shard: Held) -> Iterator[Row]:
    """Yield the rows of a shard.

    Raises ``ValueError`` after the last row if the manifest states other rows.
    """
    number, limits, digest = 0, list[int](), hashlib.sha256()
    for number, row in enumerate(rows, 1):
        if row.get("house") is None:
            limits.append(number - 1)
        digest.update(f"{row.get('sha256') or ''}\n".encode())
        yield row
    if number != shard.rows:
        raise ValueError(f"it has {number:,} rows, but {MANIFEST} states {shard.rows:,}")
    if (limits, digest.hexdigest()) != (shard.limits, shard.rows_sha256):
        raise ValueError(f"its rows are not those of {MANIFEST}")


def _opened(folder: Path) -> tuple[Set, list[Held]]:
    """Return the record of a set and its shards."""
    of, manifest = read_set(folder), read_manifest(folder)
    if of is None:
        raise HouseFileError(f"{folder}: is not a set of houses: it has no {SET}")
    if manifest is None:
        raise HouseFileError(f"{folder}: is an incomplete set: it has no {MANIFEST} yet")
    return of, manifest.shards


def load(path: str | Path, file: BinaryIO | None = None, **options: Any) -> Sequence[House]:
    """Return the houses of a set's folder, which are read on access, or of a house file.

    A plan of HouseExpo (``.json``) or GeoJSON, with walls at any angle, is one house to simulate. See
    ``HouseSet``, ``logic.files.house_files.load`` and ``logic.readers.world``.
    """
    path = Path(path)
    if file is None and (path / SET).is_file():
        return HouseSet(path)
    world = _world(path) if file is None and path.suffix.lower() in WORLDS else None
    return Houses([world]) if world else load_file(path, file, **options)


def _world(path: Path) -> House | None:
    """Return the house of a file that holds a plan, or None for another or unreadable file."""
    try:
        return read_world(content_of(path, MOST_BYTES), path)
    except OSError:
        return None
