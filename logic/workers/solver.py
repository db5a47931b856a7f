"""Solver processes seen from outside: this module starts, asks and ends them.

``worker.py`` runs in these processes.
"""

import contextlib
import errno
import os
import selectors
import signal
import subprocess
import sys
import time
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path
from typing import TypeVar

import msgspec
from msgspec.structs import replace

from vitruvius.logic.errors import (
    GrammarError,
    Killed,
    LimitReached,
    MissingProgram,
    VitruviusError,
    from_record,
)
from vitruvius.logic.layout.account import GROUNDING, LAYOUT, MAX_LISTED, PROOF
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.workers.messages import (
    Asked,
    Done,
    Ease,
    Eased,
    Failed,
    Judged,
    Late,
    Loaded,
    Open,
    Prepare,
    Prepared,
    Said,
    Trying,
    Working,
)

Kind = TypeVar("Kind")

Tried = HouseRequest | tuple[int, ...]
"""Houses by which a process that takes long is examined: those of a request, or of some numbers of rooms."""

START_UP = 60.0
"""Seconds in which a solver process must load a grammar."""

LOADING = 4.0
"""Processor time to load a grammar, in seconds; most take 1 to 2.

Past it the rules are tried step by step.
"""

STEP = 1.0
"""Processor time for one step of a trial, in seconds: see ``logic.language.trial``.

Most take some hundredths.
"""

GRACE = 1.0
"""Seconds after a limit in which a process may report what it was doing."""

SCARCE = {errno.EMFILE, errno.ENFILE, errno.EAGAIN, errno.ENOMEM}
"""Errors of starting a process: too many open files or processes, or too little memory."""

ENVIRONMENT = {"LC_ALL": "C.UTF-8", "PYTHONUTF8": "1"}
"""Settings that make rule files UTF-8 in every language of the user."""

WSL = "on Windows install Vitruvius in WSL 2 (wsl --install)"
"""Advice for a system without the pipes and process groups of POSIX."""

START = """
import sys
from importlib.util import module_from_spec, spec_from_file_location

sys.path += sys.argv[2:]
spec = spec_from_file_location("vitruvius", sys.argv[1])
sys.modules["vitruvius"] = module_from_spec(spec)
spec.loader.exec_module(sys.modules["vitruvius"])
from vitruvius.logic.workers.worker import main

main()
"""
"""Program of a solver process.

It imports this very package by its file, and all other modules first from PYTHONPATH and the folders of
installed packages. Therefore no file in the current folder or beside a script replaces a module.
"""


