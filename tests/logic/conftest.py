"""Fixtures for the tests of the rules."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest


@pytest.fixture(scope="session")
def solver() -> Iterator[ProcessPoolExecutor]:
    """Yield one process for all wrong or hostile grammars, since loading the core takes a while."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        yield pool
