"""What the tests of the rules share."""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest


@pytest.fixture(scope="session")
def solver() -> Iterator[ProcessPoolExecutor]:
    """One process for all grammars that are wrong or hostile: it takes a while to load the core."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        yield pool
