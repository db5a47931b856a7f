"""A solver process, started by ``logic.workers.solver``: JSON lines in and out over pipes.

Rule files can loop, crash, eat memory or halt the process that runs them, so clingo and SWI-Prolog run here,
confined before a rule is read (``logic.workers.confinement``), and the parent owns deadlines and Ctrl-C. The first
line names the grammar, after one that says to ``prepare`` for it, if any; each further line asks for one
house, why one is as it is, what houses promise, or for warnings. Each is answered by: ``{"versions": ...}``,
``{"house": ...}``, ``{"why": ...}``, ``{"promises": ...}``, ``{"findings": ...}`` or
``{"error": ...}``; a count of layouts, and why in ``parts``, by several, of which the last is null. Lines
``{"trial": ...}`` before an answer say what is wrong if it does not come, ``{"working": ...}`` which stage
is at work on it. ``{"limit": ...}`` instead of an answer says what the process did when its time was over.
"""

import contextlib
import json
import os
import queue
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TextIO

import msgspec

from logic.errors import GrammarError, LimitReached, VitruviusError, to_record
from logic.workers import confinement

EARLY = 4.0
"""Seconds after which it is said which stage is at work, or a fourth of those that there are."""

GRACE = 1.0
"""Seconds of processor time beyond the limit of a request, in which the process says what it was doing."""

SHARED = 10
"""How much longer than a rule of the grammar's all shared rules may take in a trial."""

SEARCHED = 0.9
"""The share of the seconds for a question why in which it is searched for what could be instead."""


def main() -> None:
    """Answer requests until the parent closes its end of the pipe."""
    questions, answers = _private_pipes()
    confinement.limit()
    requests: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(questions, requests), daemon=True).start()
    worker = Worker()
    parent = Answers(answers)
    while True:
        request = json.loads(requests.get())
        with parent.within(worker.seconds(request), worker.account):
            for answer in _with_errors(worker.answers(request)):
                parent.write(answer)


class Answers:
    """The lines to the parent, the last of which says at a limit of seconds what the process is doing."""

    def __init__(self, pipe: TextIO) -> None:
        """Write to this pipe."""
        self._pipe, self._lock, self._asked = pipe, threading.Lock(), 0

    def write(self, answer: dict[str, Any]) -> None:
        """A line."""
        with self._lock:
            self._line(answer)

    def _line(self, answer: dict[str, Any]) -> None:
        self._pipe.write(json.dumps(answer) + "\n")
        self._pipe.flush()

    @contextlib.contextmanager
    def within(self, seconds: float | None, account: Callable[[], Any]) -> Iterator[None]:
        """Answer in these seconds, if any, or end the process: the solvers cannot be interrupted, but leave
        Python's other threads to run.
        """
        timers = []
        if seconds is not None:
            early = min(seconds / 4, EARLY)
            timers = [
                threading.Timer(early, self._say, [self._asked, lambda: {"working": account().stage}]),
                threading.Timer(seconds, self._end, [self._asked, account]),
            ]
        for timer in timers:
            timer.daemon = True
            timer.start()
        yield
        with self._lock:
            self._asked += 1
        for timer in timers:
            timer.cancel()

    def _say(self, asked: int, line: Callable[[], dict[str, Any]]) -> None:
        with self._lock:
            if asked == self._asked:
                self._line(line())

    def _end(self, asked: int, account: Callable[[], Any]) -> None:
        with self._lock:
            if asked == self._asked:
                self._line({"limit": str(account())})
                os._exit(0)


