"""Houses by request: solver processes at work, their answers in order, their ends in hand."""

import atexit
import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from logic.errors import (
    Finding,
    GrammarError,
    GrammarWarning,
    LimitReached,
    RequestError,
    Unsatisfiable,
    VitruviusError,
    from_record,
)
from logic.fixed import fixed_rooms
from logic.grammar import SHIPPED, find
from logic.house import BODY, House
from logic.request import MOST_ROOMS, Count, Request
from logic.spelling import keywords

START_UP = 60.0
"""Seconds that a solver process may take to load a grammar."""

MOST_IDLE = 2
"""Solver processes kept for the next request for the same rules: to start one takes half a second."""

ENVIRONMENT = {"LC_ALL": "C.UTF-8", "PYTHONUTF8": "1"}
"""Rule files are UTF-8 whatever the user's language."""

START = """
import sys
from importlib.util import module_from_spec, spec_from_file_location

sys.path += sys.argv[2:]
spec = spec_from_file_location("logic", sys.argv[1])
sys.modules["logic"] = module_from_spec(spec)
spec.loader.exec_module(sys.modules["logic"])
from logic.worker import main

main()
"""
"""What a solver process runs. It imports this very package by its file, all else first from PYTHONPATH and
where packages are installed: no file in the current folder or beside a script takes the place of a module.
"""


@keywords(pieces="furniture", n="count", number="count", rules="grammar", timeout="seconds")
def generate(
    rooms: int,
    *,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    cell: float = 0.0,
    keep: House | None = None,
    grammar: str | Path = "family",
    seed: int = 0,
    count: int = 1,
    start: int = 0,
    workers: int = 1,
    inferences: int = 100_000_000,
    seconds: float = 60.0,
) -> Iterator[House]:
    """Generate houses ``start`` to ``start + count - 1`` of a request, one by one, in order.

    ``rooms`` is the number of secondary rooms (1 to 128). ``types`` counts the rooms of some types, exactly
    or from a least to a greatest number, None for no bound: ``{"bedroom": 2, "bathroom": (1, None)}``.
    ``furniture`` counts in the same way the pieces in each room that may have them, or in rooms of one type:
    ``{"bed": 1, "bedroom.wardrobe": (1, 2)}``. With a ``cell`` (metres, at least the body's 0.287) every edge
    of a house lies on a grid of such cells: fixed lengths and least ones are rounded up, greatest ones down.
    The rooms of ``keep`` (as in ``house.only("R0", "R2")``) are fixed, with their doors and furniture, and
    count among the ``rooms``; all else, the main room too, is generated around them.
    ``grammar`` is a shipped grammar's name or a directory. House ``i`` is a function of the grammar, the
    request, the seed and ``i``: the number of ``workers``, each a process, changes nothing but the time.
    ``inferences`` (of Prolog) and ``seconds`` bound each house.

    Warns once (``GrammarWarning``) of each rule of a grammar in a directory that never has an effect.
    Raises ``RequestError`` for a request that makes no sense, ``GrammarError`` for a wrong grammar,
    ``Unsatisfiable`` where it is proved that there is no such house, ``LimitReached`` past a bound.
    """
    for counts, least in (
        ({"rooms": rooms, "count": count, "workers": workers, "inferences": inferences}, 1),
        ({"seed": seed, "start": start}, 0),
    ):
        for name, value in counts.items():
            if type(value) is not int or not least <= value < 2**31:
                raise RequestError(f"{name} must be a whole number, {least} or more, not {value!r}")
    if rooms > MOST_ROOMS:
        raise RequestError(f"rooms must be at most {MOST_ROOMS}, not {rooms}")
    if not 0 < seconds < 1e6:
        raise RequestError(f"seconds must be above 0 and below a million, not {seconds!r}")
    if cell and not BODY <= cell <= 2:
        raise RequestError(f"cell must be {BODY} m (the body's width) to 2 m, not {cell!r}")
    wanted = Request.read({"rooms": rooms, "types": types or {}, "furniture": furniture or {}, "cell": cell})
    if keep is not None:
        if cell:
            raise RequestError("keep: fixed rooms need not lie on the grid: leave out cell or keep")
        fixed = len(keep.rooms)
        if not fixed:
            raise RequestError('keep: the house has no room to keep: name some, as in keep=house.only("R0")')
        if fixed > rooms:
            raise RequestError(
                f"keep: the house has {fixed} rooms to keep, but rooms={rooms}: ask for rooms={fixed} or "
                'more, or keep some of them: keep=house.only("R0"), on the command line --keep-rooms R0'
            )
        wanted = replace(wanted, fixed=tuple(fixed_rooms(keep)))
    question = {"request": wanted.to_dict(), "seed": seed, "inferences": inferences}
    rules = find(grammar)
    opening = {"grammar": str(rules.directory), "cell": float(cell)}
    return _houses(opening, rules.hash, question, range(start, start + count), workers, seconds)


