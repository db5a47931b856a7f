"""Progress of some work, on standard error: a bar on a terminal; in a pipe, lines or nothing."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

Report = Callable[[float, str], None]
"""Function that is called with the fraction done, 0 to 1, and a few words."""


@contextmanager
def progress(title: str, every: float | None = None) -> Iterator[Report]:
    """Show the work under this title until the block ends.

    In a pipe, a plain line follows at each interval of ``every`` seconds, and at the end; with None, no
    lines. Rich takes a pipe for a terminal where ``FORCE_COLOR`` is set, as in notebooks and on CI servers.
    """
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=16),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        TextColumn("left"),
        TextColumn("{task.fields[words]}"),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
        redirect_stdout=sys.stdout.isatty(),  # rich must not redirect a file to the bar
    )
    if not bar.disable:
        with bar:
            task = bar.add_task(title, total=1.0, words="")
            yield lambda done, words: bar.update(task, completed=done, words=words)
    else:
        yield _lines(title, every)


def _lines(title: str, every: float | None) -> Report:
    """Return a function that writes a line at the first report, at each interval, and at the end."""
    start, due = perf_counter(), 0.0

    def report(done: float, words: str) -> None:
        nonlocal due
        elapsed = perf_counter() - start
        if every is not None and (elapsed >= due or done >= 1):
            due = elapsed + every
            print(f"{title}: {done:4.0%} {elapsed:4.0f} s  {words}", file=sys.stderr, flush=True)

    return report
