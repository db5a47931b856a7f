"""A set as a list of houses that are read as they are asked for: no more than a group of rows is held."""

import hashlib
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from itertools import accumulate, islice
from pathlib import Path
from typing import Any, BinaryIO, SupportsIndex, overload

from logic.dataset.formats import GROUP, read
from logic.dataset.rows import Row, house_of
from logic.dataset.sets import MANIFEST, SET, Held, Set, read_manifest, read_set
from logic.dataset.splits import SPLITS
from logic.errors import HouseFileError, RequestError
from logic.house.files import load as load_file
from logic.house.gallery import Houses
from logic.house.house import House
from logic.opener import content_of
from logic.readers.world import MOST_BYTES, read_world
from logic.spelling import unknown

WORLDS = (".json", ".geojson")
"""How the names of plans end that are read as houses to simulate."""


class HouseSet(Sequence[House]):
    """The houses of a whole set, or of some of its splits, in their order; rows of limits have none.

    Iterating reads file after file. By its place a house is read with the group of rows around it.
    """

    def __init__(self, folder: str | Path, *splits: str) -> None:
        """Read the manifest. Raises ``HouseFileError`` where there is none, ``RequestError`` for a split that
        it does not have.
        """
        self.folder = Path(folder)
        self.of, self._shards = _opened(self.folder)
        if wrong := [split for split in splits if split not in self.of.houses]:
            raise RequestError(f"{folder}: {unknown('split', wrong[0], self.of.houses)}")
        self._shards = [each for each in self._shards if each.split in (splits or SPLITS)]
        self._ends = list(accumulate(each.rows - len(each.limits) for each in self._shards))
        self._group: tuple[Held, int, list[Row]] | None = None

    @property
    def splits(self) -> set[str]:
        """Those that its houses are of."""
        return {each.split for each in self._shards}

    @property
    def hash(self) -> str:
        """A name for the houses in their order: SHA-256 of the hashes that the manifest has of them."""
        return hashlib.sha256("\n".join(each.rows_sha256 for each in self._shards).encode()).hexdigest()

    def __len__(self) -> int:
        """How many houses."""
        return self._ends[-1] if self._ends else 0

    def __iter__(self) -> Iterator[House]:
        """All houses, file after file."""
        for shard in self._shards:
            for row in self._rows(shard):
                if row["house"] is not None:
                    yield self._house(row)

    @overload
    def __getitem__(self, index: SupportsIndex) -> House: ...
    @overload
    def __getitem__(self, index: slice) -> Houses: ...
    def __getitem__(self, index: SupportsIndex | slice) -> House | Houses:
        """A house by its place; of a slice, the list of its houses."""
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
        """All rows, those of limits too."""
        for shard in self._shards:
            yield from self._rows(shard)

    def _row(self, shard: Held, place: int) -> Row:
        first = place - place % GROUP
        group = self._group  # another thread may take another one meanwhile
        if group is None or group[:2] != (shard, first):
            self._group = group = shard, first, list(islice(self._rows(shard, first), GROUP))
        return group[2][place - first]

    def _rows(self, shard: Held, first: int = 0) -> Iterator[Row]:
        path = self.folder / shard.file
        try:
            yield from read(path, first)
        except FileNotFoundError:
            raise HouseFileError(f"{path}: is gone: the set is made again by generate --shard") from None
        except ValueError as error:
            raise HouseFileError(f"{path}: is no shard of a set: {error}") from None

    def _house(self, row: Row) -> House:
        house = house_of(row, self.of.versions, self.of.promises)
        assert house is not None, "rows of limits are passed over"
        return house


def _opened(folder: Path) -> tuple[Set, list[Held]]:
    """What a folder is a set of, and its shards."""
    of, manifest = read_set(folder), read_manifest(folder)
    if of is None:
        raise HouseFileError(f"{folder}: is no set of houses: it has no {SET}")
    if manifest is None:
        raise HouseFileError(f"{folder}: is a set that is not whole: it has no {MANIFEST} yet")
    return of, manifest.shards


def load(path: str | Path, file: BinaryIO | None = None, **options: Any) -> Sequence[House]:
    """The houses of a set's folder, which are read as they are asked for, or of a house file; a plan of
    HouseExpo (``.json``) or GeoJSON, with walls at any angle, is one house to simulate.

    See ``HouseSet``, ``logic.house.files.load`` and ``logic.readers.world``.
    """
    path = Path(path)
    if file is None and (path / SET).is_file():
        return HouseSet(path)
    world = _world(path) if file is None and path.suffix.lower() in WORLDS else None
    return Houses([world]) if world else load_file(path, file, **options)


def _world(path: Path) -> House | None:
    """Return the house that a file's plan is; None for another file, and for one that cannot be read."""
    try:
        return read_world(content_of(path, MOST_BYTES), path)
    except OSError:
        return None
