"""By which promises a house is judged: its own, or others that are asked for."""

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from logic.checking.check import violations
from logic.errors import HouseFileError, RequestError
from logic.grammar import find, shipped
from logic.house.house import House
from logic.house.parts import Provenance
from logic.house.promises import PROMISES, Promises, read_promises
from logic.opener import content_of, from_json
from logic.spelling import unknown
from logic.workers.messages import Open, Promise, Promised
from logic.workers.solver import Solver

Standard = Promises | Mapping[str, Any] | str | Path
"""What houses are judged by: promises, some of them by name, a JSON file of these, a grammar."""

DEFAULT = "original"
"""The promises of stars that name no grammar: the paper's constraints, whatever the sizes."""

MOST_BYTES = 1 << 20
"""What is read of a file of promises."""

SECONDS = 60.0
"""Most seconds to find what a grammar promises."""


def check(house: House, promises: Standard | None = None) -> list[str]:
    """Judge a house: ``[]``, or its violations in words, each with its room, pieces and lengths.

    Without ``promises`` it is judged by its own, see ``promises_of``; with them by others, see ``standard``:
    ``"home"`` or another grammar's, or some of them, as ``{"door_clearance": 0.9, "passage": 0.9}``.
    Raises ``RequestError``, a ``ValueError``, for a promise that there is not.
    """
    if not isinstance(house, House):
        raise TypeError(
            f"check() takes one House, not {type(house).__name__}: logic.load(file) gives a list of them"
        )
    return violations(house, promises_of(house) if promises is None else standard(promises)(house))


def promises_of(house: House) -> Promises:
    """The promises that travel with the house; of a shipped grammar what ``promises.json`` says of it too.

    Of a house without any, those of the shipped grammar that it names, or of ``DEFAULT`` for stars that name
    none (the original's among them).
    """
    made = house.provenance
    if made is None:
        return PROMISES[DEFAULT] if house.main_room else Promises()
    said = _beside_what_is_stated(made, PROMISES.get(made.grammar, Promises()))
    if made.promises is None:
        return said
    return said.beside(made.promises) if made.grammar_hash == _hash_of(made.grammar) else made.promises


def _beside_what_is_stated(made: Provenance, said: Promises) -> Promises:
    """Return the grammar's promises without the rules that gave way to a brief, a plan or counts.

    The promises in the house file state these.
    """
    ways = ("opens",) if {"brief", "plan"} & made.request.keys() else ()
    typical = ("door_width", "room_size", "room_area", "narrowest", "lit") if made.gave_way else ()
    silent = msgspec.structs.asdict(Promises())
    return msgspec.structs.replace(said, **{name: silent[name] for name in (*ways, *typical)})


def standard(named: Standard) -> Callable[[House], Promises]:
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
    return standard(_read(Path(named)))


def _read(file: Path) -> dict[str, Any]:
    """Promises by name, as a JSON file states them."""
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
    """What houses of so many rooms promise, by the rules that have this hash."""
    name, late = Path(directory).name, f"{directory}: its promises took more than {SECONDS:g} s"
    worker = Solver(Open(grammar=directory))
    try:
        worker.loaded()
        found = worker.asked(Promise(request={"rooms": rooms}), Promised, SECONDS, late).promises
    finally:
        worker.end()
    return PROMISES[name].beside(found) if digest == _hash_of(name) else found


@cache
def _hash_of(grammar: str) -> str:
    """The hash of a shipped grammar as it is now; else nothing."""
    return find(grammar).hash if grammar in shipped() else ""
