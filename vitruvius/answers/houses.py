"""What commands print with ``--json``: one object on the standard output, whatever comes out.

``format``, ``command`` and ``exit_code`` are always there; ``answer`` is what the command found, ``error``
why it found nothing, and one of the two is null. ``docs/answers.schema.json`` is their JSON Schema.
"""

from typing import Any

import msgspec

from logic.dataset.reading import Counts
from logic.errors import Finding, Reason, VitruviusError, to_record
from logic.house.diff import Change
from logic.why.answer import Why

FORMAT = "vitruvius-answer-1"


class Failure(msgspec.Struct, frozen=True):
    """Why there is no answer: ``kind`` names an error of ``logic.errors``, or ``Interrupted``, ``OSError``
    or ``Fault``; the place is a grammar's, the conflict of a request that no house satisfies.
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
    """What is wrong with a house, by its index in the file."""

    house: int
    violations: list[str]


class Checked(msgspec.Struct, frozen=True, omit_defaults=True):
    """Answer of ``check``: the violations of each house in a file, and for a set the counts of its parts."""

    file: str
    nonconforming: int
    houses: list[Violations]
    set: Counts | None = None


class Linted(msgspec.Struct, frozen=True):
    """Of ``lint``."""

    grammar: str
    errors: int
    warnings: int
    findings: list[Finding]


class Explained(msgspec.Struct, frozen=True):
    """Of ``explain``: a request, and the conflict if it is not ``satisfiable``; or ``why`` a part of a house
    is as it is.
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
    """The number of layouts, of the rooms or of a type's furniture; where not ``exact``, there are more."""

    name: str
    layouts: int
    exact: bool


class Generated(msgspec.Struct, frozen=True):
    """Of ``generate``: where the houses are, or the houses themselves where there is no ``out``."""

    out: str | None
    made: int
    seconds: float
    grammar: str
    seed: int
    start: int
    houses: list[dict[str, Any]] = []
    broken: list[str] = []
    """With ``--nearest``, the lines of the brief that the houses break, and what they keep in their place; or
    how rooms of the plan differ.
    """
    counted: list[Layouts] = []
    """With ``--count-layouts``, in place of houses."""


class Differences(msgspec.Struct, frozen=True):
    """What changed in a house, by its index in both files."""

    house: int
    changes: list[Change]


class Drawn(msgspec.Struct, frozen=True):
    """Of ``draw``: the files, and with ``--diff`` what changed."""

    files: list[str]
    differences: list[Differences] = []


class Written(msgspec.Struct, frozen=True):
    """Answer of ``convert``, ``record`` and ``export``: the paths of the written files."""

    files: list[str]


def encoded(command: str, exit_code: int, answer: Any = None, error: Failure | None = None) -> str:
    """An answer as a line of JSON; numbers that are no finite ones are null."""
    record = {"format": FORMAT, "command": command, "exit_code": exit_code}
    record |= {"answer": answer, "error": error}
    try:
        return msgspec.json.encode(record).decode()
    except UnicodeEncodeError:  # by a name of a file that is no UTF-8
        return msgspec.json.encode(_escaped(msgspec.to_builtins(record))).decode()


def _escaped(value: Any) -> Any:
    """A value of JSON whose texts are UTF-8, other bytes of names escaped as messages have them."""
    if isinstance(value, dict):
        return {_escaped(key): _escaped(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_escaped(each) for each in value]
    return value.encode(errors="backslashreplace").decode() if isinstance(value, str) else value


def failure(error: BaseException) -> Failure:
    """What is said of an error."""
    if isinstance(error, VitruviusError):
        return msgspec.convert(to_record(error), Failure)
    kind = "Interrupted" if isinstance(error, KeyboardInterrupt) else type(error).__name__
    return Failure(kind, str(error))
