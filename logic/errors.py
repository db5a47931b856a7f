"""Errors of the package, as a tree.

::

    VitruviusError
    ├── GrammarError    a rule file is absent or wrong: file, line, column
    ├── RequestError    the request makes no sense: wrong usage
    ├── HouseFileError  a house file is absent, truncated or wrong
    ├── Unsatisfiable   proved: no house satisfies the request
    ├── LimitReached    the stated budget ran out before a house or a proof: OutOfInferences, Killed
    └── MissingProgram  SWI-Prolog or another program is not installed, or does not answer
"""

from pathlib import Path
from typing import Any

import msgspec

from vitruvius.logic.spelling import printable


class VitruviusError(Exception):
    """Base of all errors that a user can act on. The text says what is wrong, where, and what to do next."""

    exit_code = 70

    keeps = ""
    """Control characters that a message may contain. All others are escaped: a message may quote a file."""

    def __init__(self, message: object = "") -> None:
        """Escape the control characters of the message."""
        super().__init__(printable(str(message), self.keeps))


class GrammarError(VitruviusError):
    """A grammar is absent or one of its rule files is wrong."""

    exit_code = 5
    keeps = "\n"

    def __init__(
        self, message: str, file: str | Path | None = None, line: int | None = None, column: int | None = None
    ) -> None:
        """Add the place to the message.

        File, line and column may each be unknown; lines and columns count from 1.
        """
        self.message, self.file, self.line, self.column = message, file, line, column
        place = ":".join(str(part) for part in (file, line, column) if part is not None)
        super().__init__(f"{place}: {message}" if place else message)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle all attributes."""
        return from_record, (to_record(self),)


class GrammarWarning(UserWarning):
    """Warning about a rule of a grammar that has no effect, with its place and the words of ``lint``."""


class PlanWarning(UserWarning):
    """Warning about parts of a user's plan that the reader moved, ignored or closed."""


class RequestError(VitruviusError, ValueError):
    """Request that makes no sense with any rules, such as a count below zero or an unknown type."""

    exit_code = 2


class HouseFileError(VitruviusError):
    """House file that is absent, truncated, of another format, or holds impossible values."""

    exit_code = 5


class Reason(msgspec.Struct, frozen=True):
    """Statement of the user: a rule, a fact or a clause with its place, or a choice without a place."""

    text: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    typical: bool = False
    """True for a rule that gives way to the user's statements about rooms."""

    def __str__(self) -> str:
        """Return a line such as ``rooms.lp:8:1: :- rooms >= 3, basic(T), not room(_,T).``."""
        kind = " (typical)" if self.typical else ""
        return f"{self.file}:{self.line}:{self.column}: {self.text}{kind}" if self.file else self.text


class Finding(msgspec.Struct, frozen=True):
    """Mistake in a grammar, with its severity (``error`` or ``warning``) and its place."""

    severity: str
    file: str
    line: int
    column: int
    text: str

    def __str__(self) -> str:
        """Return a line as in ``sizes.pl:6:1: error: nothing uses room_gab/1: did you mean room_gap/1?``."""
        return f"{self.file}:{self.line}:{self.column}: {self.severity}: {self.text}"


class Unsatisfiable(VitruviusError):
    """Proof that no house satisfies the request.

    ``reasons`` is a minimal unsatisfiable core of the user's own statements and choices: without any one of
    them the rest does not conflict, although other conflicts may exist. ``unfurnishable`` names the room
    types of the core that cannot be furnished. ``advice`` says what would help, if known.
    """

    exit_code = 3
    keeps = "\n"

    def __init__(
        self,
        grammar: str,
        request: str,
        reasons: tuple[Reason, ...],
        advice: str = "",
        unfurnishable: tuple[str, ...] = (),
    ) -> None:
        """Keep the core and write the message."""
        self.grammar, self.request, self.reasons = grammar, request, reasons
        self.advice, self.unfurnishable = advice, unfurnishable
        since = "".join(f", since no {type_} can be furnished" for type_ in unfurnishable)
        listed = "".join(f"\n  {reason}" for reason in reasons)
        only = "this forbids it" if len(reasons) == 1 else "these conflict, so one of them must change"
        hint = f"\n{advice}" if advice else ""
        super().__init__(f"no house of {grammar} has {request}{since}: {only}{listed}{hint}")

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle all attributes."""
        return from_record, (to_record(self),)


class LimitReached(VitruviusError):
    """The stated budget of inferences or seconds ran out before a house or a proof was found."""

    exit_code = 4
    keeps = "\n"


class OutOfInferences(LimitReached):
    """The Prolog inferences for a house ran out. Callers that know the number state it in the message."""

    def __init__(self, message: str = "the Prolog inferences for a house ran out") -> None:
        """Keep the message."""
        super().__init__(message)


class Killed(LimitReached):
    """A process was killed from outside: a solver, whose house remains unknown, or a rank of a run."""


class MissingProgram(VitruviusError):
    """A program that Vitruvius needs is not installed, or does not answer."""

    exit_code = 69
    keeps = "\n"


def to_record(error: VitruviusError) -> dict[str, Any]:
    """Return an error as JSON, the inverse of ``from_record``."""
    record: dict[str, Any] = {"kind": type(error).__name__, "message": str(error)}
    if isinstance(error, GrammarError):
        file = str(error.file) if error.file else None
        record |= {"message": error.message, "file": file, "line": error.line, "column": error.column}
    if isinstance(error, Unsatisfiable):
        reasons = msgspec.to_builtins(error.reasons)
        record |= {"grammar": error.grammar, "request": error.request, "reasons": reasons}
        record |= {"advice": error.advice, "unfurnishable": list(error.unfurnishable)}
    return record


def from_record(record: dict[str, Any]) -> VitruviusError:
    """Return the error that ``to_record`` wrote."""
    kind: type[VitruviusError] = globals()[record["kind"]]
    if kind is GrammarError:
        return GrammarError(record["message"], record["file"], record["line"], record["column"])
    if kind is Unsatisfiable:
        reasons = msgspec.convert(record["reasons"], tuple[Reason, ...])
        types = tuple(record["unfurnishable"])
        return Unsatisfiable(record["grammar"], record["request"], reasons, record["advice"], types)
    return kind(record["message"])
