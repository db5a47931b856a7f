"""What can go wrong, as a tree.

::

    VitruviusError
    ├── GrammarError    a rule file is absent or wrong: file, line, column
    ├── RequestError    the request makes no sense: wrong usage
    ├── HouseFileError  a house file is absent, truncated or wrong
    ├── Unsatisfiable   proved: no house satisfies the request
    ├── LimitReached    the stated budget ran out before a house or a proof
    └── MissingProgram  SWI-Prolog or one of its libraries is not installed
"""

from pathlib import Path
from typing import Any


class VitruviusError(Exception):
    """Any error that a user can act on: its text says what, where and what next."""

    exit_code = 70


class GrammarError(VitruviusError):
    """A grammar is absent or one of its rule files is wrong."""

    exit_code = 5

    def __init__(
        self, message: str, file: str | Path | None = None, line: int | None = None, column: int | None = None
    ) -> None:
        """Place the message: file, line and column count from 1, and each may be unknown."""
        self.message, self.file, self.line, self.column = message, file, line, column
        place = ":".join(str(part) for part in (file, line, column) if part is not None)
        super().__init__(f"{place}: {message}" if place else message)


class RequestError(VitruviusError, ValueError):
    """The request makes no sense, whatever the rules: a count below zero, an unknown type."""

    exit_code = 2


class HouseFileError(VitruviusError):
    """A house file is absent, truncated, of another format, or holds impossible values."""

    exit_code = 5


class Unsatisfiable(VitruviusError):
    """Proved: no house satisfies the request. ``reasons`` are the user's choices that clash."""

    exit_code = 3

    def __init__(self, message: str, reasons: tuple[str, ...] = ()) -> None:
        """Keep the minimal set of clashing choices, each in the user's words."""
        super().__init__(message)
        self.reasons = reasons


class LimitReached(VitruviusError):
    """The stated budget, of inferences or seconds, ran out before a house or a proof was found."""

    exit_code = 4


class MissingProgram(VitruviusError):
    """A program that Vitruvius needs is not installed."""

    exit_code = 69


def to_record(error: VitruviusError) -> dict[str, Any]:
    """An error as JSON; ``from_record`` gives it back."""
    record: dict[str, Any] = {"kind": type(error).__name__, "message": str(error)}
    if isinstance(error, GrammarError):
        file = str(error.file) if error.file else None
        record |= {"message": error.message, "file": file, "line": error.line, "column": error.column}
    if isinstance(error, Unsatisfiable):
        record["reasons"] = error.reasons
    return record


def from_record(record: dict[str, Any]) -> VitruviusError:
    """The error that ``to_record`` wrote."""
    kind: type[VitruviusError] = globals()[record["kind"]]
    if kind is GrammarError:
        return GrammarError(record["message"], record["file"], record["line"], record["column"])
    if kind is Unsatisfiable:
        return Unsatisfiable(record["message"], tuple(record["reasons"]))
    return kind(record["message"])
