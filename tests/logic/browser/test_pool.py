"""Reuse of solver processes in a page's pool."""

import asyncio
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from vitruvius.logic.browser.watch import pool as pools
from vitruvius.logic.browser.watch.pool import Pool
from vitruvius.logic.browser.watch.server import Guard
from vitruvius.logic.browser.watch.session import Session
from vitruvius.logic.errors import GrammarError, Killed, LimitReached, OutOfInferences, RequestError
from vitruvius.logic.workers.solver import Solver

pytestmark = pytest.mark.second_part("pages are driven in a browser, and solvers are compared")


class Ready(Solver):
    """Process that has loaded its rules, and is slow to end."""

    def __init__(self) -> None:
        self._interrupted, self.unanswered = False, 0

    def prepared(self) -> None:
        """Return at once."""

    def open(self, opening: Any) -> None:
        """Return at once."""

    def loaded(self, seconds: float = 0.0) -> Any:
        """Return without a remark."""

    def is_alive(self) -> bool:
        """Return True."""
        return True

    def _kill(self) -> None:
        """Do nothing: ending takes longer than the next question."""

    def end(self) -> None:
        """Do nothing, since nothing runs."""


def test_a_process_that_answers_as_it_is_told_to_end_is_asked_no_more(monkeypatch):
    """Its answer came after the caller had gone and its time was over, so the process ends.

    A later caller that still asked it was told that there is no house.
    """
    monkeypatch.setattr(pools, "GRACE_S", 0.01)
    spares: Any = SimpleNamespace(take=Ready)

    async def again() -> tuple[Solver, list[Solver]]:
        pool, answered, first = Pool(Path(), spares), threading.Event(), list[Solver]()

        def slow(worker: Solver) -> None:
            first.append(worker)
            answered.wait(10)

        await pool.verdict()
        late = asyncio.ensure_future(pool.ask(slow))
        while not first:
            await asyncio.sleep(0.01)
        late.cancel()
        while not first[0]._interrupted:
            await asyncio.sleep(0.01)
        answered.set()
        await asyncio.sleep(0.1)
        asked = [await pool.ask(lambda worker: worker) for _ in range(3 * pools.PROCESSES)]
        return first[0], asked

    first, asked = asyncio.run(again())
    assert first not in asked


def test_limits_of_all_kinds_are_limits_on_the_page_and_nothing_else_is():
    session: Any = SimpleNamespace(_named=lambda said: said)
    errors = Killed(""), OutOfInferences(""), LimitReached(""), GrammarError(""), RequestError("")
    kinds = [Session._problem(session, error)["kind"] for error in errors]
    assert kinds == ["LimitReached"] * 3 + ["GrammarError", "RequestError"]


def test_a_request_without_a_path_is_refused() -> None:
    """Such as ``OPTIONS *`` of RFC 9110."""
    answers = list[Any]()

    async def nothing(*_: Any) -> Any:
        raise AssertionError("the guard lets it through")

    async def send(message: Any) -> None:
        answers.append(message)

    scope = {"type": "http", "method": "OPTIONS", "path": "*", "headers": [(b"host", b"127.0.0.1")]}
    asyncio.run(Guard(nothing, "token")(scope, nothing, send))
    assert answers[0]["status"] == 403
