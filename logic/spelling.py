"""Which known name a misspelt one was meant to be; names and numbers in sentences."""

import difflib
import inspect
import re
import shlex
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from html import escape
from typing import ParamSpec, TypeVar

MAX_LETTERS, MAX_NAMES, MAX_LISTED = 100, 2_000, 200
"""Length of a name that is compared, number of names that are compared, and names that a message lists."""

P = ParamSpec("P")
R = TypeVar("R")


def closest(name: str, names: Iterable[str]) -> str | None:
    """The most similar name, of equally similar ones one that begins alike, and the one nearest in length;
    None if none is.

    ``difflib.get_close_matches`` would take *beside* for *bde* rather than *bed*. Upper and lower case are
    as good as alike.
    """

    def likeness(other: str) -> tuple[float, float, bool, int]:
        ratio = difflib.SequenceMatcher(None, name.casefold(), other.casefold()).ratio()
        exact = difflib.SequenceMatcher(None, name, other).ratio()
        return ratio, exact, name[:1] == other[:1], -abs(len(other) - len(name))

    names = sorted(names)
    if len(name) > MAX_LETTERS or len(names) > MAX_NAMES:
        return None
    best = max(names, key=likeness, default=None)
    return best if best is not None and likeness(best)[0] >= 0.65 else None


def unknown(what: str, name: object, names: Iterable[str]) -> str:
    """As in ``there is no preset papre: did you mean paper? There are dqn, paper, pqn``."""
    names, shown = list(names), str(name)[: MAX_LETTERS + 1] or repr(name)
    if len(shown) > MAX_LETTERS:
        shown = f"{shown[:MAX_LETTERS]}..."
    close = closest(str(name), names)
    hint = f": did you mean {close}? There are " if close else ": there are "
    return f"there is no {what} {shown}{hint}{listed(names)}"


def listed(names: Sequence[str]) -> str:
    """Return names as in ``dqn, paper, pqn``: the first ``MAX_LISTED`` of them."""
    return ", ".join(names[:MAX_LISTED]) + (", ..." if len(names) > MAX_LISTED else "")


def numbered(number: int, noun: str) -> str:
    """As in ``1 house`` and ``1,200 houses``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def article(noun: str) -> str:
    """Return a noun with its article, as in ``a bedroom``, ``an openspace``, ``a utility``."""
    return f"{'an' if re.match('[aeio]|u(?!ni|ti|s)', noun, re.IGNORECASE) else 'a'} {noun}"


def keywords(**meant: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """A function whose ``TypeError`` for a wrong keyword names the right one: that of ``meant``, if it
    has one, else the most similar.
    """

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        names = [name for name in inspect.signature(function).parameters if name != "self"]

        @wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            for name in kwargs.keys() - names:
                close = meant.get(name) or closest(name, names)
                hint = f"did you mean {close}?" if close else f"it has {', '.join(names)}"
                raise TypeError(
                    f"{function.__qualname__}() got an unexpected keyword argument '{name}': {hint}"
                )
            return function(*args, **kwargs)

        return call

    return decorated


def quoted(path: object) -> str:
    """A path as a shell takes it for one word, where a command is named that is to be typed."""
    text = str(path)
    return text if re.fullmatch(r"[\w@%+=:,./-]+", text) else shlex.quote(text)  # which quotes ä, too


def printable(text: str, keep: str = "") -> str:
    """A text that others wrote, its control characters escaped but for those that are kept: names may hold
    what moves a terminal's cursor, and what XML cannot.
    """
    if text.isprintable():
        return text
    return "".join(
        letter if letter.isprintable() or letter in keep else letter.encode("unicode_escape").decode()
        for letter in text
    )


def markup(text: object) -> str:
    """Return text escaped for HTML and SVG, so that its tags, entities and quotes are shown as text.

    Every page and picture escapes text of files by this function alone.
    """
    return escape(printable(str(text)))
