"""The page of the generator's study states its measurements, and hides no plan that was not done in time."""

from pathlib import Path

import pytest

from benchmarks.generator.page import generator_page
from benchmarks.generator.run import Generator
from tests.benchmarks.reports import report
from vitruvius.logic import GrammarError, RequestError

pytestmark = pytest.mark.second_part("each study is run in small")


def test_fewer_than_half_late_leave_the_median_but_not_the_95th_percentile() -> None:
    page = generator_page(report(), "./run bench generator")
    assert "| 6 | 1,000 | > 20,000 | 800 | 2 of 20 |" in page
    assert "| 7 | > 20,000 | > 20,000 |  | 20 of 20 |" in page


def test_the_page_names_machine_versions_grammar_and_what_is_measured() -> None:
    page = generator_page(report(), "./run bench generator --grammar mine")
    for words in (
        "--grammar mine",
        "x86_64",
        "Python 3.12",
        "clingo 5.8",
        "1.50 s",
        "| 1 | 8 | 50 |",
        "| 2 | 8 | 100 |",
    ):
        assert words in page
    assert "| 32 | 64.0 | 64.0 | 100.0 | 64.0 | 200.0 | 3.12 | 50,000 | 50,000 |" in page


def test_a_part_of_the_study_makes_a_page_of_its_sections_alone() -> None:
    whole = report()
    houses = [entry for entry in whole["benchmarks"] if entry["name"].startswith("test_house")]
    page = generator_page(whole | {"benchmarks": houses}, "./run bench generator --part house")
    assert "| 32 |  |  | 100.0 | 64.0 | 200.0 | 3.12 |  | 50,000 |" in page
    assert [line for line in page.splitlines() if line.startswith("## ")] == [
        "## A furnished house",
        "## Fitted laws",
        "## Your own grammar",
    ]


def test_a_part_of_the_study_is_not_published(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="leave out --part"):
        Generator(part=("house",), publish=True, out=tmp_path).run()


def test_a_misspelt_grammar_is_refused_before_anything_is_measured(tmp_path: Path) -> None:
    with pytest.raises(GrammarError, match="did you mean family"):
        Generator(grammar="famly", out=tmp_path / "out").run()
    assert not (tmp_path / "out").exists()