@keywords(pieces="furniture", rules="grammar", timeout="seconds")
def count_layouts(
    rooms: int,
    *,
    types: Mapping[str, Count] | None = None,
    furniture: Mapping[str, Count] | None = None,
    grammar: str | Path = "family",
    seconds: float = 60.0,
    report: Callable[[str, int], None] = lambda name, number: None,
) -> Iterator[tuple[str, int, bool]]:
    """Count the layouts from which stage 1 samples: of a house's rooms, and of each type's furniture.

    Each is a name, a number, and whether that is exact: it is False where ``seconds`` ran out and there are
    more. Room layouts say types, sides, corners; furniture layouts all that ``rules/room.lp`` shows.
    ``report`` is called once a second with a name and the number so far. Raises as ``generate`` does.
    """
    wanted = Request.read({"rooms": rooms, "types": types or {}, "furniture": furniture or {}})
    return _layouts({"grammar": str(find(grammar).directory), "cell": 0.0}, wanted, seconds, report)


def _layouts(
    opening: dict[str, Any], wanted: Request, seconds: float, report: Callable[[str, int], None]
) -> Iterator[tuple[str, int, bool]]:
    """The counts, one by one."""
    worker = _Worker(opening)
    try:
        worker.loaded()
        worker.ask({"count": seconds, "request": wanted.to_dict()})
        while count := worker.answer(START_UP + 100 * seconds, "late")["count"]:
            name, number, whole = count
            if whole is None:
                report(name, number)
            else:
                yield name, number, whole
    finally:
        worker.end()


def answered(opening: dict[str, Any], question: dict[str, Any], seconds: float, late: str) -> dict[str, Any]:
    """The answer of a solver process to one question; past the seconds ``LimitReached`` says ``late``."""
    worker = _Worker(opening)
    try:
        worker.loaded()
        worker.ask(question)
        return worker.answer(seconds, late)
    finally:
        worker.end()


def lint(grammar: str | Path = "family", seconds: float = 60.0) -> list[Finding]:
    """Find the mistakes in a grammar's files that clingo and SWI-Prolog pass over, without running its code.

    ``generate`` refuses a grammar with an error. Raises ``GrammarError`` where there is no such grammar, and
    ``LimitReached`` past these seconds.
    """
    opening = {"grammar": str(find(grammar).directory), "lint": True}
    worker = _Worker(opening)
    try:
        record = worker.answer(
            seconds, f"{opening['grammar']}: reading took {seconds:g} s: do its rules recur?"
        )
    finally:
        worker.end()
    return msgspec.convert(record["findings"], list[Finding])


def _houses(
    opening: dict[str, Any],
    rules: str,
    request: dict[str, Any],
    indices: range,
    workers: int,
    seconds: float,
) -> Iterator[House]:
    """Assign the indices in turn, so that answers come back in the order in which they are asked for."""
    key = (rules, *opening.values())
    warn = rules not in _warned and Path(opening["grammar"]).parent != SHIPPED
    _warned.add(rules)
    number = min(workers, len(indices))
    team: list[_Worker] = []
    reusable = False
    try:
        for turn in range(number):
            team.append(_idle.take(key) or _Worker(opening | {"warn": warn and not turn}))
        for worker in team:
            if worker.unanswered:
                for text in worker.loaded()["warnings"]:
                    warnings.warn(text, GrammarWarning, stacklevel=2)
        for turn, worker in enumerate(team):
            worker.ask(request | {"index": indices[turn]})
        for turn, index in enumerate(indices):
            worker = team[turn % len(team)]
            record = worker.answer(
                seconds, f"house {index} reached its limit of {seconds:g} seconds: raise it with --seconds"
            )
            if turn + len(team) < len(indices):
                worker.ask(request | {"index": indices[turn + len(team)]})
            reusable = True
            yield House.from_dict(record["house"])
            reusable = False
        reusable = True
    except Unsatisfiable:
        reusable = True
        raise
    finally:
        for worker in team:
            if reusable and not worker.unanswered:
                _idle.add(key, worker)
            else:
                worker.end()


