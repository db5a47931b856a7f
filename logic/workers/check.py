"""Promises by which a house is judged: its own, or others on request."""

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from vitruvius.logic.checking.check import violations
from vitruvius.logic.errors import HouseFileError, RequestError
from vitruvius.logic.grammar import find, shipped
from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import OLD_PROMISES, Promises, read_promises
from vitruvius.logic.opener import content_of, from_json
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.spelling import unknown
from vitruvius.logic.workers.pool import described

Chosen = Promises | Mapping[str, Any] | str | Path
"""Promises that judge houses: all of them, some by name, a JSON file of some, or a grammar."""

DEFAULT = "original"
"""Key of the promises for stars that name no grammar: the paper's constraints for all sizes."""

MOST_BYTES = 1 << 20
"""Largest size of a file of promises, in bytes."""


def check(house: House, promises: Chosen | None = None) -> list[str]:
    """Check a house.

    Return its violations in words, with rooms, pieces and lengths, or ``[]`` if there are none.

    Without ``promises`` the house's own promises judge it: see ``promises_of``. ``promises`` may be the name
    of a grammar, as ``"home"``, or replace some promises, as ``{"door_clearance": 0.9, "passage": 0.9}``: see
    ``promises_by``. Raises ``RequestError``, a ``ValueError``, for an unknown promise.
    """
    if not isinstance(house, House):
        raise TypeError(
            f"check() takes one House, not {type(house).__name__}: vitruvius.load(file) gives a list of them"
        )
    return violations(house, promises_of(house) if promises is None else promises_by(promises)(house))


def promises_of(house: House) -> Promises:
    """Return the promises in the house's provenance.

    An old house without promises has those of ``OLD_PROMISES`` for the shipped grammar that it names. A star
    that names no grammar, such as the original's, has those of ``DEFAULT``.
    """
    made = house.provenance
    if made is None:
        return OLD_PROMISES[DEFAULT] if house.main_room else Promises()
    if made.promises is not None:
        return made.promises
    old = OLD_PROMISES.get(made.grammar, Promises())
    # A plan or a brief may join rooms by other doors.
    return msgspec.structs.replace(old, opens={}) if {"brief", "plan"} & made.request.keys() else old


def promises_by(named: Chosen) -> Callable[[House], Promises]:
    """Return a function from a house to the promises that judge it.

    ``named`` is promises, a mapping or a JSON file that replaces some of the house's promises, or a grammar's
    name or folder. Raises ``RequestError`` for an unknown promise, ``HouseFileError`` for one in a file,
    ``GrammarError`` for a grammar that is absent or wrong.
    """
    if isinstance(named, Promises):
        return lambda _: named
    if isinstance(named, Mapping):
        read_promises(named, Promises())
        return lambda house: read_promises(named, promises_of(house))
    if str(named) in shipped() or Path(named).is_dir():
        rules = find(named)
        return lambda house: _of_grammar(str(rules.directory), rules.hash, len(house.counted))
    return promises_by(_read(Path(named)))


def _read(file: Path) -> dict[str, Any]:
    """Return the promises in a JSON file, by name."""
    try:
        stated = from_json(content_of(file, MOST_BYTES), dict[str, Any])
        read_promises(stated, Promises())
    except FileNotFoundError:
        other = unknown("grammar", file, shipped())
        raise HouseFileError(f"{file}: there is no such JSON file of promises, and {other}") from None
    except OSError as error:
        raise HouseFileError(f"{file}: cannot be read: {error.strerror}") from None
    except RequestError as error:
        raise HouseFileError(f"{file}: {error}") from None
    except ValueError as error:
        raise HouseFileError(f"{file}: no promises: {error}") from None
    return stated


@cache
def _of_grammar(directory: str, digest: str, rooms: int) -> Promises:
    """Return the promises of houses with ``rooms`` rooms, by the rules with this hash."""
    _, promises = described(HouseRequest(rooms, grammar=directory))
    return promises
