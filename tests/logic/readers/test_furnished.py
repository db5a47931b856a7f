"""A home that returns in another program's format, with walls and noise, has a house again."""

from pathlib import Path

import numpy as np
import pytest

from tests.logic.readers.fifty import outcome_of
from tests.logic.readers.written import WRITERS
from tests.logic.workers.in_process import generate
from vitruvius.logic import House

pytestmark = pytest.mark.usefixtures("solved_here")


@pytest.fixture(scope="module")
def homes() -> list[House]:
    return list(generate(4, grammar="home", seed=4, count=len(WRITERS)))


@pytest.mark.filterwarnings("ignore::logic.PlanWarning")
@pytest.mark.parametrize("number", range(len(WRITERS)), ids=list(WRITERS))
def test_a_home_in_another_format_is_furnished(number: int, homes: list[House], tmp_path: Path) -> None:
    write = list(WRITERS.values())[number]
    (tmp_path / "plan").write_bytes(write(homes[number], np.random.default_rng(number), 0.01))
    assert outcome_of(tmp_path / "plan")[0] in ("furnished", "moved")
