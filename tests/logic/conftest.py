"""Fixtures for the tests of the rules."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from tests.logic.workers import in_process
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.workers import nearest_plan, pool


@pytest.fixture(scope="session")
def solver() -> Iterator[ProcessPoolExecutor]:
    """Yield one process for all wrong or hostile grammars, since loading the core takes a while."""
    with ProcessPoolExecutor(1, get_context("spawn")) as process:
        yield process


@pytest.fixture
def solved_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let this process answer ``generate``, ``nearest``, ``nearest_plan`` and commands."""
    monkeypatch.setattr(pool, "outcomes", in_process.outcomes)
    monkeypatch.setattr(nearest_plan, "answers", in_process.moved)


@pytest.fixture
def home() -> Builder:
    """Return the builder of the shipped grammar ``home``."""
    return in_process.builder("home")
