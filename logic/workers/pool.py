"""Houses of a request: solver processes generate the houses, and their answers come in order."""

import atexit
import os
import threading
import warnings
from collections.abc import Generator, Iterator
from contextlib import closing, contextmanager

from vitruvius.logic.errors import GrammarWarning, LimitReached, RequestError, Unsatisfiable, VitruviusError
from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.messages import Judged, Loaded, Made, MakeHouse, Open, Promise, Promised, Warn
from vitruvius.logic.workers.solver import LOADING, START_UP, Solver

MOST_IDLE = 2
"""Number of idle solver processes. Each saves the half second that it takes to start one."""


Key = tuple[str, str, float]
"""Hash of some rules, their directory, and the cell of the grid that they are loaded for."""


class Idle:
    """Idle solver processes, by the rules that they have loaded. Safe among threads."""

    def __init__(self) -> None:
        """Begin without processes."""
        self.forget()
        atexit.register(self.end)
        # A forked child copies the pipes, but the processes answer only its parent.
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self.forget)

    def forget(self) -> None:
        """Begin again without processes, and leave the old ones running."""
        self._lock, self._workers = threading.Lock(), []

    def take(self, key: Key) -> Solver | None:
        """Remove and return a running process that has loaded exactly these rules, or None if none has."""
        with self._lock:
            places = [place for place, (loaded, _) in enumerate(self._workers) if loaded == key]
            worker = self._workers.pop(places[-1])[1] if places else None
        if worker is None or worker.is_alive():
            return worker
        worker.end()
        return self.take(key)

    def add(self, key: Key, worker: Solver) -> None:
        """Add a process, and end the least recently used ones beyond ``MOST_IDLE``."""
        with self._lock:
            self._workers.append((key, worker))
            late = [self._workers.pop(0)[1] for _ in range(len(self._workers) - MOST_IDLE)]
        for unused in late:
            unused.end()

    def end(self) -> None:
        """End all processes."""
        while self._workers:
            self._workers.pop()[1].end()


_idle = Idle()

_loaded: dict[Key, dict[str, str]] = {}
"""Versions of the solvers, by the rules that a solver process of this process has loaded.

For these rules clingo had no remarks.
"""

_warned: set[str] = set()
"""Hashes of the rules whose warnings this process has given, so that each is given once."""


def houses(request: HouseRequest, seed: int, indices: range, workers: int = 1) -> Iterator[House]:
    """Yield the houses of these indices in order. Raises as ``generate`` does."""
    with closing(outcomes(request, seed, indices, workers)) as found:
        for made in found:
            if isinstance(made, LimitReached):
                raise made
            yield made


def described(request: HouseRequest) -> tuple[dict[str, str], Promises]:
    """Return the versions of the programs that generate the houses, and the promises of the houses.

    Raises as ``generate`` does, and ``RequestError`` if houses with different numbers of rooms promise
    different things.
    """
    name = request.rules.name
    late = f"computing the promises of {name} took {request.seconds:g} seconds"
    with _team(request, 1) as [worker]:
        found, *others = (
            worker.asked(Promise(request=each), Promised, request.seconds, late)
            for each in request.each_size()
        )
        if any(each != found for each in others):
            raise RequestError(
                f"rooms: houses of {name} of {request.rooms} to {request.most_rooms} rooms make different "
                "promises: give one number of rooms for a set"
            )
    return _loaded[_key(request)], found.promises


def late(request: HouseRequest, index: int) -> str:
    """Return the message for a house that takes too many seconds."""
    return f"house {index} reached its limit of {request.seconds:g} seconds: raise it with --seconds"


def outcomes(
    request: HouseRequest, seed: int, indices: range, workers: int = 1
) -> Generator[House | LimitReached]:
    """Yield the houses of these indices in order, or ``LimitReached`` instead of a house at a limit.

    Raises the other errors of ``generate``. The indices are assigned to the processes in turn, so that
    answers arrive in the order of the questions.
    """
    warn = request.rules.hash not in _warned and not request.rules.is_shipped
    _warned.add(request.rules.hash)
    said = set[str]()

    def ask(worker: Solver, index: int) -> None:
        worker.ask(MakeHouse(request=request.at(index), seed=seed, index=index), request.seconds)

    with _team(request, min(workers, len(indices))) as team:
        for worker, index in zip(team, indices, strict=False):
            ask(worker, index)
        for turn, index in enumerate(indices):
            place = turn % len(team)
            made = _answered(team[place], request, index, warn)
            warn = False
            if isinstance(made, LimitReached):
                team[place].end()  # After a limit in Prolog, tables remain that no later house could use.
                yield made
            if turn + len(team) < len(indices):
                if not team[place].is_alive():
                    team[place] = Solver(_opening(request, remarks=False))
                    team[place].loaded()
                ask(team[place], indices[turn + len(team)])
            if isinstance(made, House):
                _say_what_gave_way(request, made, said)
                yield made


@contextmanager
def _team(request: HouseRequest, size: int) -> Iterator[list[Solver]]:
    """Lend this many processes that have loaded the rules of a request.

    Processes that are free afterwards become idle, unless an error leaves their state unknown.
    """
    key, team, usable = _key(request), list[Solver](), False
    try:
        for _ in range(size):
            opening = _opening(request, remarks=not team and key not in _loaded)
            team.append(_idle.take(key) or Solver(opening))
        for worker in team:
            if worker.unanswered:
                loaded = worker.loaded()
                assert isinstance(loaded, Loaded)
                _loaded[key] = loaded.versions
        yield team
        usable = True
    except (GeneratorExit, Unsatisfiable, RequestError):
        usable = True
        raise
    finally:
        for worker in team:
            if usable and worker.is_free:
                _idle.add(key, worker)
            else:
                worker.end()


def _opening(request: HouseRequest, remarks: bool) -> Open:
    """Return the question that loads the rules in a solver process."""
    return Open(grammar=str(request.rules.directory), cell=request.cell, remarks=remarks)


def _key(request: HouseRequest) -> Key:
    """Return what identifies the rules that a solver process has loaded."""
    return request.rules.hash, str(request.rules.directory), request.cell


def _answered(worker: Solver, request: HouseRequest, index: int, warn: bool) -> House | LimitReached:
    """Return the house that a process answers with, or its limit, and ``warn`` about its rules."""
    asked = request.at(index)
    try:
        answer = worker.answer(Made, request.seconds, late(request, index), asked)
        return House.from_dict(answer.house)
    except LimitReached as limit:
        return limit
    finally:
        if warn and worker.is_alive():
            _warn(worker, asked.rooms)


def _say_what_gave_way(request: HouseRequest, house: House, said: set[str]) -> None:
    """Warn once about each typical rule that gave way to the request."""
    assert house.provenance
    for rule in house.provenance.gave_way:
        if rule not in said:
            stated = "brief" if request.brief else "plan" if request.plan else "counts of types"
            text = f"{request.rules.name}: a typical rule gives way to the {stated}: {rule}"
            warnings.warn(text, GrammarWarning, stacklevel=3)
        said.add(rule)


def _warn(worker: Solver, rooms: int) -> None:
    """Warn about rules of a process that have no effect in houses of this many rooms.

    For other houses than the requested ones the rules may exceed a limit. In this case the process ends, and
    the function gives no warning.
    """
    worker.ask(Warn(rooms=rooms, processor=LOADING), START_UP)
    try:
        found = worker.answer(Judged, START_UP, "").findings
    except VitruviusError:
        return
    for finding in found:
        warnings.warn(str(finding), GrammarWarning, stacklevel=5)
