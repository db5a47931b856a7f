"""A solver process, started by ``logic.workers.solver``, with JSON lines in and out over pipes.

Rule files can loop, crash, exhaust memory or halt their process. Therefore clingo and SWI-Prolog run here,
confined before a rule is read (``confinement``), and the parent owns deadlines and Ctrl-C. ``messages.py``
defines the messages. The first line names the grammar, after an optional line to prepare for it.
"""

import contextlib
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

from vitruvius.logic.errors import GrammarError, LimitReached, MissingProgram, VitruviusError, to_record
from vitruvius.logic.workers import confinement
from vitruvius.logic.workers.messages import (
    Asked,
    Counted,
    CountLayouts,
    Done,
    Ease,
    Eased,
    Explain,
    Explained,
    Failed,
    Judged,
    Late,
    Lint,
    Loaded,
    Made,
    MakeHouse,
    Moved,
    MovePlan,
    Open,
    Prepare,
    Prepared,
    Promise,
    Promised,
    Said,
    Trying,
    Warn,
    Working,
)

FIRST_REPORT_S = 4.0
"""Seconds after which the process reports its stage, or a fourth of its limit if that is less.

It reports again at half of the limit.
"""

GRACE = 1.0
"""Seconds of processor time after the limit of a request, in which the process says what it was doing."""

SHARED = 10
"""Time for all shared rules in a trial, as a multiple of the time for one rule of the grammar."""

SEARCHED = 0.9
"""Fraction of a question's seconds for the search for alternatives."""


def main() -> None:
    """Answer questions until the parent closes its end of the pipe."""
    questions, answers = _private_pipes()
    _compile_core()
    confinement.limit()
    requests: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(questions, requests), daemon=True).start()
    worker = Worker()
    parent = Answers(answers)
    while True:
        question = msgspec.json.decode(requests.get(), type=Asked)
        with parent.within(worker.seconds(question), worker.account):
            for answer in _with_errors(worker.answers(question)):
                parent.write(answer)


class Answers:
    """Lines to the parent. At a limit of seconds the last line says what the process is doing."""

    def __init__(self, pipe: TextIO) -> None:
        """Set the pipe to the parent."""
        self._pipe, self._lock, self._asked = pipe, threading.Lock(), 0

    def write(self, answer: Said) -> None:
        """Write a line."""
        with self._lock:
            self._line(answer)

    def _line(self, answer: Said) -> None:
        self._pipe.write(msgspec.json.encode(answer).decode() + "\n")
        self._pipe.flush()

    @contextlib.contextmanager
    def within(self, seconds: float | None, account: Callable[[], Any]) -> Iterator[None]:
        """Answer within these seconds, if given, or end the process.

        The solvers cannot be interrupted, but they let Python's other threads run.
        """
        timers = []
        if seconds is not None:
            work = [self._asked, lambda: Working(account().stage)]
            timers = [
                threading.Timer(after, self._say, work)
                for after in (min(seconds / 4, FIRST_REPORT_S), seconds / 2)
            ]
            timers.append(threading.Timer(seconds, self._end, [self._asked, account]))
        for timer in timers:
            timer.daemon = True
            timer.start()
        yield
        with self._lock:
            self._asked += 1
        for timer in timers:
            timer.cancel()

    def _say(self, asked: int, line: Callable[[], Said]) -> None:
        with self._lock:
            if asked == self._asked:
                self._line(line())

    def _end(self, asked: int, account: Callable[[], Any]) -> None:
        with self._lock:
            if asked == self._asked:
                self._line(Late(str(account())))
                os._exit(0)


