"""Set of houses in a folder: the record that determines its houses, its shards, and its manifest.

======================================  =====================================================================
``set.json``                            all that the houses are a function of (``Set``), written first
``grammar/NAME``                        the rules that generate the houses
``data/train-00003-of-00098.parquet``   a shard: rows, each a house (``rows.py``)
``manifest.json``                       the shards with their hashes (``Manifest``), written last
``README.md``, ``croissant.json``       the set's card, and its description for machines
======================================  =====================================================================
"""

import hashlib
import os
import re
from collections.abc import Iterator
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeVar

import msgspec

from vitruvius.logic.dataset.formats import Files
from vitruvius.logic.dataset.rows import Row, source
from vitruvius.logic.dataset.splits import SPLITS
from vitruvius.logic.errors import GrammarError, HouseFileError, RequestError
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.grammar import Grammar, find, shipped
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.opener import content_of, from_json
from vitruvius.logic.request.counts import MAX_COUNT, whole
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import unknown

Kind = TypeVar("Kind")

SET, MANIFEST, CARD, CROISSANT, DATA, GRAMMAR = (
    *("set.json", "manifest.json", "README.md", "croissant.json"),
    *("data", "grammar"),
)
"""Names of the files and folders in a set's folder."""

SHARD = re.compile(rf"({'|'.join(SPLITS)})-\d{{5,}}-of-\d{{5,}}\.(parquet|jsonl)")
"""Name of a shard's file."""

BESIDE = re.compile(r"\.(.+)\.[0-9a-f]{8}")
"""Name of a temporary file during writing, and after a kill."""

MAX_RECORD_BYTES = 1 << 26
"""Largest size of ``set.json`` and of the manifest, in bytes."""

MAX_SHARDS = 10**5
"""Largest number of shards of a set."""

MAX_SHARD_ROWS = 500_000
"""Largest number of rows of a shard, since the reader bounds the list of its row groups."""

RULES = (".lp", ".pl", ".json")
"""Suffixes of the files that are copied from a grammar's folder."""


class Shard(NamedTuple):
    """Part of a set that is generated independently: some indices of a split's seed."""

    number: int
    split: str
    seed: int
    indices: range
    place: Path
    """Path of its file, relative to the set's folder."""


