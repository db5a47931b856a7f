"""What a command writes over: never other houses in silence, and no picture of an earlier run stays."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from logic.errors import HouseFileError, RequestError
from logic.house.files import load
from logic.house.house import House
from logic.house.parts import Provenance


def require_same_series(out: Path, first: House, last: int) -> int:
    """How many houses a file holds. Raises ``RequestError`` where they are others than those from ``first``
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
    """Raise ``RequestError`` where a file holds other houses than these."""
    held = _held(out)
    if held and [house.converted() for house in held] != list(houses):
        raise _refused(out)


def remove_others(folder: Path, written: Iterable[Path]) -> int:
    """Remove files named as those that were ``written``, but for their numbers; how many there were.

    ``house-3.svg`` goes where ``house-0.svg`` and ``house-1.svg`` were written, of an earlier run with more
    houses; other names stay, and so do other formats.
    """
    kept = {path.name for path in written}
    patterns = {re.sub(r"\d+", r"\\d+", re.escape(name)) for name in kept if re.search(r"-\d+\.", name)}
    others = [
        path
        for path in folder.iterdir()
        if path.is_file() and path.name not in kept and any(re.fullmatch(p, path.name) for p in patterns)
    ]
    for path in others:
        path.unlink()
    return len(others)


def _series(source: Provenance) -> tuple[object, ...]:
    return source.grammar_hash, source.request, source.seed


def _held(out: Path) -> list[House]:
    """The houses of a file that is there. Raises ``RequestError`` where it holds something else."""
    if not out.is_file() or not out.stat().st_size:
        return []
    try:
        return load(out)
    except HouseFileError:
        raise _refused(out, "something else than houses") from None


def _refused(out: Path, what: str = "other houses") -> RequestError:
    return RequestError(f"--out {out}: holds {what}: name another file, or add --replace to lose them")
