"""Errors of one cause are one error: what follows from a misspelt or absent name is not said again."""

import re
from collections.abc import Iterable
from typing import NamedTuple

from logic.errors import GrammarError


class Mistake(NamedTuple):
    """An error and what it is about."""

    error: GrammarError
    explains: frozenset[str] = frozenset()
    """Names that are wrong by it, predicates as ``type/1``: what else is said of them follows from it."""
    about: frozenset[str] | None = None
    """Names that must not be wrong already, where these are not all that the error's text has."""


def misspelt_name(error: GrammarError, name: str, meant: str) -> Mistake:
    """The mistake that a name is not the one that was meant, which may be empty."""
    return Mistake(error, frozenset({name, meant} - {""}), frozenset({name}))


def first_causes(found: Iterable[Mistake]) -> list[GrammarError]:
    """The errors without those that follow from one before them, and each once."""
    kept: dict[tuple[object, ...], GrammarError] = {}
    wrong: set[str] = set()
    for mistake in found:
        error = mistake.error
        about = mistake.about
        if about is None:
            about = frozenset(re.findall(r"\w+(?:/\d+)?", error.message))
        if not about & wrong:
            kept.setdefault((error.file, error.line, error.column, error.message), error)
            wrong |= mistake.explains
    return list(kept.values())
