"""What commands share: options that are given several times, answers and warnings as they are printed."""

import re
import warnings
from typing import Any

import tyro

from logic.errors import RequestError
from logic.terminal import say

Repeated = tyro.conf.UseAppendAction


def counts(option: str, texts: tuple[str, ...]) -> dict[str, Any]:
    """``("bedroom=2", "hall=..1")`` as ``{"bedroom": 2, "hall": (0, 1)}``."""
    from logic.request.request import from_option

    counts = {}
    for text in texts:
        name, _, number = text.partition("=")
        if not name or not re.fullmatch(r"\d+|\d*\.\.\d*", number) or name in counts:
            raise RequestError(f"{option} {text}: give each name once, as in {option} bed=2 or bed=1..3")
        counts[name] = from_option(number)
    return counts


def print_answer(command: str, answer: Any, exit_code: int = 0) -> None:
    """Print what a command found as ``--json`` has it: see ``vitruvius.answers.houses``."""
    from vitruvius.answers.houses import encoded

    print(encoded(command, exit_code, answer), flush=True)


def say_warnings() -> None:
    """Print a warning as ``lint`` does, without the line of Python that it came by."""
    warnings.showwarning = lambda message, *_: say(str(message))
