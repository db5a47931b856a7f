"""Which known name a misspelt one was meant to be."""

import difflib
from collections.abc import Iterable


def closest(name: str, names: Iterable[str]) -> str | None:
    """The most similar of the names, the one of like length where several are; None if none is."""

    def likeness(other: str) -> tuple[float, int]:
        return difflib.SequenceMatcher(None, name, other).ratio(), -abs(len(other) - len(name))

    best = max(sorted(names), key=likeness, default=None)
    return best if best is not None and likeness(best)[0] >= 0.6 else None
