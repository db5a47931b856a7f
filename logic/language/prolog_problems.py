"""Mistakes that Prolog finds in a grammar's ``.pl`` files, in words for their author."""

import re
from pathlib import Path

from vitruvius.logic.errors import GrammarError
from vitruvius.logic.language.asp.inexpressible import inexpressible
from vitruvius.logic.language.asp.vocabulary import core_words
from vitruvius.logic.language.prolog_syntax import explained


def unknown(name: str, text: str, file: str, line: int, column: int) -> GrammarError:
    """Return an error for an unknown name in a ``.pl`` file: of a predicate, a room type or a piece."""
    if name in {each for each, _ in core_words().documented}:
        text = f"{name} belongs in a .lp file: see docs/rules.md"
    # A misspelt name or a wrong number of arguments is more likely than a wish for too much: door_widht is
    # door_width.
    is_said = re.search(r"/\d+: ", text) or ": did you mean" in text
    return GrammarError(text if is_said else inexpressible(name) or text, file, line, column)


def problem(file: str, line: int, column: int, text: str, name: str) -> GrammarError:
    """Return an error for a problem of the grammar's files; ``name`` is an unknown predicate or empty."""
    if name:
        return unknown(name, text, file, line, column)
    if text.startswith("syntax error: "):
        line, column, text = explained(Path(file).read_text("utf-8", "replace"), line, column, text[14:])
    return GrammarError(text, file, line, column)
