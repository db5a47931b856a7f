"""Notebooks show a house as its plan, and a list of houses as their plans."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

from IPython.core.formatters import DisplayFormatter

from tests.plans import PLANS
from vitruvius.logic import Houses, load, save
from vitruvius.logic.files.gallery import MAX_SHOWN

HOUSES = [*PLANS.values()]


def test_a_house_is_shown_as_its_plan() -> None:
    root = ET.fromstring(HOUSES[0]._repr_svg_())
    assert root.tag.endswith("svg")
    assert {each.get("data-part") for each in root.iter()} >= {room.name for room in HOUSES[0].rooms}


def test_a_list_of_houses_is_shown_as_their_plans_with_their_indices() -> None:
    page = ET.fromstring(f"<body>{Houses(HOUSES)._repr_html_()}</body>")
    figures = page.findall(".//figure")
    assert [figure[0].text for figure in figures] == [str(index) for index in range(len(HOUSES))]
    for figure, house in zip(figures, HOUSES, strict=True):
        drawn = {each.get("data-part") for each in figure[1].iter()}
        assert drawn >= {room.name for room in house.rooms}
    assert "".join(page[0].itertext()) == f"{len(HOUSES)} houses"


def test_of_a_long_list_the_first_houses_are_shown_and_it_says_so() -> None:
    shown = Houses(HOUSES[:1] * (MAX_SHOWN + 3))._repr_html_()
    assert len(re.findall("<svg", shown)) == MAX_SHOWN
    assert f"{MAX_SHOWN + 3} houses, the first {MAX_SHOWN} shown" in shown
    assert "0 houses" in Houses()._repr_html_()


def test_load_gives_such_a_list_and_a_slice_of_it_is_one(tmp_path: Path) -> None:
    save(HOUSES, tmp_path / "houses.jsonl")
    houses = load(tmp_path / "houses.jsonl")
    assert houses == HOUSES
    assert isinstance(houses[:2], Houses)
    assert houses[:2] == HOUSES[:2]
    assert houses[-1] == HOUSES[-1]


def test_ipython_takes_both() -> None:
    formatted = DisplayFormatter().format
    assert formatted(HOUSES[0])[0]["image/svg+xml"] == HOUSES[0]._repr_svg_()
    assert formatted(Houses(HOUSES))[0]["text/html"] == Houses(HOUSES)._repr_html_()
