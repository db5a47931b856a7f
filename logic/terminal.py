"""Terminal output: lines for the user, and the progress of a loop."""

import sys
from collections.abc import Iterator
from typing import Any

from vitruvius.logic.spelling import printable

MAX_LINE = 2000
"""Number of characters of a line: text of a file may have millions."""


def progress(items: Any, total: int, what: str) -> Iterator[Any]:
    """Yield the items with a progress bar, rate and time left on a terminal; show nothing in a pipe."""
    if not sys.stderr.isatty():
        yield from items
        return
    from vitruvius.logic.bars import counting_bar

    with counting_bar() as bar:
        yield from bar.track(items, total, description=what)


def say(text: str) -> None:
    """Print a line for the user on stderr, since the standard output is for houses and answers."""
    lines = (
        line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]}... ({len(line) - MAX_LINE:,} more characters)"
        for line in text.split("\n")
    )
    print(printable("\n".join(lines), "\n"), file=sys.stderr, flush=True)
