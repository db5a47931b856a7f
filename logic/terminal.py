"""Terminal output: lines for the user, and progress bars."""

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from threading import RLock
from typing import TypeVar

from tqdm import tqdm

from vitruvius.logic.spelling import printable

Item = TypeVar("Item")

tqdm.set_lock(RLock())  # not the default, of multiprocessing, which may start a process


def progress(items: Iterable[Item], total: int, what: str) -> Iterator[Item]:
    """Yield the items with a progress bar, rate and time left on a terminal; show nothing in a pipe."""
    with counting(total, what) as add:
        for item in items:
            yield item
            add(1)


@contextmanager
def counting(total: int, what: str) -> Iterator[Callable[[int], None]]:
    """Show the same bar for items that come several at a time.

    Call the yielded function with their number.
    """
    with tqdm(total=total, desc=what, unit=f" {what}", disable=None, leave=False) as bar:

        def add(number: int) -> None:
            bar.update(number)

        yield add


@contextmanager
def working() -> Iterator[Callable[[str], object]]:
    """Show a line about work of unknown length, on a terminal. Call the yielded function with its text."""
    with tqdm(bar_format="{desc}", disable=None, leave=False) as bar:
        yield bar.set_description_str


def print_above(line: str) -> None:
    """Print a line on the standard output, above a progress bar."""
    with tqdm.external_write_mode():
        print(line, flush=True)


MAX_LINE = 2000
"""Number of characters of a line: text of a file may have millions."""


def say(text: str) -> None:
    """Print a line for the user on stderr, since the standard output is for houses and answers."""
    lines = (
        line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]}... ({len(line) - MAX_LINE:,} more characters)"
        for line in text.split("\n")
    )
    with tqdm.external_write_mode(sys.stderr):
        print(printable("\n".join(lines), "\n"), file=sys.stderr, flush=True)