class Worker:
    """The rules that a process has loaded, and what it answers."""

    def __init__(self) -> None:
        """Begin with none."""
        self._builder: Any = None

    def account(self) -> Any:
        """What is done: see ``account.py``."""
        return self._builder.account

    def seconds(self, request: dict[str, Any]) -> float | None:
        """How long a request may take: to load has limits of its own."""
        return None if self._builder is None else request["seconds"]

    def answers(self, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """The lines that answer a request."""
        if "prepare" in request:
            _prepare(request["prepare"])
            yield {"prepared": True}
            return
        if self._builder is None:
            yield from self._loaded(request)
            return
        from logic.request.request import Request

        self._builder.account.begin()
        confinement.allow_seconds(request.get("processor", request["seconds"]) + GRACE)
        if "why" in request:
            yield from self._why(request)
            return
        if "promises" in request:
            found = self._builder.promises(Request(request["promises"]))
            yield {"promises": msgspec.to_builtins(found)}
        elif "lint" in request or "warn" in request:
            from logic.language.linter import all_warnings, warnings

            rules = self._builder.grammar, self._builder.loaded
            found = all_warnings(*rules) if "lint" in request else warnings(*rules, request["warn"])
            yield {"findings": msgspec.to_builtins(found)}
        else:
            yield from self._made(Request.read(request["request"]), request)

    def _made(self, wanted: Any, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """A house of a request, or counts of its layouts."""
        if "count" in request:
            self._builder.require_known(wanted)
            for count in self._builder.programs.counts(wanted, request["count"]):
                yield {"count": count}
            yield {"count": None}
            return
        house = self._builder.house(wanted, request["seed"], request["index"], request["inferences"])
        yield {"house": house.to_dict()}

    def _why(self, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """Why a house is as it is, in ``parts`` as they are found or whole."""
        from logic.house.house import House
        from logic.why.shared_walls import PlanWitness
        from logic.why.star import StarWitness

        until = time.monotonic() + SEARCHED * request["seconds"]
        kind = PlanWitness if self._builder.grammar.shares_walls else StarWitness
        witness = kind(self._builder, House.from_dict(request["house"]), request["inferences"])
        if "parts" not in request:
            yield {"why": msgspec.to_builtins(witness.why(request["why"], until))}
            return
        for part in witness.parts(request["why"], until):
            yield {"why": msgspec.to_builtins(part)}
        yield {"why": None}

    def _loaded(self, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
        """Load a grammar, or find what is wrong with it, confined; after a trial of its steps if asked to."""
        _prepare(request["grammar"])
        from logic.generation.builder import Builder
        from logic.grammar import find
        from logic.language.linter import errors
        from logic.language.loaded import LoadedGrammar

        grammar = find(request["grammar"])
        confinement.confine([grammar.directory, *_installed()])
        if "trial" in request:
            confinement.require_seconds()
            from logic.language.trial import steps

            last = time.process_time()
            for error in steps(grammar, request["trial"]):
                # A step may begin by what those before it did: that is no fault of its own.
                taken, last = time.process_time() - last, time.process_time()
                confinement.allow_seconds(request["step"] * (1 if error.line else SHARED) + 2 * taken)
                yield {"trial": to_record(error)}
            yield {"trial": None}
        confinement.allow_seconds(request["seconds"])
        loaded = LoadedGrammar(grammar, request["cell"], remarks=not request.get("hasty"))
        if "errors" in request and (wrong := errors(grammar, loaded)):
            yield {"findings": msgspec.to_builtins(wrong)}
            return
        self._builder = Builder(grammar, request["cell"], loaded)
        kinds = {"types": loaded.furniture, "most_rooms": loaded.most_rooms}
        yield {"versions": self._builder.versions, "kinds": kinds}


def _prepare(directory: str) -> None:
    """Import the solvers and load the core, as a grammar needs it, but no rule of the grammar's.

    Here, not above: that a solver is missing is an answer too.
    """
    confinement.require_files()
    from logic.grammar import RULES, find
    from logic.language.vocabulary import core_words
    from logic.layout import differences
    from logic.layout.program import CORE
    from logic.placement import prolog

    prolog.load(RULES / "core.pl")
    with contextlib.suppress(GrammarError):  # What is wrong with the grammar is said where it is loaded.
        topology = find(directory).topology
        core_words(topology)
        if differences.DIFFERENCES in topology:
            differences.core_statements((CORE, *topology))


def _installed() -> Iterator[Path]:
    """Where this package, Python, SWI-Prolog and their libraries are."""
    from pyswip.core import SWI_HOME_DIR

    folders = [*sys.path, sys.prefix, sys.base_prefix, SWI_HOME_DIR, "/lib", "/lib64", "/usr"]
    return (Path(folder) for folder in (Path(__file__).parents[1], *folders) if folder)


def _with_errors(answers: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """The answers, the last of which says what ended them, if anything did."""
    try:
        yield from answers
    except VitruviusError as error:
        yield {"error": to_record(error)}
    except (MemoryError, RecursionError):
        most = f"{confinement.MEMORY >> 30} GiB of memory"
        yield {"error": to_record(LimitReached(f"the solvers need more than {most}, or nest too deeply"))}
    except Exception:
        yield {"error": to_record(VitruviusError(traceback.format_exc()))}


def _private_pipes() -> tuple[TextIO, TextIO]:
    """The pipes from and to the parent; the rules read nothing, and what they print goes to stderr."""
    questions, answers = os.fdopen(os.dup(0), encoding="utf-8"), os.fdopen(os.dup(1), "w", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return questions, answers


def _listen(parent: TextIO, requests: "queue.SimpleQueue[str]") -> None:
    """Pass on the parent's lines, and end with it: the solvers do not notice by themselves.

    The process leads a group (``logic.workers.solver``), which ends with it: while it looks for SWI-Prolog, a program
    runs in it that would write to a closed pipe, and complain where the user reads.
    """
    for line in parent:
        requests.put(line)
    with contextlib.suppress(OSError):  # Once confined, it may signal no process, and has started none.
        os.killpg(0, signal.SIGKILL)
    os._exit(0)
