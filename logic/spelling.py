"""Suggestions for misspelt names, and words for names and numbers in messages."""

import difflib
import inspect
import re
import shlex
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from html import escape
from inspect import Parameter
from typing import Any, ParamSpec, TypeVar, get_args, get_type_hints

MAX_LETTERS, MAX_NAMES, MAX_LISTED = 100, 2_000, 200
"""Limits: letters of a compared name, number of compared names, number of names that a message lists."""

P = ParamSpec("P")
R = TypeVar("R")


def closest(name: str, names: Iterable[str]) -> str | None:
    """Return the most similar name, or None if none is similar.

    Ties go to a name with the same first letter, then to the name nearest in length. Case counts only between
    names that are equally similar otherwise. ``difflib.get_close_matches`` would suggest *beside* for *bde*
    rather than *bed*.
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
    """Return a message as in ``there is no preset papre: did you mean paper? There are dqn, paper, pqn``."""
    names, shown = list(names), str(name)[: MAX_LETTERS + 1] or repr(name)
    if len(shown) > MAX_LETTERS:
        shown = f"{shown[:MAX_LETTERS]}..."
    close = closest(str(name), names)
    hint = f": did you mean {close}? There are " if close else ": there are "
    return f"there is no {what} {shown}{hint}{listed(names)}"


def listed(names: Sequence[str]) -> str:
    """Return at most ``MAX_LISTED`` names as in ``dqn, paper, pqn``."""
    return ", ".join(names[:MAX_LISTED]) + (", ..." if len(names) > MAX_LISTED else "")


def numbered(number: int, noun: str) -> str:
    """Return a number with its noun, as in ``1 house`` and ``1,200 houses``."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def article(noun: str) -> str:
    """Return a noun with its article, as in ``a bedroom``, ``an openspace``, ``a utility``."""
    return f"{'an' if re.match('[aeio]|u(?!ni|ti|s)', noun, re.IGNORECASE) else 'a'} {noun}"


def keywords(**meant: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Return a decorator for functions whose ``TypeError`` for a wrong keyword suggests the right one.

    The suggestion is that of ``meant``, else the most similar keyword. Keywords that a function takes by a
    ``TypedDict`` become part of its signature.
    """

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        signature = _unpacked(function)
        names = [name for name in signature.parameters if name != "self"]

        @wraps(function)
        def call(*args: P.args, **kwargs: P.kwargs) -> R:
            for name in kwargs.keys() - names:
                close = meant.get(name) or closest(name, names)
                hint = f"did you mean {close}?" if close else f"it has {', '.join(names)}"
                raise TypeError(
                    f"{function.__qualname__}() got an unexpected keyword argument '{name}': {hint}"
                )
            return function(*args, **kwargs)

        vars(call)["__signature__"] = signature
        return call

    return decorated


def _unpacked(function: Callable[..., Any]) -> inspect.Signature:
    """Return a function's signature with the keywords of a ``TypedDict`` one by one; all may be left out."""
    own = inspect.signature(function)
    *others, last = own.parameters.values()
    if last.kind is not last.VAR_KEYWORD or not (keys := get_args(last.annotation)):
        return own
    stated = get_type_hints(keys[0]).items()
    more = [Parameter(name, Parameter.KEYWORD_ONLY, default=..., annotation=kind) for name, kind in stated]
    named = [each for each in others if each.kind is Parameter.KEYWORD_ONLY]
    return own.replace(parameters=[*(each for each in others if each not in named), *more, *named])


def quoted(path: object) -> str:
    """Return a path quoted as one word for a shell, for a message that shows a command to type."""
    text = str(path)
    return text if re.fullmatch(r"[\w@%+=:,./-]+", text) else shlex.quote(text)  # quotes ä, too


def printable(text: str, keep: str = "") -> str:
    """Return a text of unknown origin with its control characters escaped, except those in ``keep``.

    Names may contain characters that move a terminal's cursor or that XML cannot contain.
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
