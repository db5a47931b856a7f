"""Common parts of commands: repeated options, answers and warnings in their printed form."""

import re
import warnings
from pathlib import Path
from typing import Any

import tyro

from vitruvius.logic.errors import RequestError
from vitruvius.logic.stopping import heeded_after
from vitruvius.logic.terminal import say

Repeated = tyro.conf.UseAppendAction


def counts(option: str, texts: tuple[str, ...]) -> dict[str, Any]:
    """Return ``{"bedroom": 2, "hall": (0, 1)}`` for ``("bedroom=2", "hall=..1")``."""
    from vitruvius.logic.request.counts import from_option

    counts = {}
    for text in texts:
        name, _, number = text.partition("=")
        if name in counts:
            raise RequestError(f"{option} {text}: {name} is given twice: give each name once")
        if not name or not re.fullmatch(r"\d+|\d*\.\.\d*", number):
            like = re.split(r"[^\w.]", text)[0] or "bed"
            raise RequestError(f"{option} {text}: give a count, as in {option} {like}=2 or {like}=1..3")
        counts[name] = from_option(number)
    return counts


def require_plan(plan: Path | None, unit: str | None, snap: float, storey: str | None) -> None:
    """Raise ``RequestError`` for options of a plan without a plan."""
    if plan is None and (unit, snap, storey) != (None, 0.01, None):
        raise RequestError("--storey, --plan-unit and --snap need a plan: give the plan with --plan FILE")


def print_line(text: str) -> None:
    """Print a whole line, even if a signal ends the command meanwhile."""
    with heeded_after():
        print(text, flush=True)


def print_answer(command: str, answer: Any, exit_code: int = 0) -> None:
    """Print a command's answer in the form of ``--json``: see ``vitruvius.answers.houses``."""
    from vitruvius.answers.houses import encoded

    print_line(encoded(command, exit_code, answer))


def say_warnings() -> None:
    """Print warnings as ``lint`` does, without the line of Python that caused them."""
    warnings.showwarning = lambda message, *_: say(str(message))
