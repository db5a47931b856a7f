"""First causes among errors: errors that follow from a misspelt or absent name are dropped."""

import re
from collections.abc import Iterable
from typing import NamedTuple

from vitruvius.logic.errors import GrammarError


class Mistake(NamedTuple):
    """Error with the names that it concerns."""

    error: GrammarError
    explains: frozenset[str] = frozenset()
    """Names that this error makes wrong, predicates as ``type/1``.

    Further errors about them follow from this one.
    """
    about: frozenset[str] | None = None
    """Names that an earlier error must not concern; by default all names in the error's text."""


def misspelt_name(error: GrammarError, name: str, meant: str) -> Mistake:
    """Return the mistake of a name that should be ``meant``, which may be empty."""
    return Mistake(error, frozenset({name, meant} - {""}), frozenset({name}))


def first_causes(found: Iterable[Mistake]) -> list[GrammarError]:
    """Return each error once, without errors that follow from an earlier one."""
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
