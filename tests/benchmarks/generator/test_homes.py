"""The study of homes states its measurements, and the published figures for comparison."""

from pathlib import Path

import pytest

from benchmarks.generator.homes import Homes, type_rows
from benchmarks.generator.published import PASSAGES, beside_published, glazed, whole
from vitruvius.logic import Door, House, Room, Window

pytestmark = pytest.mark.second_part("each study is run in small")

FLAT = House(
    (Room(0, 0, 4, 4, "R0", "bedroom"), Room(4, 0, 1, 4, "R1", "corridor"), Room(5, 0, 5, 4, "R2", "living")),
    (
        Door(4, 1, 0, 0.8, ("R1", "R0")),
        Door(5, 1, 0, 0.8, ("R1", "R2")),
        Door(4.1, 0, 0.8, 0, ("R1", "outside")),
    ),
    (Window(1, 0, 2, 0, "R0"),),
)


def test_areas_doors_and_windows_are_those_of_the_houses() -> None:
    rows = {row[0]: row[1:] for row in type_rows([FLAT, FLAT])}
    assert list(rows) == ["living", "bedroom", "corridor"]
    assert rows["corridor"] == ["1.00", "4.0 [4.0, 4.0]", "4.0 to 4.0", "3.00"]
    assert whole(FLAT, PASSAGES) / whole(FLAT) == pytest.approx(0.1)
    assert list(glazed([FLAT])) == [2 / 16]
    shares = [row[1] for row in beside_published([FLAT, FLAT], 1.4) if "% of the area" in row[0]]
    assert shares == ["10 [10, 10]"]


def test_the_page_has_a_row_for_each_size_and_a_picture(tmp_path: Path) -> None:
    Homes(rooms=(4, 5), houses=2, larger=0, out=tmp_path).run()
    page = (tmp_path / "homes.md").read_text()
    assert [line[:4] for line in page.splitlines() if line.startswith(("| 4 |", "| 5 |"))] == ["| 4 ", "| 5 "]
    assert "space standard, England" in page
    assert (tmp_path / "homes.png").stat().st_size > 1000
