"""The area that the whole house leaves to a star's rooms is among their bounds."""

import shutil
from pathlib import Path

import pytest

from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.grammar import SHIPPED, find
from vitruvius.logic.request.house_request import HouseRequest
from vitruvius.logic.why.star import StarWitness


def test_the_area_of_the_house_bounds_its_rooms_and_says_so(tmp_path: Path) -> None:
    """All other rooms stay as they are. The least sides are those that the grammar states."""
    folder = tmp_path / "mine"
    shutil.copytree(SHIPPED / "family", folder)
    (folder / "area.pl").write_text("house_area(60.0, 61.0).")
    builder = Builder(find(folder))
    house = builder.house(HouseRequest(3), 0, 0)
    witness = StarWitness(builder, house)
    line = f"{folder / 'area.pl'}:1:1: house_area(60.0, 61.0)."
    whole = sum(room.width * room.height for room in house.rooms)
    for room in house.rooms:
        sides, left = witness.why(room.name, 0.0).lengths, 61 - (whole - room.width * room.height)
        least = {"bathroom": 2.4, "kitchen": 3.0, "bedroom": 3.2, "hall": 4.2}.get(room.type)
        assert any(line in map(str, side.no_more) for side in sides), room
        for side in sides:
            assert side.least - 1e-6 <= side.value <= side.greatest + 1e-6
            assert least is None or side.greatest * least <= left + 1e-6
    width, height = witness.why("main", 0.0).lengths
    assert height.greatest * width.value == pytest.approx(61 - whole + width.value * height.value)
    assert height.least * width.value == pytest.approx(60 - whole + width.value * height.value)
