"""Answers of commands with ``--json``: one object on the standard output, whatever happens.

``format``, ``command`` and ``exit_code`` are always present. ``answer`` is the result of the command,
``error`` the reason why there is none; one of the two is null. ``docs/answers.schema.json`` is their JSON
Schema.
"""

from typing import Any

import msgspec

from vitruvius.logic.dataset.reading import Counts
from vitruvius.logic.errors import Finding, Reason, VitruviusError, to_record
from vitruvius.logic.house.diff import Change
from vitruvius.logic.why.answer import Why

FORMAT = "vitruvius-answer-1"


class Failure(msgspec.Struct, frozen=True):
    """Reason why there is no answer.

    ``kind`` names an error of ``logic.errors``, or ``Interrupted``, ``OSError`` or ``Fault``. The place is
    that of an error in a grammar; the reasons are the conflict of a request that no house satisfies.
    """

    kind: str
    message: str
    file: str | None = None
    line: int | None = None
    column: int | None = None
    grammar: str | None = None
    request: str | None = None
    reasons: tuple[Reason, ...] = ()
    advice: str = ""
    unfurnishable: tuple[str, ...] = ()


class Violations(msgspec.Struct, frozen=True):
    """Violations of a house, by its index in the file."""

    house: int
    violations: list[str]


class Checked(msgspec.Struct, frozen=True, omit_defaults=True):
    """Answer of ``check``: the violations of each house in a file, and for a set the counts of its parts."""

    file: str
    nonconforming: int
    houses: list[Violations]
    set: Counts | None = None


class Linted(msgspec.Struct, frozen=True):
    """Answer of ``lint``: the findings in a grammar."""

    grammar: str
    errors: int
    warnings: int
    findings: list[Finding]


class Explained(msgspec.Struct, frozen=True):
    """Answer of ``explain``.

    It has a request, and the conflict if the request is not ``satisfiable``; or the reason ``why`` a part of
    a house is as it is.
    """

    satisfiable: bool | None = None
    grammar: str | None = None
    request: str | None = None
    reasons: tuple[Reason, ...] = ()
    advice: str = ""
    unfurnishable: tuple[str, ...] = ()
    file: str | None = None
    house: int | None = None
    why: Why | None = None


class Layouts(msgspec.Struct, frozen=True):
    """Number of layouts, of the rooms or of a type's furniture; there are more if it is not ``exact``."""

    name: str
    layouts: int
    exact: bool


class Generated(msgspec.Struct, frozen=True):
    """Answer of ``generate``: the place of the houses, or the houses themselves without ``out``."""

    out: str | None
    made: int
    seconds: float
    grammar: str
    seed: int
    start: int
    houses: list[dict[str, Any]] = []
    broken: list[str] = []
    """With ``--nearest``, the lines of the brief that the houses break, with what the houses keep instead; or
    the changes to rooms of the plan."""
    counted: list[Layouts] = []
    """With ``--count-layouts``, the counts; there are no houses then."""


class Differences(msgspec.Struct, frozen=True):
    """Changes of a house, by its index in both files."""

    house: int
    changes: list[Change]


class Drawn(msgspec.Struct, frozen=True):
    """Answer of ``draw``: the files, and with ``--diff`` the changes."""

    files: list[str]
    differences: list[Differences] = []


class Written(msgspec.Struct, frozen=True):
    """Answer of ``convert``, ``record`` and ``export``: the paths of the written files."""

    files: list[str]


def encoded(command: str, exit_code: int, answer: Any = None, error: Failure | None = None) -> str:
    """Return an answer as a line of JSON; numbers that are not finite are null."""
    record = {"format": FORMAT, "command": command, "exit_code": exit_code}
    record |= {"answer": answer, "error": error}
    try:
        return msgspec.json.encode(record).decode()
    except UnicodeEncodeError:  # a file's name that is not UTF-8
        return msgspec.json.encode(_escaped(msgspec.to_builtins(record))).decode()


def _escaped(value: Any) -> Any:
    """Return a JSON value whose texts are UTF-8; other bytes of names are escaped as in messages."""
    if isinstance(value, dict):
        return {_escaped(key): _escaped(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_escaped(each) for each in value]
    return value.encode(errors="backslashreplace").decode() if isinstance(value, str) else value


def failure(error: BaseException) -> Failure:
    """Return the record of an error."""
    if isinstance(error, VitruviusError):
        return msgspec.convert(to_record(error), Failure)
    kind = "Interrupted" if isinstance(error, KeyboardInterrupt) else type(error).__name__
    return Failure(kind, str(error))
