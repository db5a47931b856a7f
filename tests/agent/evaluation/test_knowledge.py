"""The signals that the first page lists for agents are those of their configs."""

from pathlib import Path

import pytest

from vitruvius.agent.algorithms.table import PRESETS
from vitruvius.agent.baselines.table import BASELINES, DRIVING_BASELINES, KNOWS, PRIVILEGED
from vitruvius.agent.evaluation.knowledge import WORDS, known
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.released import located, released
from vitruvius.sim.config import EXTRAS, RAYS

DOCS = Path(__file__).parents[3] / "docs"
ROWS = {
    first: knows
    for page in ("results.md", "free.md")
    for first, knows, *_ in (
        [cell.strip() for cell in line.split("|")[1:]]
        for line in (DOCS / page).read_text().splitlines()
        if line[:1] == "|"
    )
}
"""Rows of the pages' tables, by the first cell."""


def knows(words: str) -> str:
    """Return the cell of the row whose first cell contains these words."""
    (found,) = (said for first, said in ROWS.items() if words in first)
    return found


@pytest.mark.parametrize("name", ["paper-original", *(name for name in PRESETS if name in released())])
def test_the_column_of_what_agents_know_is_what_their_configs_say(name: str) -> None:
    rows = [found for first, found in ROWS.items() if f"`{name}`" in first]
    assert rows
    assert set(rows) == {known(checkpoint.load(located(name)).config)}


def test_the_column_of_what_baselines_know_is_what_they_say() -> None:
    assert knows("random + avoidance") == known("random + avoidance")
    assert knows("script:") == known("script")
    assert knows("`explorer`") == known("explorer")
    assert knows("random drive") == known("random drive")
    assert knows("pursuit, by rule") == known("pursuit")


def test_the_column_of_what_the_agent_that_drives_knows_is_what_its_preset_says() -> None:
    assert knows("`pqn-free`") == known(PRESETS["pqn-free"])


def test_every_agent_and_baseline_says_what_it_knows_in_the_words_of_the_observation_space() -> None:
    words = {RAYS, "heading", *EXTRAS}
    assert set(WORDS) == words
    assert set(KNOWS) == {*BASELINES, *DRIVING_BASELINES} - {*PRIVILEGED}
    configs = [*PRESETS.values(), *(checkpoint.load(located(name)).config for name in released())]
    for knows in (*KNOWS.values(), *(config.knows for config in configs)):
        assert set(knows) <= words