class Solver:
    """A solver process and the two ends of its pipes."""

    def __init__(self, opening: Prepare | Open) -> None:
        """Start the process, which loads the grammar of ``opening`` or gets ready and waits for ``open``."""
        self._interrupted = False
        self._start()
        if isinstance(opening, Prepare):
            self.ask(opening, LOADING)
        else:
            self.open(opening)

    def open(self, opening: Open) -> None:
        """Let the process load the grammar of ``opening``. Each process loads one grammar, once."""
        self._opening, self._grammar = opening, opening.grammar
        self.ask(opening, LOADING if opening.trial is None else START_UP)

    def _start(self) -> None:
        self._step: VitruviusError | None = None
        self._helper: Solver | None = None
        self._easing = False
        if not hasattr(os, "killpg"):
            raise MissingProgram(f"rules are solved on Linux and macOS: {WSL}")
        package, path = Path(__file__).parents[2] / "__init__.py", os.environ.get("PYTHONPATH", "")
        try:
            # In a new session: Ctrl-C goes only to the parent, which then ends the worker.
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", START, str(package), *_named(sys.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                start_new_session=True,
                env=os.environ
                | ENVIRONMENT
                | {"PYTHONPATH": os.pathsep.join(_named(path.split(os.pathsep)))},
            )
        except OSError as error:
            if error.filename is not None or error.errno not in SCARCE:
                raise
            raise LimitReached(
                f"a solver process cannot be started: {error.strerror}: raise the limit of this machine or "
                "shell (ulimit -n for open files, -u for processes), or take fewer --workers"
            ) from None
        assert self._process.stdin
        assert self._process.stdout
        self._questions, self._output = self._process.stdin, self._process.stdout.fileno()
        self._answers = selectors.DefaultSelector()
        os.set_blocking(self._output, False)
        self._answers.register(self._output, selectors.EVENT_READ)
        self._received = b""
        self.unanswered = 0
        if self._interrupted:
            self._kill()

    def ask(self, question: Asked, seconds: float) -> None:
        """Send a question with a limit in seconds. If the process has ended, ``answer`` reports that."""
        self.unanswered += 1
        try:
            self._questions.write(msgspec.json.encode(replace(question, seconds=seconds)) + b"\n")
            self._questions.flush()
        except BrokenPipeError:
            pass

    def prepared(self) -> None:
        """Wait until the process is ready to load a grammar.

        Raises ``MissingProgram`` if a solver is missing.
        """
        late = f"a solver process took {START_UP:g} s to start: is the machine overloaded?"
        self.answer(Prepared, START_UP, late)

    def loaded(self, seconds: float = START_UP) -> Loaded | Judged:
        """Wait for the answer to the opening: the grammar's versions and warnings, or the findings of lint.

        If the grammar ends the process or exceeds a limit, another process tries the grammar step by step to
        find the step at fault (see ``logic.language.trial``). Raises ``LimitReached`` after ``seconds``.
        """
        late = f"{self._grammar}: loading took {seconds:g} s: do its rules recur without end?"
        end = time.monotonic() + seconds
        try:
            return self.answer((Loaded, Judged), seconds, late)
        except VitruviusError as error:
            ended = isinstance(error, LimitReached) or not self.is_alive()
            if not ended or self._interrupted or self._opening.trial is not None:
                raise
        self.end()
        self._start()
        self.open(replace(self._opening, trial=(), step=STEP))
        return self.answer((Loaded, Judged), max(0.0, end - time.monotonic()), late)

    def _help(self, stage: str, tried: Tried, seconds: float) -> None:
        """Start another process to find out why this process takes long at a stage.

        At grounding it looks for a rule that grounds too slowly in houses that are ``tried``. At the search
        for layouts it looks for the part of the request that makes layouts hard to find.
        """
        with contextlib.suppress(LimitReached):
            request = tried if isinstance(tried, HouseRequest) else None
            rooms = (request.rooms,) if request else tried
            if stage == GROUNDING and rooms and self._helper is None:
                self._helper = Solver(replace(self._opening, trial=rooms, step=STEP))
            elif stage in (LAYOUT, PROOF) and request and not self._easing:
                self._end_helper()
                self._helper, self._easing = Solver(replace(self._opening, remarks=False)), True
                self._helper.ask(Ease(request=request), seconds)

    def _end_helper(self) -> None:
        if self._helper is not None:
            self._helper.end()
            self._helper, self._easing = None, False

    def _found(self) -> tuple[GrammarError | None, list[str]]:
        """Return the findings of the other process so far: a rule at fault, and ways to find layouts soon."""
        ways: list[str] = []
        if self._helper is None:
            return None, ways
        try:
            self._helper.arrived((Loaded, Judged))
            while len(ways) < MAX_LISTED:
                ways.append(self._helper.arrived(Eased).how)
                self._helper.unanswered += 1
        except VitruviusError as error:
            return (error if isinstance(error, GrammarError) else None), ways
        finally:
            self._end_helper()
        return None, ways

    def answer(
        self,
        kinds: type[Kind] | tuple[type[Kind], ...],
        seconds: float,
        late: str,
        tried: Tried = (),
    ) -> Kind:
        """Wait for the answer, of these kinds, to the oldest open question.

        Raises ``LimitReached`` after ``seconds``. Its message is ``late``, followed by the work of the
        process at that time and by the findings of another process (``_help``) about the houses ``tried``.
        """
        return self._answer(kinds, time.monotonic() + seconds + GRACE, late, tried)

    def arrived(self, kinds: type[Kind] | tuple[type[Kind], ...]) -> Kind:
        """Return an answer without waiting for it. Raises ``LimitReached`` if there is none yet."""
        return self._answer(kinds, time.monotonic(), "")

    def _answer(
        self, kinds: type[Kind] | tuple[type[Kind], ...], deadline: float, late: str, tried: Tried = ()
    ) -> Kind:
        """Return the answer to the oldest open question, until a deadline of ``time.monotonic``."""
        while True:
            while b"\n" not in self._received:
                if not self._answers.select(max(0.0, deadline - time.monotonic())):
                    raise LimitReached(late)
                part = os.read(self._output, 1 << 20)
                if not part:
                    raise self._step or self._died(late)
                self._received += part
            line, self._received = self._received.split(b"\n", 1)
            match msgspec.json.decode(line, type=Said):
                case Trying(error):
                    self._step = from_record(error) if error else None
                case Working(stage):
                    self._help(stage, tried, max(0.0, deadline - time.monotonic()))
                case Late(account):
                    at_fault, ways = self._found()
                    if at_fault:
                        raise LimitReached(f"{late}: {at_fault}")
                    eased = "\n  ".join(["\nA layout is soon found", *ways]) if ways else ""
                    raise LimitReached(f"{late}. {account}{eased}")
                case said:
                    break
        self.unanswered -= 1
        self._end_helper()
        if isinstance(said, Failed):
            error = from_record(said.error)
            raise (self._step if isinstance(error, LimitReached) else None) or error
        if not isinstance(said, kinds):
            raise VitruviusError(f"a solver process answered {type(said).__name__}, not {kinds}")
        return said

    def asked(self, question: Asked, kind: type[Kind], seconds: float, late: str) -> Kind:
        """Ask a question and return the answer."""
        self.ask(question, seconds)
        return self.answer(kind, seconds, late)

    def series(
        self,
        question: Asked,
        kind: type[Kind],
        seconds: float,
        late: str,
        before: float = 0.0,
        tried: Tried = (),
    ) -> Iterator[Kind]:
        """Ask a question with several answers, and yield the answers as they come, all within ``seconds``.

        With ``before`` the seconds count from the first answer. Until then the process has ``before`` seconds
        to generate a house again. For ``tried`` see ``answer``.
        """
        says = f"the house was not regenerated within {before:g} seconds" if before else late
        end = time.monotonic() + (before or seconds)
        self.ask(question, before + seconds)
        while not isinstance(
            found := self.answer((kind, Done), max(0.0, end - time.monotonic()), says, tried), Done
        ):
            self.unanswered += 1  # More answers follow.
            if says != late:
                says, end = late, time.monotonic() + seconds
            yield found

    def is_alive(self) -> bool:
        """Return True if the process still runs."""
        return self._process.poll() is None

    @property
    def is_free(self) -> bool:
        """True if the process runs, has answered all questions, and was not told to end."""
        return self.is_alive() and not self.unanswered and not self._interrupted

    def _died(self, late: str) -> VitruviusError:
        code = self._process.wait()
        if code == -signal.SIGXCPU:
            return LimitReached(late)
        if code == -signal.SIGKILL:
            why = "perhaps for lack of memory, or by ulimit -t"
            return Killed(f"another process killed a solver process, {why}")
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        why = "look for a directive that halts, or an endless recursion"
        return GrammarError(f"the rules ended the solver process ({how}): {why}", self._grammar)

    def interrupt(self) -> None:
        """Kill the process while another thread waits for its answer.

        That thread gets an error and ends it.
        """
        self._interrupted = True
        self._kill()

    def end(self) -> None:
        """Kill the process, once. It holds nothing that is still needed."""
        if self._questions.closed:  # its number may belong to another process by now
            return
        self._end_helper()
        self._kill()
        self._process.communicate()
        self._answers.close()

    def _kill(self) -> None:
        # With all processes that directives may have started.
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)


def _named(path: Iterable[str]) -> list[str]:
    """Return the folders of modules, without the current folder."""
    return [folder for folder in path if folder and os.path.abspath(folder) != os.getcwd()]


def answers(
    opening: Open,
    question: Asked,
    kind: type[Kind],
    seconds: float,
    late: str,
    before: float = 0.0,
    tried: Tried = (),
) -> Generator[Kind]:
    """Yield all answers of a new solver process to one question, as they come: see ``Solver.series``.

    Raises ``LimitReached`` after ``seconds``.
    """
    worker = Solver(opening)
    try:
        worker.loaded()
        yield from worker.series(question, kind, seconds, late, before, tried)
    finally:
        worker.end()
