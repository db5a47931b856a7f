"""Files of rows: JSON Lines, and Parquet by pyarrow. Equal rows give equal bytes."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from gzip import GzipFile
from pathlib import Path
from typing import Any, BinaryIO, Literal, get_args

import msgspec

from vitruvius.logic.dataset.parquet import MAX_FILE_BYTES, groups
from vitruvius.logic.dataset.rows import SIDES, Row
from vitruvius.logic.files.writing import whole_file
from vitruvius.logic.installation import required_by
from vitruvius.logic.opener import opened

Files = Literal["parquet", "jsonl"]

FILES: tuple[str, ...] = get_args(Files)

GROUP = 256
"""Number of rows in memory at a time, and in a row group of Parquet."""

COMPRESSION = "zstd"

MAX_ROW_BYTES = 1 << 23
"""Largest size of a row of JSON Lines, in bytes."""


@cache
def schema() -> Any:
    """Return the columns as a schema of pyarrow."""
    with required_by("a set in Parquet"):
        import pyarrow as pa

    text, real = pa.string(), pa.float64()
    sides = [pa.field(side, real) for side in SIDES]

    def records(*fields: tuple[str, Any]) -> Any:
        return pa.list_(pa.struct([*(pa.field(*each) for each in fields), *sides]))

    house = [
        ("topology", text),
        ("hub", text),
        ("wall_thickness", pa.struct([("inner", real), ("outer", real)])),
        ("floor", pa.struct(sides)),
        ("rooms", pa.list_(pa.struct([("name", text), ("type", text), *sides, ("part_of", text)]))),
        ("doors", records(("between", pa.list_(text)), ("opening", pa.bool_()))),
        ("windows", records(("room", text))),
        ("pieces", records(("room", text), ("parent", pa.int32()), ("type", text), ("orientation", text))),
    ]
    return pa.schema(
        [
            *((name, text) for name in ("id", "split")),
            *((name, pa.int64()) for name in ("seed", "index")),
            *((name, text) for name in ("grammar", "grammar_hash", "request")),
            ("rooms", pa.int32()),
            ("types", pa.list_(text)),
            ("area", real),
            *((name, text) for name in ("verdict", "why", "sha256")),
            ("house", pa.struct(house)),
        ]
    )


@contextmanager
def written(path: Path, files: Files) -> Iterator[Callable[[list[Row]], None]]:
    """Write rows group by group to a file as ``whole_file`` does."""
    with whole_file(path) as file, _writer(file, files) as write:
        yield write


@contextmanager
def _writer(file: BinaryIO, files: Files) -> Iterator[Callable[[list[Row]], None]]:
    if files == "jsonl":
        yield lambda rows: file.writelines(msgspec.json.encode(row) + b"\n" for row in rows) or None
        return
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    with ParquetWriter(file, schema(), compression=COMPRESSION) as writer:
        yield lambda rows: writer.write_table(pa.Table.from_pylist(rows, schema()))


def in_groups(rows: Iterable[Row]) -> Iterator[list[Row]]:
    """Yield the rows in groups of ``GROUP``."""
    group = list[Row]()
    for row in rows:
        group.append(row)
        if len(group) == GROUP:
            yield group
            group = []
    if group:
        yield group


def read(path: Path, first: int = 0) -> Iterator[Row]:
    """Yield the rows of a file from number ``first`` on, one group at a time.

    Raises ``OSError`` if the file cannot be read, and ``ValueError`` if it is too large or contains no rows
    of a set.
    """
    if path.suffix == ".jsonl":
        with opened(path, MAX_FILE_BYTES, unpack=False) as file:
            yield from lines(file, first)
    else:
        for rows in groups(path, first, schema()):
            yield from rows


def lines(file: BinaryIO | GzipFile, first: int = 0) -> Iterator[Row]:
    """Yield the rows of open JSON Lines from number ``first`` on. Raises ``ValueError`` for other lines."""
    number = 0
    while line := file.readline(MAX_ROW_BYTES + 1):
        if len(line) > MAX_ROW_BYTES:
            raise ValueError(f"a row of more than {MAX_ROW_BYTES >> 20} MiB")
        if number >= first:
            try:
                yield msgspec.json.decode(line, type=Row)
            except RecursionError:
                raise ValueError("it is nested too deep") from None
        number += 1
