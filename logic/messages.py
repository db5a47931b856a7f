"""What clingo says, as errors with file, line and column."""

import re
from collections.abc import Iterable

from logic.errors import GrammarError

_PLACED = re.compile(
    r"^(?P<file>.+?):(?P<line>\d+):(?P<column>\d+)(?:-[\d:]+)?: (?P<kind>\w+): (?P<text>.*)$", re.S
)


def clingo_error(remarks: Iterable[str], otherwise: str) -> GrammarError:
    """The first error among clingo's remarks; without one, an error with this text."""
    for remark in remarks:
        found = _PLACED.match(remark.strip())
        if found and found["kind"] == "error":
            return placed_error(remark)
    return GrammarError(otherwise)


def placed_error(remark: str) -> GrammarError:
    """One remark of clingo's as an error at its place."""
    found = _PLACED.match(remark.strip())
    if not found:
        return GrammarError(remark.strip())
    text = " ".join(found["text"].split())
    return GrammarError(text, found["file"], int(found["line"]), int(found["column"]))
