"""What a command writes over: never other houses in silence, and no picture of an earlier run stays."""

import fcntl
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from logic.errors import HouseFileError, RequestError
from logic.house.files import load, write_whole
from logic.house.house import House
from logic.house.parts import Provenance

DRAWN_BY = b"drawn by vitruvius"
"""What every picture in a file says."""

MARK = ".vitruvius-study"
"""A file in folders that studies write to."""


def require_same_series(out: Path, first: House, last: int) -> int:
    """How many houses a file holds. Raises ``RequestError`` if they are others than those from ``first``
    to index ``last``.

    A series is named by grammar, request and seed: what is made again is no loss, and a file that ended
    early is completed.
    """
    new = first.provenance
    assert new is not None, "a house that was made says how"
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
    """Raise ``RequestError`` before the work where a file holds anything, unless it is to be lost."""
    if not replace and out.is_file() and out.stat().st_size:
        raise _refused(out, "something already")


@contextmanager
def unless_other(out: Path, replace: bool) -> Iterator[Path]:
    """A place for what is to become ``out``, a file or files of a folder: in the end it does.

    Raises ``RequestError`` if a file of other content is there, unless it is to be lost.
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
    """Where a study works, which goes on with what it left there: the folder is marked as one of studies.

    Raises ``RequestError`` before the work where it holds other files, unless it is to be written to anyway.
    """
    mark = folder / MARK
    if not replace and folder.is_dir() and any(folder.iterdir()) and not mark.exists():
        why = f"--out {folder}: holds files that no study wrote"
        raise RequestError(f"{why}: name another folder, or add --replace to write beside them")
    folder.mkdir(parents=True, exist_ok=True)
    mark.touch()  # before the work, which may be killed
    try:
        yield
    finally:
        if list(folder.iterdir()) == [mark]:
            mark.unlink()
            folder.rmdir()


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Hold a folder, which is made, as the only command that draws there. It goes again if nothing is drawn.

    Raises ``RequestError`` if another one does: their pictures would be mixed.
    """
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    held = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise RequestError(f"{folder}: another command draws here: wait, or name another") from None
        except OSError:
            pass  # some network file systems lock no folder: nothing is known of others there
        yield
    finally:
        os.close(held)
        if is_new and not any(folder.iterdir()):
            folder.rmdir()


def require_drawn(folder: Path, ending: str, replace: bool) -> None:
    """Raise ``RequestError`` if a folder has files in the place of pictures, ``house-0.svg`` and so on,
    that nothing of ours drew, unless they are to be lost.
    """
    names = re.compile(rf"((house|diff)-\d+|contact-sheet|plans)\.{ending}")
    for file in sorted(folder.glob(f"*.{ending}")) if not replace else ():
        ours = not file.is_file() or not file.stat().st_size or DRAWN_BY in file.read_bytes()
        if names.fullmatch(file.name) and not ours:
            raise _refused(file, "something else than a picture of houses")


def remove_others(folder: Path, written: Iterable[Path]) -> int:
    """Remove files named as those that were ``written``, but for their numbers; how many there were.

    ``house-3.svg`` goes where ``house-0.svg`` and ``house-1.svg`` were written, of an earlier run with more
    houses; other names stay, and so do other formats.
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
    """The houses of a file that is there. Raises ``RequestError`` if it holds something else."""
    if not out.is_file() or not out.stat().st_size:
        return []
    try:
        return load(out)
    except HouseFileError:
        raise _refused(out, "something else than houses") from None


def _refused(out: Path, what: str = "other houses") -> RequestError:
    return RequestError(f"--out {out}: holds {what}: name another file, or add --replace to lose them")
