"""Which known name a misspelt one was meant to be."""

import difflib
from collections.abc import Iterable


def closest(name: str, names: Iterable[str]) -> str | None:
    """The most similar name, of equally similar ones the one nearest in length; None if none is.

    ``difflib.get_close_matches`` would take *beside* for *bde* rather than *bed*.
    """

    def likeness(other: str) -> tuple[float, int]:
        return difflib.SequenceMatcher(None, name, other).ratio(), -abs(len(other) - len(name))

    best = max(sorted(names), key=likeness, default=None)
    return best if best is not None and likeness(best)[0] >= 0.6 else None
