"""What can go wrong, as a tree.

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

from logic.spelling import printable


class VitruviusError(Exception):
    """Any error that a user can act on: its text says what, where and what next."""

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
        """Place the message: file, line and column count from 1, and each may be unknown."""
        self.message, self.file, self.line, self.column = message, file, line, column
        place = ":".join(str(part) for part in (file, line, column) if part is not None)
        super().__init__(f"{place}: {message}" if place else message)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle all of it."""
        return from_record, (to_record(self),)


class GrammarWarning(UserWarning):
    """A rule of a grammar has no effect: its place and what is said of it, as ``lint`` says it."""


class PlanWarning(UserWarning):
    """What was moved in a user's plan, passed over or shut, so that it could be read."""


class RequestError(VitruviusError, ValueError):
    """The request makes no sense, whatever the rules: a count below zero, an unknown type."""

    exit_code = 2


class HouseFileError(VitruviusError):
    """A house file is absent, truncated, of another format, or holds impossible values."""

    exit_code = 5


class Reason(msgspec.Struct, frozen=True):
    """A statement of the user's: a rule, a fact or a clause with its place, or a choice without one."""

    text: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    typical: bool = False
    """True for a rule that gives way to the user's statements about rooms."""

    def __str__(self) -> str:
        """As in ``rooms.lp:8:1: :- rooms >= 3, basic(T), not room(_,T).``."""
        kind = " (typical)" if self.typical else ""
        return f"{self.file}:{self.line}:{self.column}: {self.text}{kind}" if self.file else self.text


class Finding(msgspec.Struct, frozen=True):
    """Something wrong with a grammar: ``error`` or ``warning``, by its place."""

    severity: str
    file: str
    line: int
    column: int
    text: str

    def __str__(self) -> str:
        """As in ``sizes.pl:6:1: error: nothing uses room_gab/1: did you mean room_gap/1?``."""
        return f"{self.file}:{self.line}:{self.column}: {self.severity}: {self.text}"


class Unsatisfiable(VitruviusError):
    """Proved: no house satisfies the request.

    ``reasons`` are a minimal conflict of the user's own statements and choices: take one away and the others
    are in none (but there may be other conflicts). ``unfurnishable`` names the types of room that are part
    of it because they cannot be furnished. ``advice`` says what would do, if known.
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
        """Keep the conflict."""
        self.grammar, self.request, self.reasons = grammar, request, reasons
        self.advice, self.unfurnishable = advice, unfurnishable
        since = "".join(f", since no {type_} can be furnished" for type_ in unfurnishable)
        listed = "".join(f"\n  {reason}" for reason in reasons)
        only = "this forbids it" if len(reasons) == 1 else "these conflict, so one of them must change"
        hint = f"\n{advice}" if advice else ""
        super().__init__(f"no house of {grammar} has {request}{since}: {only}{listed}{hint}")

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle all of it."""
        return from_record, (to_record(self),)


class LimitReached(VitruviusError):
    """The stated budget, of inferences or seconds, ran out before a house or a proof was found."""

    exit_code = 4
    keeps = "\n"


class OutOfInferences(LimitReached):
    """The Prolog inferences for a house ran out: who knows how many there were says so."""

    def __init__(self, message: str = "the Prolog inferences for a house ran out") -> None:
        """Keep the message."""
        super().__init__(message)


class Killed(LimitReached):
    """A process was killed from outside: a solver, and of its house nothing is known; a rank of a run."""


class MissingProgram(VitruviusError):
    """A program that Vitruvius needs is not installed, or does not answer."""

    exit_code = 69
    keeps = "\n"


def to_record(error: VitruviusError) -> dict[str, Any]:
    """An error as JSON; ``from_record`` gives it back."""
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
    """The error that ``to_record`` wrote."""
    kind: type[VitruviusError] = globals()[record["kind"]]
    if kind is GrammarError:
        return GrammarError(record["message"], record["file"], record["line"], record["column"])
    if kind is Unsatisfiable:
        reasons = msgspec.convert(record["reasons"], tuple[Reason, ...])
        types = tuple(record["unfurnishable"])
        return Unsatisfiable(record["grammar"], record["request"], reasons, record["advice"], types)
    return kind(record["message"])
