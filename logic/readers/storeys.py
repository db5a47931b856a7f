"""Which storey of a plan with several is read: ``--storey``."""

from collections import Counter
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any

from logic.errors import RequestError
from logic.readers.sketch import Sketch
from logic.spelling import listed, quoted, unknown


def chosen(names: Sequence[str], storey: str | None) -> int:
    """Return which of the storeys with rooms is read, by their names: the one that the user names, or the
    only one. Numbers tell those of one name, and without one, apart.

    Raises ``RequestError`` for a name that no storey has, and without a name where there are several.
    """
    counts = Counter(names)
    storeys = [
        f"{name} {number}".strip() if counts[name] > 1 or not name else name
        for number, name in enumerate(names, 1)
    ]
    if storey is None:
        if len(storeys) == 1:
            return 0
        raise RequestError(
            f"plan: it has {len(storeys)} storeys with rooms ({listed(storeys)}): say which, as in --storey "
            f"{quoted(storeys[0])}"
        )
    same = [place for place, each in enumerate(storeys) if each.casefold() == storey.strip().casefold()]
    if not same:
        raise RequestError(f"plan: {unknown('storey', storey, storeys)}")
    return same[0]


def of_one_storey(read: Callable[[bytes, Any], Sketch]) -> Callable[[bytes, Any, str | None], Sketch]:
    """Return a reader of a format without storeys, which refuses the name of one."""

    @wraps(read)
    def wrapper(content: bytes, record: Any, storey: str | None = None) -> Sketch:
        require_none(storey)
        return read(content, record)

    return wrapper


def require_none(storey: str | None) -> None:
    """Raise ``RequestError`` for the name of a storey of a plan that has one storey."""
    if storey is not None:
        raise RequestError("plan: it has one storey, without a name: leave --storey out")