class Worker:
    """The rules that a process has loaded, and the answers to questions about them."""

    def __init__(self) -> None:
        """Begin without rules."""
        self._builder: Any = None

    def account(self) -> Any:
        """Return the account of the current work: see ``account.py``."""
        return self._builder.at_work.account

    def seconds(self, question: Asked) -> float | None:
        """Return the limit of a question in seconds, or None for loading, which has limits of its own."""
        return None if self._builder is None else question.seconds

    def answers(self, question: Asked) -> Iterator[Said]:
        """Yield the lines that answer a question."""
        match question:
            case Prepare():
                _prepare(question.grammar)
                yield Prepared()
                return
            case Open():
                yield from self._loaded(question)
                return
        self._builder.begin()
        processor = question.processor if isinstance(question, Warn) else question.seconds
        confinement.allow_seconds(processor + GRACE)
        yield from self._answers(question)

    def _answers(self, question: Asked) -> Iterator[Said]:
        """Yield the answers of loaded rules."""
        from vitruvius.logic.language.linter import all_warnings, warnings
        from vitruvius.logic.proofs.answer import house_or_proof
        from vitruvius.logic.proofs.easing import easing
        from vitruvius.logic.proofs.giving_way import without
        from vitruvius.logic.proofs.moved_plan import moved_plan

        builder = self._builder
        match question:
            case MakeHouse():
                made = house_or_proof(builder, question.request, question.seed, question.index)
                yield Made(made.to_dict())
            case MovePlan():
                yield Moved(moved_plan(builder, question.request, question.seed))
                yield Done()
            case CountLayouts():
                builder.require_known(question.request)
                for name, number, exact in builder.programs.counts(question.request, question.share):
                    yield Counted(name, number, exact)
                yield Done()
            case Explain():
                yield from self._explained(question)
                yield Done()
            case Ease():
                for how in easing(builder, question.request):
                    yield Eased(how)
                yield Done()
            case Promise():
                wanted = question.request
                yield Promised(without(builder, wanted, ()).promises(wanted))
            case Lint():
                yield Judged(all_warnings(builder.grammar, builder.loaded))
            case Warn():
                yield Judged(warnings(builder.grammar, builder.loaded, question.rooms))

    def _explained(self, question: Explain) -> Iterator[Explained]:
        """Yield the explanation of a house part by part as it is found."""
        from vitruvius.logic.house.house import House
        from vitruvius.logic.proofs.giving_way import without
        from vitruvius.logic.request.house_request import HouseRequest
        from vitruvius.logic.why.witnesses import witness_of

        house = House.from_dict(question.house)
        made = house.provenance
        assert made
        builder = without(self._builder, HouseRequest.read(made.request), made.gave_way)
        witness = witness_of(builder, house)
        until = time.monotonic() + SEARCHED * question.searching
        for part in witness.parts(question.target, until):
            yield Explained(part)

    def _loaded(self, question: Open) -> Iterator[Said]:
        """Load a grammar while confined, or find its mistakes, after a trial of its steps if asked for."""
        _prepare(question.grammar)
        from vitruvius.logic.generation.builder import Builder
        from vitruvius.logic.grammar import find
        from vitruvius.logic.language.linter import errors
        from vitruvius.logic.language.loaded import LoadedGrammar

        grammar = find(question.grammar)
        confinement.confine([grammar.directory, *_installed()])
        if question.trial is not None:
            confinement.require_seconds()
            from vitruvius.logic.language.trial import steps

            last = time.process_time()
            for error in steps(grammar, question.trial):
                # A step may first pay for the work of earlier steps, which is no fault of its own.
                taken, last = time.process_time() - last, time.process_time()
                confinement.allow_seconds(question.step * (1 if error.line else SHARED) + 2 * taken)
                yield Trying(to_record(error))
            yield Trying(None)
        confinement.allow_seconds(question.seconds)
        remarks = question.remarks and (question.errors or not grammar.is_shipped)
        loaded = LoadedGrammar(grammar, question.cell, remarks)
        if question.errors and (wrong := errors(grammar, loaded)):
            yield Judged(wrong)
            return
        self._builder = Builder(grammar, question.cell, loaded)
        yield Loaded(self._builder.versions, loaded.furniture, loaded.most_rooms)


def _compile_core() -> None:
    """Compile the core of SWI-Prolog if need be, before this process gives up its rights and reads rules."""
    with contextlib.suppress(MissingProgram, LimitReached, OSError):  # ``_prepare`` reports what is missing.
        confinement.require_files()
        from vitruvius.logic.placement.compiled import provide

        provide()


def _prepare(directory: str) -> None:
    """Import the solvers and load the core that a grammar needs, but no rule of the grammar.

    The imports are here, not at the top, because a missing solver is an answer, too.
    """
    confinement.require_files()
    from vitruvius.logic.grammar import find
    from vitruvius.logic.language.asp.vocabulary import core_words
    from vitruvius.logic.layout import differences
    from vitruvius.logic.layout.program import CORE
    from vitruvius.logic.placement import prolog
    from vitruvius.logic.placement.compiled import load_core

    prolog.require()
    load_core()
    with contextlib.suppress(GrammarError):  # ``_loaded`` reports mistakes of the grammar.
        topology = find(directory).topology
        core_words(topology)
        if differences.DIFFERENCES in topology:
            differences.core_statements((CORE, *topology))


def _installed() -> Iterator[Path]:
    """Return the folders of this package, of Python, of SWI-Prolog and of their libraries."""
    from pyswip.core import SWI_HOME_DIR

    folders = [*sys.path, sys.prefix, sys.base_prefix, SWI_HOME_DIR, "/lib", "/lib64", "/usr"]
    return (Path(folder) for folder in (Path(__file__).parents[1], *folders) if folder)


def _with_errors(answers: Iterator[Said]) -> Iterator[Said]:
    """Yield the answers. If an error ends them, yield it as the last one."""
    try:
        yield from answers
    except VitruviusError as error:
        yield Failed(to_record(error))
    except (MemoryError, RecursionError):
        most = f"{confinement.MEMORY >> 30} GiB of memory"
        yield Failed(to_record(LimitReached(f"the solvers need more than {most}, or nest too deeply")))
    except Exception:
        yield Failed(to_record(VitruviusError(traceback.format_exc())))


def _private_pipes() -> tuple[TextIO, TextIO]:
    """Return the pipes from and to the parent. The rules read nothing, and their output goes to stderr."""
    questions, answers = os.fdopen(os.dup(0), encoding="utf-8"), os.fdopen(os.dup(1), "w", encoding="utf-8")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    return questions, answers


def _listen(parent: TextIO, requests: "queue.SimpleQueue[str]") -> None:
    """Pass on the parent's lines, and end with the parent, which the solvers do not notice by themselves.

    The process leads a process group (``solver``), which ends with it. While the process looks for
    SWI-Prolog, it runs a program that would write to a closed pipe and print an error for the user.
    """
    for line in parent:
        requests.put(line)
    with contextlib.suppress(OSError):  # A confined process may signal no process, and has started none.
        os.killpg(0, signal.SIGKILL)
    os._exit(0)
