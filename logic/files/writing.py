"""Writing of files: checks before the work, and a whole file or none."""

import os
import secrets
import stat
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO

from vitruvius.logic.errors import RequestError

FILES = (
    *(".csv", ".gif", ".gz", ".html", ".json", ".jsonl", ".md", ".mp4", ".onnx", ".pdf", ".png"),
    *(".safetensors", ".svg", ".txt"),
)
"""Suffixes that mark a path as a file, not a folder."""


def require_ending(path: str | Path, endings: Sequence[str]) -> None:
    """Raise ``RequestError`` for a file's name with another suffix than the written format has."""
    path = Path(path)
    if not path.name.endswith(tuple(endings)) and (path.is_file() or not path.exists()):
        found = path.suffix or "no extension"
        raise RequestError(
            f"{path}: {found} is not supported here: name the file with {' or '.join(endings)}"
        )


def require_file(path: Path, endings: Sequence[str]) -> None:
    """Raise ``RequestError`` before the work for a file that cannot be written.

    Reasons are another suffix, a folder of this name, and a place without permission.
    """
    if path.is_dir():
        example = path / f"name{endings[0]}"
        raise RequestError(f"--out {path}: is a folder: name a file in it, as in {example}")
    require_ending(path, endings)
    if not path.exists() or path.is_file():
        _require_place(Path(os.path.realpath(path)).parent, path)


def require_folder(path: Path | None) -> None:
    """Raise ``RequestError`` before the work for a folder that cannot be written.

    Reasons are a file's name, since several files are written into the folder, and a place without
    permission.
    """
    if path is None:
        return
    if path.is_file() or path.suffix in FILES:
        words = f"name it without {path.suffix}" if path.suffix else "this is a file"
        raise RequestError(f"{path}: the output is a folder of several files: {words}")
    _require_place(path, path)


def _require_place(folder: Path, out: Path) -> None:
    """Raise ``RequestError`` if no file can be made in a folder, or in its nearest existing parent."""
    there = next(each for each in (folder.absolute(), *folder.absolute().parents) if each.exists())
    try:
        TemporaryFile(dir=there).close()  # the mode of a folder is not reliable on every file system
    except OSError as error:
        raise RequestError(f"--out {out}: cannot write to {there}: {error.strerror}") from None


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file with this content as ``whole_file`` does.

    A link stays a link, and its target is replaced. A device or a pipe is written directly.
    Raises ``OSError`` for a folder, or if writing fails.
    """
    given, path = Path(path), Path(os.path.realpath(path))
    # In a circle of links the real path is still a link, for which ``stat`` raises. A pipe by its number, as
    # in /dev/stdout, has no other path.
    if (given.exists() or path.is_symlink()) and not stat.S_ISREG(given.stat().st_mode):
        with _errors_of(path):
            given.write_bytes(content)
        return
    with whole_file(path) as file:
        file.write(content)


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """Open a temporary file, which is flushed to disk and renamed at the end: a kill leaves no partial file.

    An existing file keeps its mode. Raises ``OSError`` if this fails.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        with _errors_of(path):
            with open(beside, "xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            if path.exists():
                beside.chmod(stat.S_IMODE(path.stat().st_mode))
            beside.replace(path)
    except BaseException:
        beside.unlink(missing_ok=True)
        raise


@contextmanager
def _errors_of(path: Path) -> Iterator[None]:
    """Let an error of the system name this file."""
    try:
        yield
    except OSError as error:
        if error.errno:
            error.filename = str(path)
        raise
