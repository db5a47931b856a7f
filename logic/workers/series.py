"""Series of houses: solver processes generate the houses, and their answers come in order."""

import warnings
from collections.abc import Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from msgspec import structs

from vitruvius.logic.errors import GrammarWarning, LimitReached, RequestError, Unsatisfiable, VitruviusError
from vitruvius.logic.grammar import SHIPPED, Grammar
from vitruvius.logic.house.house import House
from vitruvius.logic.house.promises import Promises
from vitruvius.logic.request.request import request_at
from vitruvius.logic.workers.idle import Idle
from vitruvius.logic.workers.messages import Judged, Loaded, Made, MakeHouse, Open, Promise, Promised, Warn
from vitruvius.logic.workers.solver import LOADING, START_UP, Solver

_idle = Idle()

_loaded: dict[tuple[str, Open], dict[str, str]] = {}
"""Versions of the solvers, by the rules (and their hash) that a solver process of this process has loaded.

For these rules clingo had no remarks.
"""

_warned: set[str] = set()
"""Hashes of the rules whose warnings this process has given, so that each is given once."""


@dataclass(frozen=True)
class HouseSeries:
    """Grammar, request and limits of houses, which a seed and an index complete."""

    grammar: Grammar
    request: dict[str, Any]
    """Request in the form of ``Request.to_dict``.

    In this form ``rooms`` may also be a range, as a list: see ``request_at``.
    """
    inferences: int
    """Largest number of Prolog inferences for a house."""
    seconds: float
    """Largest number of seconds for a house."""

    def houses(self, seed: int, indices: range, workers: int = 1) -> Iterator[House]:
        """Yield the houses of these indices in order. Raises as ``generate`` does."""
        with closing(self.outcomes(seed, indices, workers)) as outcomes:
            for made in outcomes:
                if isinstance(made, LimitReached):
                    raise made
                yield made

    def described(self) -> tuple[dict[str, str], Promises]:
        """Return the versions of the programs that generate the houses, and the promises of the houses.

        Raises as ``generate`` does, and ``RequestError`` if houses with different numbers of rooms promise
        different things.
        """
        opening, key = self._opening()
        worker = _idle.take(key) or Solver(opening)
        try:
            self._load(worker, key)
            late = f"what the houses of {self.grammar.name} promise took {self.seconds:g} seconds"
            least, most = (rooms, rooms) if isinstance(rooms := self.request["rooms"], int) else rooms
            found, *others = (
                worker.asked(Promise(request=request_at(index, self.request)), Promised, self.seconds, late)
                for index in range(most - least + 1)
            )
            if any(each != found for each in others):
                raise RequestError(
                    f"rooms: houses of {self.grammar.name} of {least} to {most} rooms promise different "
                    "things: take one number of rooms for a set"
                )
        except BaseException:
            worker.end()
            raise
        _idle.add(key, worker)
        return _loaded[key], found.promises

    def _opening(self) -> tuple[Open, tuple[str, Open]]:
        """Return the question that loads the rules in a solver process, and a key for these rules."""
        opening = Open(grammar=str(self.grammar.directory), cell=float(self.request.get("cell", 0.0)))
        return opening, (self.grammar.hash, opening)

    def _load(self, worker: Solver, key: tuple[str, Open]) -> None:
        """Wait until a solver process has loaded the rules."""
        if worker.unanswered:
            loaded = worker.loaded()
            assert isinstance(loaded, Loaded)
            _loaded[key] = loaded.versions

    def _question(self, seed: int, index: int) -> MakeHouse:
        request = request_at(index, self.request)
        return MakeHouse(request=request, seed=seed, index=index, inferences=self.inferences)

    def late(self, index: int) -> str:
        """Return the message for a house that takes too many seconds."""
        return f"house {index} reached its limit of {self.seconds:g} seconds: raise it with --seconds"

    def outcomes(self, seed: int, indices: range, workers: int = 1) -> Generator[House | LimitReached]:
        """Yield the houses of these indices in order, or ``LimitReached`` instead of a house at a limit.

        Raises the other errors of ``generate``. The indices are assigned to the processes in turn, so that
        answers arrive in the order of the questions.
        """
        opening, key = self._opening()
        warn = self.grammar.hash not in _warned and self.grammar.directory.parent != SHIPPED
        _warned.add(self.grammar.hash)
        number = min(workers, len(indices))
        team: list[Solver] = []
        said = set[str]()
        reusable = False
        try:
            for _ in range(number):
                remarks = not team and key not in _loaded
                team.append(_idle.take(key) or Solver(structs.replace(opening, remarks=remarks)))
            for worker in team:
                self._load(worker, key)
            opening = structs.replace(opening, remarks=False)
            for turn, worker in enumerate(team):
                worker.ask(self._question(seed, indices[turn]), self.seconds)
            for turn, index in enumerate(indices):
                place = turn % len(team)
                worker = team[place]
                made: House | LimitReached
                request = request_at(index, self.request)
                try:
                    answer = worker.answer(Made, self.seconds, self.late(index), [request["rooms"]], request)
                    made = House.from_dict(answer.house)
                except LimitReached as limit:
                    made = limit
                finally:
                    if warn and worker.is_alive():
                        _warn(worker, request["rooms"])
                    warn = False
                if isinstance(made, LimitReached):
                    yield made
                    # After a time limit in Prolog, tables remain that no later house could use.
                    worker.end()
                if turn + len(team) < len(indices):
                    if not worker.is_alive():
                        team[place] = worker = Solver(opening)
                        worker.loaded()
                    worker.ask(self._question(seed, indices[turn + len(team)]), self.seconds)
                if isinstance(made, House):
                    self._say_what_gave_way(made, said)
                    reusable = True
                    yield made
                    reusable = False
            reusable = True
        except (Unsatisfiable, RequestError):
            reusable = True
            raise
        finally:
            for worker in team:
                if reusable and not worker.unanswered:
                    _idle.add(key, worker)
                else:
                    worker.end()

    def _say_what_gave_way(self, house: House, said: set[str]) -> None:
        """Warn once about each typical rule that gave way to the request."""
        assert house.provenance
        for rule in house.provenance.gave_way:
            if rule not in said:
                stated = next(
                    (each for each in ("brief", "plan") if self.request.get(each)), "counts of types"
                )
                text = f"{self.grammar.name}: a typical rule gives way to the {stated}: {rule}"
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
        warnings.warn(str(finding), GrammarWarning, stacklevel=4)
