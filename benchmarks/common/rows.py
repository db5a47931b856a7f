"""Rows of a study in a file of JSON Lines, from which a stopped study continues."""

from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

import msgspec

from vitruvius.logic.files.writing import write_whole

Row = TypeVar("Row", bound=msgspec.Struct)


def read_rows(path: Path, kind: type[Row]) -> list[Row]:
    """Return the rows of a file, or no rows if the file does not exist."""
    lines = path.read_bytes().splitlines() if path.exists() else []
    return [msgspec.json.decode(line, type=kind) for line in lines]


def write_rows(path: Path, rows: Iterable[msgspec.Struct]) -> None:
    """Write the file whole, so that a kill truncates no row."""
    write_whole(path, b"".join(msgspec.json.encode(row) + b"\n" for row in rows))
