"""The page of the paper follows from its data."""

import json

import pytest

from benchmarks.common.pages import DOCS
from benchmarks.paper.page import PARTS, UNMEASURED, paper_page
from benchmarks.paper.run import published

pytestmark = pytest.mark.second_part("each study is run in small")


def test_the_published_page_is_what_the_published_data_say() -> None:
    assert (DOCS / "paper.md").read_text() == paper_page(published()), "run: ./run bench paper"


def test_a_part_that_is_not_measured_is_said_to_be_so() -> None:
    assert paper_page({}).count(UNMEASURED) >= len(PARTS)


def test_the_table_of_the_tasks_has_the_mean_of_each_policy() -> None:
    data = json.loads((DOCS / "paper-agents.json").read_text())
    for policies in data.values():
        policies["oracle"]["targets"] = [3, 4, 5, 4]
    assert "| oracle | 4.00 ± 0.41 | 4.00 ± 0.41 | 4.00 ± 0.41 | 0% |" in paper_page({"agents": data})
