"""Solver processes that have loaded one version of a grammar, for questions from asyncio."""

import asyncio
import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from msgspec.structs import replace

from vitruvius.logic.errors import RequestError, VitruviusError
from vitruvius.logic.workers.messages import Judged, Loaded, Open, Prepare
from vitruvius.logic.workers.solver import Solver

Kind = TypeVar("Kind")

PROCESSES = min(4, os.cpu_count() or 1)
"""Number of processes that generate the houses of a sheet in parallel."""

GRACE_S = 0.8
"""Seconds in which a process may finish an answer that nobody waits for any more.

Most answers take less, and the process is then free for the next question. After these seconds the process is
killed, and another one has to load the rules.
"""

REFILL_S = 3.0
"""Seconds after which new spare processes replace those in use.

Starting a process takes processor time that a sheet needs, so the start waits until the sheet is drawn.
"""


class Stale(Exception):
    """The rules have changed since the question was asked."""


class Spares:
    """Processes that are ready to load a grammar, since starting a process takes longer than loading."""

    def __init__(self, directory: Path) -> None:
        """Start the processes for a grammar's directory."""
        self._opening = Prepare(grammar=str(directory))
        self._ready: list[Solver] = []
        self._ended = False
        self.refill()

    def check(self) -> None:
        """Raise ``MissingProgram`` if the solvers are not installed."""
        worker = self.take()
        try:
            worker.prepared()
        finally:
            worker.end()
        self.refill()

    def take(self) -> Solver:
        """Return a spare process, or start one if there is none."""
        while self._ready:
            worker = self._ready.pop(0)
            if worker.is_alive():
                break
            worker.end()
        else:
            worker = Solver(self._opening)
        with contextlib.suppress(RuntimeError):  # No loop runs before the server does.
            asyncio.get_running_loop().call_later(REFILL_S, self.refill)
        return worker

    def refill(self) -> None:
        """Replace the processes that were taken, unless ``end`` was called.

        The server may still call this method then, since connections close after the processes end.
        """
        if self._ended:
            return
        self._ready += [Solver(self._opening) for _ in range(PROCESSES - len(self._ready))]

    def end(self) -> None:
        """End all processes, and start no more."""
        self._ended = True
        for worker in self._ready:
            worker.end()
        self._ready.clear()


class Pool:
    """Processes that load the same rules; the first free process gets a question.

    One of the processes looks for mistakes in the rules. The others do not, and so have the first houses by
    the time the rules are known to be right.
    """

    def __init__(self, directory: Path, spares: Spares) -> None:
        """Let the processes load the grammar in its current state."""
        self._opening = Open(grammar=str(directory), errors=True)
        self._spares, self._ended = spares, False
        self._busy: set[Solver] = set()
        self._left = PROCESSES
        # Or an error to raise at every question.
        self._free: asyncio.Queue[Solver | VitruviusError | Stale] = asyncio.Queue()
        self._verdict, *others = (
            asyncio.ensure_future(self._open(remarks=not each)) for each in range(PROCESSES)
        )
        for each in (self._verdict, *others):
            each.add_done_callback(_heard)

    async def verdict(self) -> Loaded | Judged:
        """Return the findings about the rules. Raises the errors of the rules, and ``Stale``."""
        await asyncio.wait([self._verdict])
        if self._ended:
            raise Stale
        return self._verdict.result()

    async def ask(self, asked: Callable[[Solver], Kind]) -> Kind:
        """Return the answer of the first free process. Raises the errors of ``asked``, and ``Stale``.

        A cancelled caller leaves at once. The process that worked for it is soon free again.
        """
        worker = await self._free.get()
        if not isinstance(worker, Solver):
            self._free.put_nowait(worker)
            raise worker

        self._busy.add(worker)
        answer = asyncio.ensure_future(asyncio.to_thread(asked, worker))
        answer.add_done_callback(_heard)
        answer.add_done_callback(lambda _: self._release(worker))
        try:
            return await asyncio.shield(answer)
        except asyncio.CancelledError:
            asyncio.get_running_loop().call_later(GRACE_S, self._hurry, worker, answer)
            raise
        except VitruviusError:
            if self._ended:
                raise Stale from None
            raise

    def end(self) -> None:
        """End all processes. Waiting callers get an error."""
        self._ended = True
        for worker in self._busy:
            worker.interrupt()
        while not self._free.empty():
            worker = self._free.get_nowait()
            if isinstance(worker, Solver):
                worker.end()
        self._free.put_nowait(Stale())

    async def _open(self, remarks: bool = False) -> Loaded | Judged:
        """Add a process, and return its findings about the rules. Raises ``Stale`` after the end."""
        if self._ended:
            raise Stale
        worker = self._spares.take()

        def loaded() -> Loaded | Judged:
            worker.prepared()
            worker.open(replace(self._opening, remarks=remarks))
            return worker.loaded()

        self._busy.add(worker)
        try:
            answer = await asyncio.to_thread(loaded)
        except VitruviusError as error:
            self._lose(worker, error)
            raise
        if isinstance(answer, Judged):
            self._lose(worker, RequestError("the rules have a mistake"))
        else:
            self._release(worker)
        return answer

    def _lose(self, worker: Solver, why: VitruviusError) -> None:
        """Remove a process. If none is left, every question raises this error."""
        self._busy.discard(worker)
        worker.end()
        self._left -= 1
        if not self._left:
            self._free.put_nowait(why)

    def _release(self, worker: Solver) -> None:
        """Mark a process as free, or replace it if it is no longer usable."""
        self._busy.discard(worker)
        if self._ended:
            worker.end()
        elif worker.is_free:
            self._free.put_nowait(worker)
        else:
            worker.end()
            asyncio.ensure_future(self._open()).add_done_callback(_heard)

    def _hurry(self, worker: Solver, answer: asyncio.Future[Any]) -> None:
        if not answer.done():
            worker.interrupt()


def _heard(future: asyncio.Future[Any]) -> None:
    """Raise unexpected errors of a future, and drop those that no caller waits for any more."""
    error = None if future.cancelled() else future.exception()
    if error and not isinstance(error, VitruviusError | Stale):
        raise error
