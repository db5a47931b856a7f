"""Process that tries mutants: pytest collects the tests once, and the process then forks for each mutant.

The process runs in a copy of the checkout, reads a question from each line of standard input, and answers in
JSON. In the child, a changed Python function gets the code of the mutant. If code outside functions has
changed, the child imports all modules again. Rules need neither, because tests load the rule files.
"""

import contextlib
import gc
import json
import os
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from hashlib import sha256
from itertools import zip_longest
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import pytest

LATE, ENDED = "the tests do not end", "the process of the tests ends"
"""Outcomes that notice a mutant without a test that fails."""

OURS = ("vitruvius", "tests")


class MutantTrial:
    """Plugin of pytest that records failures, or in a measurement the seconds and functions of each test."""

    def __init__(self) -> None:
        """Begin without records."""
        self.failed = list[str]()
        self.seconds = defaultdict[str, float](float)
        self.entered = dict[str, list[tuple[str, int]]]()
        """Functions that each test enters, as file and first line."""

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Record a test file that cannot be imported."""
        if report.failed:
            self.failed.append(f"{report.nodeid}: cannot be imported")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Record the seconds of a test, and a failure."""
        self.seconds[report.nodeid] += report.duration
        if report.failed:
            self.failed.append(report.nodeid)

    def run(self, items: Sequence[pytest.Item], measure: float) -> None:
        """Run tests until one fails, or for ``measure`` seconds with a record of their functions."""
        end = time.monotonic() + measure
        for item, following in zip_longest(items, items[1:]):
            if measure and time.monotonic() > end:
                break
            seen, here = set[CodeType](), f"{os.getcwd()}{os.sep}"

            def enter(frame: FrameType, event: str, _: Any, seen: set[CodeType] = seen) -> None:
                if event == "call":
                    seen.add(frame.f_code)

            if measure:
                sys.setprofile(enter)
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
            sys.setprofile(None)
            places = {(code.co_filename, code.co_firstlineno) for code in seen}
            self.entered[item.nodeid] = [
                (file.removeprefix(here), line) for file, line in sorted(places) if file.startswith(here)
            ]
            if self.failed and not measure:
                break


class TrialServer:
    """Plugin of pytest that answers questions instead of running all tests."""

    def __init__(self, answers: Any) -> None:
        """Write answers to this file."""
        self.answers = answers

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave out the second part of the tests, which takes too long."""
        items[:] = [item for item in items if not item.get_closest_marker("second_part")]

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Answer all questions."""
        trial = MutantTrial()
        session.config.pluginmanager.register(trial)
        for line in sys.stdin:
            question = json.loads(line)
            print(json.dumps(answer(session, trial, question)), file=self.answers, flush=True)
        return True


class ChosenTests:
    """Plugin of pytest that runs chosen tests of a new session."""

    def __init__(self, trial: MutantTrial, order: Sequence[str]) -> None:
        """Run the tests in this order."""
        self.trial, self.order = trial, order

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Run the tests."""
        if not self.trial.failed:
            self.trial.run(chosen(session, self.order), measure=0)
        return True


def chosen(session: pytest.Session, order: Sequence[str]) -> list[pytest.Item]:
    """Return the tests with these names, in this order."""
    items = {item.nodeid: item for item in session.items}
    return [items[name] for name in order if name in items]


def answer(session: pytest.Session, trial: MutantTrial, question: dict[str, Any]) -> dict[str, Any]:
    """Return the answer of a child that runs the tests, or ``LATE`` after the seconds of the question."""
    read, write = os.pipe()
    child = os.fork()
    if not child:
        os.setpgid(0, 0)
        signal.alarm(int(question["seconds"]) + 60)
        os.close(read)
        log = os.open(question["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        for number, file in enumerate((os.open(os.devnull, os.O_RDONLY), log, log)):
            os.dup2(file, number)
        try:
            others = _try(session, trial, question)
            found = {
                "failed": trial.failed,
                "seconds": trial.seconds,
                "entered": trial.entered,
                "others": others,
            }
            with os.fdopen(write, "wb") as file:
                file.write(json.dumps(found).encode() + b"\n")
        finally:
            os._exit(0)
    os.close(write)
    with contextlib.suppress(OSError):
        os.setpgid(child, child)
    try:
        content = b"".join(_parts(read, time.monotonic() + question["seconds"]))
        return json.loads(content) if content else {"failed": [ENDED]}
    except TimeoutError:
        return {"failed": [LATE]}
    finally:
        os.close(read)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)
        os.waitpid(child, 0)


def _parts(read: int, end: float) -> Iterator[bytes]:
    """Yield parts of a pipe up to a line end: processes of the tests may keep the pipe open."""
    os.set_blocking(read, False)
    while time.monotonic() < end:
        try:
            part = os.read(read, 1 << 20)
            yield part
            if not part or part.endswith(b"\n"):
                return
        except BlockingIOError:
            time.sleep(0.02)
    raise TimeoutError


def _try(session: pytest.Session, trial: MutantTrial, question: dict[str, Any]) -> int:
    """Change the imported code in the child, run the tests, and return the number of tests not reached."""
    order = question["order"]
    if question["measure"]:
        items = [item for item in session.items if item.nodeid.startswith(tuple(order))]
        items.sort(key=lambda item: sha256(item.nodeid.encode()).digest())
        trial.run(items, question["measure"])
        # Sessions save compiled kernels at their end: trials use the kernels.
        session.config.hook.pytest_sessionfinish(session=session, exitstatus=0)
        return len(items) - len(trial.entered)
    if not (file := question["file"]) or (file.endswith(".py") and _patched(Path(file), question["line"])):
        trial.run(chosen(session, order), measure=0)
    else:
        for name in [name for name in sys.modules if name.partition(".")[0] in OURS]:
            del sys.modules[name]
        paths = sorted({name.partition("::")[0] for name in order})
        pytest.main([*OPTIONS, *paths], [trial, ChosenTests(trial, order)])
    return 0


def _patched(file: Path, first: int) -> bool:
    """Replace the code of the function at line ``first`` by that of the file.

    Return True if the function was found.
    """
    gc.unfreeze()
    path = str(file.resolve())
    code = next(
        (each for each in _codes(compile(file.read_bytes(), path, "exec")) if each.co_firstlineno == first),
        None,
    )
    found = [
        each
        for each in gc.get_objects()
        if isinstance(each, FunctionType)
        and each.__code__.co_filename.endswith(file.name)
        and os.path.realpath(each.__code__.co_filename) == path  # it is imported through a link
        and each.__code__.co_firstlineno == first
    ]
    for function in found:
        if code is None or function.__code__.co_freevars != code.co_freevars:
            return False
        function.__code__ = code
    return bool(found)


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Yield the code of all functions and methods of a module."""
    for each in code.co_consts:
        if isinstance(each, CodeType):
            yield each
            yield from _codes(each)


OPTIONS = ("-q", "-s", "-p", "no:cacheprovider")


def main() -> None:
    """Collect the tests that the arguments name, and answer the questions on standard input."""
    sys.dont_write_bytecode = True
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)
        pytest.main([*OPTIONS, *sys.argv[1:]], [TrialServer(answers)])
