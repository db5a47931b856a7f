"""Readers of the inputs: one process for many of them, which records Python's audit events."""

import importlib
import os
import resource
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures import TimeoutError as Late
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from tests.hostile.case import ACCEPTED, LIMITED, REFUSED
from vitruvius.logic.errors import LimitReached, VitruviusError

SECONDS = 60.0
"""Wall time for an answer, in seconds: it takes a tenth of a second, but the machine may be busy."""

MEMORY = 4 << 30
"""Address space in bytes, the same as for a solver process."""

EVENTS = {
    *("os.exec", "os.fork", "os.forkpty", "os.posix_spawn", "os.system", "subprocess.Popen", "pty.spawn"),
    *("socket.connect", "socket.bind", "socket.getaddrinfo", "socket.sendto"),
    *("pickle.find_class", "webbrowser.open", "urllib.Request"),
    *("os.remove", "os.rename", "os.rmdir", "os.chmod", "os.chown", "os.link", "os.symlink", "os.truncate"),
}
"""Python's audit events that no reading of a file causes."""

noted: list[str] = []
"""Events of the input that is being read."""


@dataclass(frozen=True)
class Answer:
    """Answer of a reader, with its text and the recorded events; any fourth kind of answer is a fault."""

    answer: str
    text: str
    events: list[str] = field(default_factory=list)


def answer_of(error: BaseException) -> Answer:
    """Return the answer that an error stands for."""
    if isinstance(error, LimitReached):
        return Answer(LIMITED, str(error))
    if isinstance(error, VitruviusError) and error.exit_code != VitruviusError.exit_code:
        return Answer(REFUSED, str(error))
    return Answer(type(error).__name__, str(error))


class Reader:
    """Process that reads one input after another. After an input that ends it, a new process follows."""

    def __init__(self, *modules: str, memory: int = MEMORY) -> None:
        """Start no process yet. It will import these modules first, which may start programs."""
        self._modules, self._memory, self._pool = modules, memory, None

    def ready(self) -> int:
        """Return the number of a process that waits for an input."""
        if self._pool is None:
            self._pool = ProcessPoolExecutor(1, get_context("spawn"), _begin, (self._modules, self._memory))
        return self._pool.submit(os.getpid).result(60)

    def answer(self, read: Callable[..., Answer], *arguments: Path) -> Answer:
        """Return the answer of a function of this or another module."""
        assert self._pool
        try:
            return self._pool.submit(_answered, read, arguments).result(SECONDS)
        except (BrokenProcessPool, Late) as error:
            self.end()
            return Answer(type(error).__name__, f"the process ended, or had no answer in {SECONDS:g} s")

    def is_alive(self) -> bool:
        """Return True if the last input did not end the process."""
        return self._pool is not None

    def end(self) -> None:
        """End the process."""
        if self._pool:
            for process in self._pool._processes.values():
                process.kill()
            self._pool.shutdown()
        self._pool = None


def _begin(modules: tuple[str, ...], memory: int) -> None:
    sys.dont_write_bytecode = True  # a module that an input is the first to need is no effect of the input
    for module in modules:
        importlib.import_module(module)
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    sys.addaudithook(
        lambda event, values: noted.append(f"{event}{values!r:.200}") if event in EVENTS else None
    )


def _answered(read: Callable[..., Answer], arguments: tuple[Path, ...]) -> Answer:
    noted.clear()
    try:
        found = read(*arguments)
    except BaseException as error:
        found = answer_of(error)
    return Answer(found.answer, found.text, noted[:9])


def rules(folder: Path) -> Answer:
    """Return the answer of ``generate`` and ``lint`` for a grammar, in this process: an error or a house."""
    from vitruvius.logic.generation.builder import Builder
    from vitruvius.logic.grammar import find
    from vitruvius.logic.language.loaded import LoadedGrammar
    from vitruvius.logic.proofs.answer import house_or_proof
    from vitruvius.logic.request.house_request import HouseRequest

    grammar = find(folder)
    builder = Builder(grammar, 0.0, LoadedGrammar(grammar))
    house = house_or_proof(builder, HouseRequest(1, inferences=3_000_000), seed=0, index=0)
    return Answer(ACCEPTED, f"a house of {len(house.rooms)} rooms")


def bomb(folder: Path) -> Answer:
    """Return the answer of ``generate``, by a solver process, to a grammar that may take long.

    The process has a quarter of the usual seconds, which is three times what ``family`` needs.
    """
    from vitruvius.logic import generate
    from vitruvius.logic.workers import pool, solver

    solver.LOADING = pool.LOADING = 1.0
    solver.STEP = 0.5
    try:
        house = next(generate(rooms=1, grammar=folder, seconds=1.0))
    finally:
        noted.clear()  # the solver process itself
    return Answer(ACCEPTED, f"a house of {len(house.rooms)} rooms")


def command(*words: Any) -> Answer:
    """Return what a command of ``vitruvius`` prints, and its exit code as an answer."""
    import io
    from contextlib import redirect_stderr, redirect_stdout

    from vitruvius.cli import main

    said, code = io.StringIO(), -1
    with redirect_stdout(said), redirect_stderr(said):
        try:
            main([str(word) for word in words])
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else -1
    answer = {0: ACCEPTED, 1: ACCEPTED, 2: REFUSED, 4: LIMITED, 5: REFUSED}.get(code, f"exit code {code}")
    return Answer(answer, said.getvalue())