class _Idle:
    """Solver processes that have answered everything, by what they have loaded; safe among threads."""

    def __init__(self) -> None:
        self.forget()
        atexit.register(self.end)
        # A forked child has copies of the pipes, but the processes answer its parent.
        os.register_at_fork(after_in_child=self.forget)

    def forget(self) -> None:
        """Begin with none."""
        self._lock, self._workers = threading.Lock(), []

    def take(self, key: tuple[Any, ...]) -> "_Worker | None":
        """One that has loaded just these rules and still runs, if there is one."""
        with self._lock:
            places = [place for place, (loaded, _) in enumerate(self._workers) if loaded == key]
            worker = self._workers.pop(places[-1])[1] if places else None
        if worker is None or worker.is_alive():
            return worker
        worker.end()
        return self.take(key)

    def add(self, key: tuple[Any, ...], worker: "_Worker") -> None:
        """Keep one, and end those beyond ``MOST_IDLE`` that were used the longest time ago."""
        with self._lock:
            self._workers.append((key, worker))
            late = [self._workers.pop(0)[1] for _ in range(len(self._workers) - MOST_IDLE)]
        for unused in late:
            unused.end()

    def end(self) -> None:
        """End all."""
        while self._workers:
            self._workers.pop()[1].end()


_idle = _Idle()

_warned: set[str] = set()
"""Hashes of the rules whose warnings this process has given: once is enough."""


def _named(path: Iterable[str]) -> list[str]:
    """Where modules are looked for, but for the current folder."""
    return [folder for folder in path if folder and os.path.abspath(folder) != os.getcwd()]


class _Worker:
    """A solver process and the two ends of its pipes."""

    def __init__(self, opening: dict[str, Any]) -> None:
        self._grammar = opening["grammar"]
        package, path = Path(__file__).with_name("__init__.py"), os.environ.get("PYTHONPATH", "")
        # In a new session: Ctrl-C goes to the parent alone, which then ends the worker.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", START, str(package), *_named(sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
            env=os.environ | ENVIRONMENT | {"PYTHONPATH": os.pathsep.join(_named(path.split(os.pathsep)))},
        )
        assert self._process.stdin
        assert self._process.stdout
        self._questions, self._output = self._process.stdin, self._process.stdout.fileno()
        self._answers = selectors.DefaultSelector()
        os.set_blocking(self._output, False)
        self._answers.register(self._output, selectors.EVENT_READ)
        self._received = b""
        self.unanswered = 0
        self.ask(opening)

    def ask(self, question: dict[str, Any]) -> None:
        """Send a request; that the process is gone shows in its answer."""
        self.unanswered += 1
        try:
            self._questions.write(json.dumps(question).encode() + b"\n")
            self._questions.flush()
        except BrokenPipeError:
            pass

    def loaded(self) -> dict[str, Any]:
        """Wait until the grammar is loaded: its versions and warnings."""
        return self.answer(
            START_UP, f"{self._grammar}: loading took {START_UP:g} s: do its rules recur without end?"
        )

    def answer(self, seconds: float, late: str) -> dict[str, Any]:
        """Wait for the answer to the oldest open request; past the seconds ``LimitReached`` says ``late``."""
        deadline = time.monotonic() + seconds
        while b"\n" not in self._received:
            if not self._answers.select(max(0.0, deadline - time.monotonic())):
                raise LimitReached(late)
            part = os.read(self._output, 1 << 20)
            if not part:
                raise self._died()
            self._received += part
        line, self._received = self._received.split(b"\n", 1)
        self.unanswered -= 1
        record = json.loads(line)
        if "error" in record:
            raise from_record(record["error"])
        return record

    def is_alive(self) -> bool:
        """Whether the process still runs."""
        return self._process.poll() is None

    def _died(self) -> VitruviusError:
        code = self._process.wait()
        if code == -signal.SIGKILL:
            return LimitReached("a solver process was killed from outside, perhaps for want of memory")
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        why = "look for a directive that halts, or a clause that recurs without end"
        return GrammarError(f"the rules ended the solver process ({how}): {why}", self._grammar)

    def end(self) -> None:
        """Kill the process: it holds nothing that anyone needs."""
        # With all that directives may have started.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()
        self._answers.close()
