"""What is shown on a terminal: lines for the user, and progress bars."""

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

from logic.spelling import printable


class Rate(ProgressColumn):
    """How many are done in a second."""

    def render(self, task: Task) -> Text:
        """As in ``3.2/s``."""
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.1f}/s")


def progress(items: Any, total: int, what: str) -> Iterator[Any]:
    """A progress bar on a terminal, with rate and time left; nothing in a pipe."""
    with _counting_bar() as bar:
        yield from bar.track(items, total, description=what)


@contextmanager
def counting(total: int, what: str) -> Iterator[Callable[[int], None]]:
    """The same bar, of what comes several at a time: call it with how many."""
    with _counting_bar() as bar:
        task = bar.add_task(what, total=total)
        yield lambda number: bar.advance(task, number)


def _counting_bar() -> Progress:
    columns = TextColumn("{task.description}"), BarColumn(), TaskProgressColumn()
    return progress_bar(*columns, Rate(), TimeRemainingColumn())


def progress_bar(*columns: ProgressColumn, transient: bool = True) -> Progress:
    """A bar on stderr, on a terminal alone; when it ends it vanishes, or stays. Where the standard output is
    a file, rich must not redirect it to the bar.
    """
    console = Console(stderr=True)
    return Progress(
        *columns,
        console=console,
        disable=not console.is_terminal,
        transient=transient,
        redirect_stdout=sys.stdout.isatty(),
    )


def say(text: str) -> None:
    """A line for the user, on stderr: the standard output is for houses and answers."""
    print(printable(text, "\n"), file=sys.stderr, flush=True)
