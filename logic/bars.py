"""Progress bars on a terminal, by rich. ``terminal.progress`` imports this module only for a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

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


class Rate(ProgressColumn):
    """Column with the number of items per second."""

    def render(self, task: Task) -> Text:
        """Return the rate as in ``3.2/s``."""
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.1f}/s")


@contextmanager
def counting(total: int, what: str) -> Iterator[Callable[[int], None]]:
    """Show a bar for items that come several at a time. Call the yielded function with their number."""
    with counting_bar() as bar:
        task = bar.add_task(what, total=total)
        yield lambda number: bar.advance(task, number)


def counting_bar() -> Progress:
    """Return a bar with the number of items, their rate and the time left."""
    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn()
    return progress_bar(*columns, Rate(), TimeRemainingColumn())


def progress_bar(*columns: ProgressColumn, transient: bool = True) -> Progress:
    """Return a bar on stderr, shown only on a terminal. A ``transient`` bar vanishes at its end.

    Rich takes a file for a terminal where ``FORCE_COLOR`` is set, as in notebooks and on CI servers. If the
    standard output is a file, rich must not redirect it to the bar.
    """
    return Progress(
        *columns,
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
        transient=transient,
        redirect_stdout=sys.stdout.isatty(),
    )
