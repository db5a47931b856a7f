"""What is wrong with a grammar's ``.pl`` files, as Prolog finds it, in the words of their author."""

import re
from pathlib import Path

from logic.errors import GrammarError
from logic.language.asp.inexpressible import inexpressible
from logic.language.asp.vocabulary import core_words
from logic.language.prolog_syntax import explained


def unknown(name: str, text: str, file: str, line: int, column: int) -> GrammarError:
    """An error for a name in a ``.pl`` file that nothing knows: of a predicate, a room type or a piece."""
    if name in {each for each, _ in core_words().documented}:
        text = f"{name} belongs in a .lp file: see docs/rules.md"
    # A misspelt name, or too many arguments, is that before it asks for too much: door_widht is door_width.
    is_said = re.search(r"/\d+: ", text) or ": did you mean" in text
    return GrammarError(text if is_said else inexpressible(name) or text, file, line, column)


def problem(file: str, line: int, column: int, text: str, name: str) -> GrammarError:
    """A problem of the grammar's files; ``name`` is that of a predicate that is not known, or empty."""
    if name:
        return unknown(name, text, file, line, column)
    if text.startswith("syntax error: "):
        line, column, text = explained(Path(file).read_text("utf-8", "replace"), line, column, text[14:])
    return GrammarError(text, file, line, column)
