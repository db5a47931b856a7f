"""For a brief without a house, the fewest lines are broken, and lengths change as little as possible."""

from typing import Any

import pytest

from vitruvius.logic import LimitReached, Unsatisfiable, generate, nearest
from vitruvius.logic.workers import nearest as module

pytestmark = pytest.mark.usefixtures("solved_here")


def brief(*areas: float, **more: Any) -> dict[str, Any]:
    """Return a brief with rooms R0, R1 ... of these areas."""
    rooms = [{"name": f"R{number}", **({"area": area} if area else {})} for number, area in enumerate(areas)]
    return {"rooms": rooms, **more}


def test_of_doors_between_all_of_five_rooms_two_are_broken() -> None:
    """No four rectangles of a plan all touch each other: of ten pairs Turán's theorem leaves eight."""
    doors = [[f"R{one}", f"R{other}"] for one in range(5) for other in range(one)]
    found = nearest(brief(0, 0, 0, 0, 0, doors=doors))
    assert [(each.line[:12], each.instead) for each in found.broken] == [("a door joins", "")] * 2
    assert len(found.brief.doors) == 8
    house = next(generate(brief=found.brief))
    joined = {frozenset(door.between) for door in house.doors}
    assert {frozenset(pair) for pair in found.brief.doors} <= joined


def test_an_area_is_made_no_smaller_than_the_outline_asks() -> None:
    """The outline of 8 by 6 m less 27, 4.5 and 4.5 m² leaves 12 m² at most."""
    found = nearest(brief(30, 30, 5, 5, outline={"width": 8, "depth": 6}))
    (broken,) = found.broken
    assert broken.line == "R0 has 27 to 33 m²"
    area = found.brief.rooms[0].area
    assert isinstance(area, tuple)
    assert 12 / 1.15 <= area[0] <= 12
    assert area[1] == pytest.approx(33)


def test_a_length_is_broken_before_a_door() -> None:
    """A door with its margins is wider than this outline. Either may go, and a length is kept in part."""
    narrow = {"width": [0.5, 0.8], "depth": [0.5, 0.9]}
    (broken,) = nearest(brief(0, 0, doors=[["R0", "R1"]], outline=narrow)).broken
    assert broken.line.startswith("the outline is")
    assert broken.instead.startswith("the outline is")


def test_a_brief_that_has_houses_is_its_own_nearest() -> None:
    found = nearest(brief(10, 12, doors=[["R0", "R1"]]))
    assert found.broken == ()
    assert found.brief.doors == (("R0", "R1"),)


def test_what_the_grammar_forbids_whatever_the_brief_says_is_its_proof() -> None:
    with pytest.raises(Unsatisfiable):
        nearest(brief(0), grammar="home", types={"living": 2})


def test_a_limit_says_how_many_lines_were_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def late(*request: Any) -> Any:
        raise LimitReached("house 0 reached its limit")

    monkeypatch.setattr(module, "houses", late)
    with pytest.raises(LimitReached, match=r"the brief could not be decided: house 0"):
        nearest(brief(10))
