"""House files: JSON Lines, a house a line, plain or gzipped, and ``.json`` files with one house."""

import codecs
import gzip
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

import msgspec

from vitruvius.logic.encoding import MARKS
from vitruvius.logic.errors import HouseFileError, RequestError
from vitruvius.logic.files.gallery import Houses
from vitruvius.logic.files.writing import require_ending, write_whole
from vitruvius.logic.grammar import shipped
from vitruvius.logic.house.house import House
from vitruvius.logic.opener import DAMAGED, from_json, opened, reason
from vitruvius.logic.spelling import closest, quoted

HOUSE_FILES = (".jsonl", ".jsonl.gz", ".json", ".json.gz")
"""Suffixes of house files."""

DESCRIPTIONS, PICTURES = (".yaml", ".yml"), (".pgm", ".png", ".bmp")
"""Suffixes of the files of a ROS map."""

MOST_BYTES, MOST_LINES, MOST_LINE = 1 << 30, 1 << 20, 1 << 25
"""Limits of an unpacked house file: bytes, lines, and bytes of one house."""


def load(path: str | Path, file: BinaryIO | None = None, *, whole_pixels: bool = False) -> Houses:
    """Read every house of a ``.jsonl``, ``.jsonl.gz`` or ``.json`` file as a list.

    Notebooks show the list as plans. ``-`` is the standard input, plain or gzipped. An open ``file`` is read
    in place of the path, which is then only its name. A map of ROS is read by its ``.yaml``, as one house:
    see ``ros_map.py``.

    ``whole_pixels``: cut the lengths of the original's files to whole pixels, as the original's simulator
    did. Other files have no pixels, and raise an error.

    Raises ``HouseFileError``, with the line, for a file that is absent, empty, truncated or wrong.
    """
    path = Path(path)
    if path.suffix.lower() in PICTURES:
        raise HouseFileError(f"{path}: a picture, not a house file: for a map, give its .yaml file")
    try:
        if path.suffix.lower() in DESCRIPTIONS and not path.is_dir():
            from vitruvius.logic.files.ros_map import read_map  # It imports PyYAML and Pillow.

            return Houses([House.of_map(read_map(path))])
        with file or opened(path, MOST_BYTES) as content:
            houses = Houses(_houses(content, path, whole_pixels))
    except FileNotFoundError:
        raise HouseFileError(f"{path}: {_absent(path)}") from None
    except IsADirectoryError:
        raise HouseFileError(f"{path}: {_folder(path)}") from None
    except DAMAGED as error:
        raise HouseFileError(f"{path}: cannot be read: {reason(error)}") from None
    if not houses:
        raise HouseFileError(
            f"{path}: holds no house. Generate some with: {_made(path, 'generate --rooms 4')}"
        )
    return houses


def _houses(file: BinaryIO | gzip.GzipFile, path: Path, whole_pixels: bool) -> Iterator[House]:
    """Yield the houses of an open file, line by line, and stop early if the file is too large."""
    read = file.read if _holds_one(path) else file.readline
    number, left = 0, MOST_BYTES
    while line := read(MOST_LINE + 1):
        if not number:
            line = _without_mark(line, path)
        number, left = number + 1, left - len(line)
        if left < 0 or number > MOST_LINES:
            most = f"{MOST_BYTES >> 20} MiB or {MOST_LINES:,} lines"
            raise HouseFileError(f"{path}: holds more than {most}: split it")
        if len(line) > MOST_LINE:
            raise HouseFileError(f"{path}:{number}: a house of more than {MOST_LINE >> 20} MiB")
        if line.strip() and stopped_by(line) is None:
            yield _parsed(line, f"{path}:{number}", whole_pixels)


def _without_mark(line: bytes, path: Path) -> bytes:
    """Return the first line of a file without UTF-8's byte order mark.

    Raises ``HouseFileError`` for the mark of another encoding.
    """
    for mark, name in MARKS.items():
        if line.startswith(mark):
            raise HouseFileError(f"{path}:1: not a house: this file is {name}: save it as UTF-8")
    return line.removeprefix(codecs.BOM_UTF8)


