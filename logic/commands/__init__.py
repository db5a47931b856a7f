"""The commands about rules and houses: each is a dataclass whose fields are its options.

The command line gathers them. What a command needs is imported in its ``run``, so that help comes at once.
"""

import re
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import tyro
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

from logic.errors import RequestError
from logic.spelling import printable

Repeated = tyro.conf.UseAppendAction


def counts(option: str, texts: tuple[str, ...]) -> dict[str, Any]:
    """``("bedroom=2", "hall=..1")`` as ``{"bedroom": 2, "hall": (0, 1)}``."""
    from logic.request import from_option

    counts = {}
    for text in texts:
        name, _, number = text.partition("=")
        if not name or not re.fullmatch(r"\d+|\d*\.\.\d*", number) or name in counts:
            raise RequestError(f"{option} {text}: give each name once, as in {option} bed=2 or bed=1..3")
        counts[name] = from_option(number)
    return counts


class Rate(ProgressColumn):
    """How many are done in a second."""

    def render(self, task: Task) -> Text:
        """As in ``3.2/s``."""
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:,.1f}/s")


def progress(items: Any, total: int, what: str) -> Iterator[Any]:
    """A progress bar on a terminal, with rate and time left; nothing in a pipe."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        Rate(),
        TimeRemainingColumn(),
    )
    with progress_bar(*columns) as bar:
        yield from bar.track(items, total, description=what)


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


def print_answer(command: str, answer: Any, exit_code: int = 0) -> None:
    """Print what a command found as ``--json`` has it: see ``logic.answers``."""
    from logic.answers import encoded

    print(encoded(command, exit_code, answer), flush=True)


def say_warnings() -> None:
    """Print a warning as ``lint`` does, without the line of Python that it came by."""
    warnings.showwarning = lambda message, *_: say(str(message))


def say(text: str) -> None:
    """A line for the user, on stderr: the standard output is for houses and answers."""
    print(printable(text, "\n"), file=sys.stderr, flush=True)
