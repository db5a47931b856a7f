"""Terminal output: lines for the user, and progress bars."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    Task,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from vitruvius.logic.spelling import printable


class Rate(ProgressColumn):
    """Column with the number of items per second."""

    def render(self, task: Task) -> Text:
        """Return the rate as in ``3.2/s``."""
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.1f}/s")


def progress(items: Any, total: int, what: str) -> Iterator[Any]:
    """Yield the items with a progress bar, rate and time left on a terminal; show nothing in a pipe."""
    with _counting_bar() as bar:
        yield from bar.track(items, total, description=what)


@contextmanager
def counting(total: int, what: str) -> Iterator[Callable[[int], None]]:
    """Show the same bar for items that come several at a time.

    Call the yielded function with their number.
    """
    with _counting_bar() as bar:
        task = bar.add_task(what, total=total)
        yield lambda number: bar.advance(task, number)


def _counting_bar() -> Progress:
    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn()
    return progress_bar(*columns, Rate(), TimeRemainingColumn())


def progress_bar(*columns: ProgressColumn, transient: bool = True) -> Progress:
    """Return a bar on stderr, shown only on a terminal. A ``transient`` bar vanishes at its end.

    If the standard output is a file, rich must not redirect it to the bar.
    """
    console = Console(stderr=True)
    return Progress(
        *columns,
        console=console,
        disable=not console.is_terminal,
        transient=transient,
        redirect_stdout=sys.stdout.isatty(),
    )


MAX_LINE = 2000
"""Number of characters of a line: text of a file may have millions."""


def say(text: str) -> None:
    """Print a line for the user on stderr, since the standard output is for houses and answers."""
    lines = (
        line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]}... ({len(line) - MAX_LINE:,} more characters)"
        for line in text.split("\n")
    )
    print(printable("\n".join(lines), "\n"), file=sys.stderr, flush=True)