def save(houses: Iterable[House], path: str | Path, stopped: str = "") -> None:
    """Write all houses as JSON Lines, or nothing. A ``.json`` file takes exactly one house.

    ``stopped`` is the reason for fewer houses than requested. It becomes a last line ``{"stopped": why}``,
    which ``load`` ignores. The file is written under another name and renamed, so that a kill leaves the old
    file or the new one. Raises ``RequestError``, a ``ValueError``, for a name without a suffix of house
    files, for no house, and for more than one in a ``.json`` file.
    """
    require_ending(path, HOUSE_FILES)
    records = [msgspec.json.encode(house.to_dict()) for house in houses]
    if not records:
        raise RequestError(f"no house to write to {path}")
    if _holds_one(Path(path)) and len(records) != 1:
        raise RequestError(f"{path}: a .json file holds one house, not {len(records)}: use .jsonl")
    if stopped:
        records.append(msgspec.json.encode({"stopped": stopped}))
    content = b"\n".join(records) + b"\n"
    # mtime=0: the same houses give the same bytes, so that a hash can name a set of houses.
    write_whole(path, gzip.compress(content, mtime=0) if Path(path).suffix == ".gz" else content)


def _folder(path: Path) -> str:
    """Return a message for a folder in place of a house file, with a house file that it contains."""
    if any(path.glob("*.lp")):
        return _grammar(path)
    there = sorted(file.name for file in path.glob("*") if file.name.lower().endswith(HOUSE_FILES))
    return "is a folder, not a house file" + (f": did you mean {path / there[0]}?" if there else "")


def _grammar(name: Path) -> str:
    made = f"vitruvius generate --grammar {quoted(name)} --rooms 6 --out houses.jsonl"
    return f"is a grammar, not a house file. Generate houses with: {made}"


def _absent(path: Path) -> str:
    """Return a message for an absent file, with a similar house file or a command that makes one."""
    if str(path) in shipped():
        return _grammar(path)
    there = sorted(file.name for file in path.parent.glob("*") if file.name.lower().endswith(HOUSE_FILES))
    if close := closest(path.name, there):
        return f"there is no such file: did you mean {path.parent / close}?"
    if there:
        folder = "this folder" if path.parent == Path() else path.parent
        return f"there is no such file: {folder} has {', '.join(there[:5])}"
    made = _made(path, "generate --rooms 4 --count 100")
    return f"there is no such file. Generate {'it' if made.endswith(quoted(path)) else 'one'} with: {made}"


def _made(path: Path, words: str) -> str:
    """Return the command that makes a house file, with this name if its suffix is one of house files."""
    name = path if path.name.endswith(HOUSE_FILES) else path.with_name("houses.jsonl")
    return f"vitruvius {words} --out {quoted(name)}"


class _End(msgspec.Struct, forbid_unknown_fields=True):
    """Line that states why a series ended early."""

    stopped: str


def stopped_by(line: bytes) -> str | None:
    """Return the reason in a line that ends a series of houses early (see ``save``); None for other lines."""
    if not line.startswith(b'{"stopped":'):
        return None
    try:
        return from_json(line, _End).stopped
    except ValueError:
        return None


def _holds_one(path: Path) -> bool:
    """Return True if a file is named ``.json`` or ``.json.gz`` and so holds one house over all lines."""
    return path.name.lower().removesuffix(".gz").endswith(".json")


def _require_once(pairs: list[tuple[str, Any]]) -> None:
    """Raise ``ValueError`` for a key that an object has twice, since other programs read the other value."""
    keys = [key for key, _ in pairs]
    if len(set(keys)) < len(keys):
        raise ValueError(f"{max(keys, key=keys.count)!r} appears twice in an object")


def _parsed(line: bytes, place: str, whole_pixels: bool) -> House:
    try:
        record: dict[str, Any] = from_json(line, Any)
        json.loads(line, object_pairs_hook=_require_once)
        if whole_pixels:
            record = json.loads(line, parse_float=lambda text: float(int(float(text))))
            if isinstance(record, dict) and "unit" in record:
                raise ValueError(f"its lengths are in {record['unit']}: cropping needs a house in pixels")
        return House.from_dict(record)
    except (ValueError, OverflowError) as error:
        raise HouseFileError(f"{place}: not a house: {error}") from None