class Set(msgspec.Struct, frozen=True, dict=True, forbid_unknown_fields=True):
    """Record that determines all rows of a set and their division into files."""

    format: Literal["vitruvius-set-1"]
    grammar: str
    grammar_hash: str
    request: dict[str, Any]
    """Request in the form of ``HouseRequest.to_dict``."""
    seed: int
    """Position of the seed in each split's range of seeds; for training houses it is the seed itself."""
    start: int
    """Index of the first house of each split."""
    houses: dict[str, int]
    """Number of houses of each split."""
    shards: int
    files: Files
    inferences: int
    """Largest number of Prolog inferences for a house."""
    seconds: float
    """Largest number of seconds for a house."""
    versions: dict[str, str]
    """Versions of the programs that generated the houses."""
    promises: Promises
    """Promises that the houses keep, for the check in plain geometry."""

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for values that no set has."""
        self.asked  # noqa: B018 - raises for a request that makes no sense
        splits = [split for split in self.houses if split not in SPLITS]
        if splits or not self.houses:
            raise ValueError(unknown("split", splits[0], SPLITS) if splits else "it has no split")
        whole("start", self.start, 0)
        for split, number in self.houses.items():
            whole(f"the houses of {split}", number, 1, MAX_COUNT - self.start)
        least = sum(-(-number // MAX_SHARD_ROWS) for number in self.houses.values())
        whole("shards", self.shards, least, min(MAX_SHARDS, sum(self.houses.values())))
        whole("seed", self.seed, 0, min(len(SPLITS[split]) for split in self.houses) - 1)
        if self.grammar in ("", ".", "..") or set(self.grammar) & set("/\\\0"):
            raise ValueError(f"{self.grammar!r} is not the name of a grammar")

    @cached_property
    def asked(self) -> HouseRequest:
        """Request of the set's houses, without their grammar: see ``request_in``."""
        return HouseRequest.read(self.request, inferences=self.inferences, seconds=self.seconds)

    def seed_of(self, split: str) -> int:
        """Return the seed of a split's houses."""
        return SPLITS[split][self.seed]

    def row_source(self, seed: int, index: int) -> Row:
        """Return the columns that determine a house."""
        return source(self.grammar, self.grammar_hash, self.asked.at(index).to_dict(), seed, index)

    def divided(self) -> list[Shard]:
        """Return all shards. Each split has a number of shards in proportion to its houses, at least one."""
        parts = dict.fromkeys(self.houses, 1)
        for _ in range(self.shards - len(parts)):
            largest = max(parts, key=lambda split: self.houses[split] / parts[split])
            parts[largest] += 1
        shards = list[Shard]()
        for split, number in parts.items():
            for part in range(number):
                first, last = (self.houses[split] * each // number for each in (part, part + 1))
                name = f"{split}-{part:05d}-of-{number:05d}.{self.files}"
                indices = range(self.start + first, self.start + last)
                shards.append(Shard(len(shards), split, self.seed_of(split), indices, Path(DATA, name)))
        return shards

    def request_in(self, folder: Path) -> HouseRequest:
        """Return the request of the set's houses, with the set's ``rules`` as its grammar."""
        return msgspec.structs.replace(self.asked, grammar=str(self.rules(folder).directory))

    def rules(self, folder: Path) -> Grammar:
        """Return the rules in the set, or identical shipped rules.

        Raises ``GrammarError`` if these rules differ from those that generated the set.
        """
        if self.grammar in shipped() and (own := find(self.grammar)).hash == self.grammar_hash:
            return own
        own = find(inside(folder, f"{GRAMMAR}/{self.grammar}"))
        if own.hash != self.grammar_hash:
            raise GrammarError(
                f"these are not the rules that made the set ({self.grammar_hash[:12]}), or this is another "
                f"version of vitruvius than {self.versions.get('vitruvius', 'the one that is not named')}",
                own.directory,
            )
        return own


class Held(msgspec.Struct, frozen=True):
    """Contents of a shard's file, with its name in the set's folder."""

    file: str
    split: str
    rows: int
    limits: list[int]
    """Indices, in the file, of rows without a house."""
    bytes: int
    sha256: str
    """SHA-256 of the file."""
    rows_sha256: str
    """SHA-256 of the ``sha256`` of its rows, one a line, empty for a limit.

    It is equal in all file formats.
    """


class Manifest(msgspec.Struct, frozen=True):
    """Record that a set is complete, with the contents of its files."""

    format: Literal["vitruvius-manifest-1"]
    set_sha256: str
    """SHA-256 of ``set.json``."""
    houses: int
    limits: int
    shards: list[Held]


def encoded(record: Set | Manifest) -> bytes:
    """Return a record in the bytes of its file."""
    return msgspec.json.format(msgspec.json.encode(record), indent=1) + b"\n"


def read_set(folder: Path) -> Set | None:
    """Return the record of a folder's set, or None without one.

    Raises ``HouseFileError`` for a wrong file.
    """
    return _read(folder / SET, Set)


def read_manifest(folder: Path) -> Manifest | None:
    """Return the manifest of a set, or None if the set is incomplete.

    Raises ``HouseFileError`` for a wrong file, and for a manifest that contradicts ``set.json``.
    """
    of, found = read_set(folder), _read(folder / MANIFEST, Manifest)
    if of is None or found is None:
        return None
    path = folder / MANIFEST
    if found.set_sha256 != hashlib.sha256((folder / SET).read_bytes()).hexdigest():
        raise HouseFileError(f"{path}: belongs to another set than {SET}")
    shards = [(each.place.as_posix(), each.split, len(each.indices)) for each in of.divided()]
    if shards != [(each.file, each.split, each.rows) for each in found.shards]:
        raise HouseFileError(f"{path}: its shards differ from those of {SET}")
    for each in found.shards:
        if not all(one < next_ for one, next_ in pairwise([-1, *each.limits, each.rows])):
            raise HouseFileError(f"{path}: its limits of {each.file} are not row numbers in ascending order")
    limits = sum(len(each.limits) for each in found.shards)
    if (found.houses, found.limits) != (sum(of.houses.values()) - limits, limits):
        raise HouseFileError(f"{path}: its numbers of houses and limits differ from those of its shards")
    return found


def inside(folder: Path, name: str) -> Path:
    """Return the path of a file or folder of a set. Raises ``HouseFileError`` for a link out of the set."""
    path = folder / name
    if not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):
        raise HouseFileError(f"{path}: is a link out of the set's folder: copy the file into the folder")
    return path


