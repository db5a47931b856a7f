"""A series of houses: solver processes at work on it, and their answers in order."""

import warnings
from collections.abc import Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from msgspec import structs

from logic.errors import GrammarWarning, LimitReached, RequestError, Unsatisfiable, VitruviusError
from logic.grammar import SHIPPED, Grammar
from logic.house.house import House
from logic.house.promises import Promises
from logic.request.request import request_at
from logic.workers.idle import Idle
from logic.workers.messages import Judged, Loaded, Made, MakeHouse, Open, Promise, Promised, Warn
from logic.workers.solver import LOADING, START_UP, Solver

_idle = Idle()

_loaded: dict[tuple[str, Open], dict[str, str]] = {}
"""The solvers' versions, by the rules (and their hash) that a solver process of this one has loaded: clingo
has nothing to remark on in them.
"""

_warned: set[str] = set()
"""Hashes of the rules whose warnings this process has given: once is enough."""


@dataclass(frozen=True)
class HouseSeries:
    """What a house is a function of, but for its seed and its index; and how long it may take."""

    grammar: Grammar
    request: dict[str, Any]
    """As ``Request.to_dict`` has it, but that ``rooms`` may be a range, as a list: see ``request_at``."""
    inferences: int
    """Most Prolog inferences for a house."""
    seconds: float
    """Most seconds for a house."""

    def houses(self, seed: int, indices: range, workers: int = 1) -> Iterator[House]:
        """The houses of these indices, in order; raises as ``generate`` does."""
        with closing(self.outcomes(seed, indices, workers)) as outcomes:
            for made in outcomes:
                if isinstance(made, LimitReached):
                    raise made
                yield made

    def described(self) -> tuple[dict[str, str], Promises]:
        """The versions of what makes its houses, and what they promise.

        Raises as ``generate`` does, and ``RequestError`` if houses of a range promise different things.
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
        """What a solver process loads, and the name of that."""
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
        """What is said of a house that takes too many seconds."""
        return f"house {index} reached its limit of {self.seconds:g} seconds: raise it with --seconds"

    def outcomes(self, seed: int, indices: range, workers: int = 1) -> Generator[House | LimitReached]:
        """The houses of these indices, in order, or in the place of one the limit that it ended in; raises
        what else ``generate`` raises.

        The indices are assigned in turn, so that answers come back in the order in which they are asked for.
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
                    # Where it has cut Prolog short, tables are left that no later house could use.
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
        """Warn once of each typical rule that gave way to the request."""
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
    """Warn of what is of no use in the rules that a process has loaded, where these rooms are asked for.

    The rules may take too much for other houses than these: then the process has ended, and nothing is said.
    """
    worker.ask(Warn(rooms=rooms, processor=LOADING), START_UP)
    try:
        found = worker.answer(Judged, START_UP, "").findings
    except VitruviusError:
        return
    for finding in found:
        warnings.warn(str(finding), GrammarWarning, stacklevel=4)
