"""Checks before a command overwrites files, so that houses are never lost and no old picture remains."""

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from vitruvius.logic.errors import HouseFileError, RequestError
from vitruvius.logic.files.house_files import load
from vitruvius.logic.files.writing import write_whole
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Provenance

try:
    import fcntl
except ModuleNotFoundError:  # on Windows
    fcntl = None  # pyright: ignore[reportAssignmentType]

DRAWN_BY = b"drawn by vitruvius"
"""Text in every picture file."""

MARK = ".vitruvius-study"
"""Name of a file that marks folders to which studies write."""


def require_same_series(out: Path, first: House, last: int) -> int:
    """Return the number of houses in a file that may be replaced by a series.

    Raises ``RequestError`` if the file holds other houses than those from ``first`` to index ``last``.
    Grammar, request and seed identify a series. Its houses can be generated again without loss, and a file
    that ended early can be completed.
    """
    new = first.provenance
    assert new is not None, "generated houses need provenance"
    held = _held(out)
    for house in held:
        old = house.provenance
        if old is None or _series(old) != _series(new) or not new.index <= old.index <= last:
            raise _refused(out)
    return len(held)


def require_same_houses(out: Path, houses: Sequence[House]) -> None:
    """Raise ``RequestError`` if a file holds other houses than these."""
    held = _held(out)
    if held and [house.converted() for house in held] != list(houses):
        raise _refused(out)


def require_free(out: Path, replace: bool) -> None:
    """Raise ``RequestError`` before the work if a file is not empty, unless ``replace`` is True."""
    if not replace and out.is_file() and out.stat().st_size:
        raise _refused(out, "something already")


@contextmanager
def unless_other(out: Path, replace: bool) -> Iterator[Path]:
    """Yield a temporary path whose content replaces ``out``, a file or files of a folder, at the end.

    Raises ``RequestError`` if a file with other content is there, unless ``replace`` is True.
    """
    with TemporaryDirectory() as beside:
        made = Path(beside, out.name or "made")
        yield made
        files = [file for file in made.rglob("*") if file.is_file()] if made.is_dir() else [made]
        content = {out / file.relative_to(made): file.read_bytes() for file in files}
    for file, new in content.items():
        if not replace and file.is_file() and file.read_bytes() not in (b"", new):
            raise _refused(file, "something else")
    for file, new in content.items():
        write_whole(file, new)


@contextmanager
def study_folder(folder: Path, replace: bool) -> Iterator[None]:
    """Mark a folder as one of studies. A study works there, and continues from its own files.

    Raises ``RequestError`` before the work if the folder holds other files, unless ``replace`` is True.
    """
    mark = folder / MARK
    if not replace and folder.is_dir() and any(folder.iterdir()) and not mark.exists():
        why = f"--out {folder}: holds files that are not from a study"
        raise RequestError(f"{why}: choose another folder, or add --replace to keep them and add files")
    folder.mkdir(parents=True, exist_ok=True)
    mark.touch()  # before the work, which may be killed
    try:
        yield
    finally:
        if list(folder.iterdir()) == [mark]:
            mark.unlink()
            folder.rmdir()


def lock_alone(file: int, busy: str) -> None:
    """Lock an open file or folder until it is closed.

    Raises ``RequestError`` with the text ``busy`` if another process has locked it.
    """
    if fcntl is None:
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise RequestError(busy) from None
    except OSError:
        pass  # some network file systems lock nothing, so that other commands remain unknown


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Create and lock a folder for the only command that draws there. Remove it again if it stays empty.

    Raises ``RequestError`` if another command draws there, since their pictures would mix.
    """
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    held = os.open(folder if fcntl else os.devnull, os.O_RDONLY)  # Windows opens no folder
    try:
        lock_alone(held, f"{folder}: another command is drawing to this folder: wait, or choose another")
        yield
    finally:
        os.close(held)
        if is_new and not any(folder.iterdir()):
            folder.rmdir()


def require_drawn(folder: Path, ending: str, replace: bool) -> None:
    """Raise ``RequestError`` if a folder has files named as pictures that Vitruvius did not draw.

    Such names are ``house-0.svg`` and so on. With ``replace`` these files may be lost.
    """
    names = re.compile(rf"((house|diff)-\d+|contact-sheet|plans)\.{ending}")
    for file in sorted(folder.glob(f"*.{ending}")) if not replace else ():
        ours = not file.is_file() or not file.stat().st_size or DRAWN_BY in file.read_bytes()
        if names.fullmatch(file.name) and not ours:
            raise _refused(file, "content that is not a picture of houses")


def remove_others(folder: Path, written: Iterable[Path]) -> int:
    """Remove files that have the names of those ``written``, except for their numbers. Return their number.

    ``house-3.svg``, of an earlier run with more houses, is removed if ``house-0.svg`` and ``house-1.svg``
    were written. Other names and other formats stay.
    """
    kept = {path.name for path in written}
    alike = {re.sub(r"\d+", "0", name) for name in kept if re.search(r"-\d+\.", name)}
    others = [
        path
        for path in folder.iterdir()
        if path.is_file() and path.name not in kept and re.sub(r"\d+", "0", path.name) in alike
    ]
    for path in others:
        path.unlink()
    return len(others)


def _series(source: Provenance) -> tuple[object, ...]:
    return source.grammar_hash, source.request, source.seed


def _held(out: Path) -> list[House]:
    """Return the houses of an existing file. Raises ``RequestError`` if the file holds something else."""
    if not out.is_file() or not out.stat().st_size:
        return []
    try:
        return load(out)
    except HouseFileError:
        raise _refused(out, "content that is not houses") from None


def _refused(out: Path, what: str = "other houses") -> RequestError:
    return RequestError(f"--out {out}: holds {what}: choose another file, or add --replace to overwrite them")