def _read(path: Path, kind: type[Kind]) -> Kind | None:
    try:
        return from_json(content_of(path, MAX_RECORD_BYTES, unpack=False), kind)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise HouseFileError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise HouseFileError(f"{path}: is not a valid file of a set: {error}") from None


def begin(folder: Path, of: Set, rules: Grammar, replace: bool) -> None:
    """Write the record and the rules of a set, unless they are there; ``replace`` removes another set.

    The record comes first, so that each of several processes that begin at once finds it before any other
    file. Raises ``RequestError`` if another set or something else is there.
    """
    others = _others(folder)  # Listed first: files of other processes follow the record.
    there = _there(folder)
    if there != of and (there or others):
        if not replace and there:
            differs = next(
                name for name in Set.__struct_fields__ if getattr(there, name) != getattr(of, name)
            )
            old, new = (_short(getattr(each, differs)) for each in (there, of))
            raise _refused(folder, f"a set of another {differs} ({old}, not {new})")
        if not replace:
            raise _refused(folder, "files that are not a set")
        for path in (folder / MANIFEST, *files_of_shards(folder)):
            path.unlink(missing_ok=True)
    _write(folder / SET, encoded(of))
    place = folder / GRAMMAR / rules.name
    for file in sorted(rules.directory.iterdir()):
        if file.suffix in RULES and file.is_file() and not file.name.startswith("."):
            _write(place / file.name, file.read_bytes())
    if find(place).hash != of.grammar_hash:
        raise _refused(place, "other rules")


def _others(folder: Path) -> bool:
    """Return True if a folder holds more than a temporary file of ``set.json``."""
    if not folder.is_dir():
        return False
    beside = (BESIDE.fullmatch(path.name) for path in folder.iterdir())
    return any(named is None or named[1] != SET for named in beside)


def _there(folder: Path) -> Set | None:
    try:
        return read_set(folder)
    except HouseFileError:
        return None


def files_of_shards(folder: Path) -> Iterator[Path]:
    """Yield the files in a set's folder that have names of shards."""
    data = folder / DATA
    return (path for path in data.iterdir() if SHARD.fullmatch(path.name)) if data.is_dir() else iter(())


def leftovers(folder: Path) -> Iterator[Path]:
    """Yield temporary files that killed processes have left."""
    for place in (folder, folder / DATA, *(folder / GRAMMAR).glob("*")):
        for path in place.iterdir() if place.is_dir() else ():
            named = BESIDE.fullmatch(path.name)
            if named and (SHARD.fullmatch(named[1]) or (place / named[1]).exists()):
                yield path


def _write(path: Path, content: bytes) -> None:
    """Write a file, unless it already has this content."""
    if not path.is_file() or path.read_bytes() != content:
        write_whole(path, content)


def finish(folder: Path, content: dict[str, bytes]) -> None:
    """Write the last files of a set, the manifest last, and remove temporary files of killed processes."""
    for path in leftovers(folder):
        path.unlink(missing_ok=True)
    for name in sorted(content, key=lambda name: name == MANIFEST):
        try:
            _write(folder / name, content[name])
        except FileNotFoundError:  # another process, which writes the same, removed it as a leftover
            _write(folder / name, content[name])


def _refused(place: Path, what: str) -> RequestError:
    return RequestError(
        f"--out {place}: holds {what}: choose another folder, or add --replace to overwrite it"
    )


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else msgspec.json.encode(value).decode()
    return text if len(text) <= 40 else f"{text[:24]}..."
