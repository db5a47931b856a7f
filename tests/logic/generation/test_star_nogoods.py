"""Rooms of a star that do not fit: the nogoods from them, and the limit at which the maker gives up."""

from typing import Any

import numpy as np
import pytest
from clingo import Function, Number

from tests.logic.workers import in_process
from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.loop import Work
from vitruvius.logic.generation.star import MOST_MISFITS, StarDraft
from vitruvius.logic.layout.program import Conflict
from vitruvius.logic.placement.placer import Infeasible, Misfit
from vitruvius.logic.request.house_request import HouseRequest

FOUR = HouseRequest(4)


@pytest.fixture
def family() -> Builder:
    return in_process.builder("family")


def draft(family: Builder) -> StarDraft:
    return StarDraft(family.loaded, family.maker.feasibility, FOUR, Work(np.random.default_rng(1), 10**8))


def test_an_order_that_cannot_fit_is_excluded_with_its_sides_and_corners(family: Builder) -> None:
    star = draft(family)
    layout = star.sample()
    assert star.learn(layout, Misfit(True, 1)) is None
    sides = {Function("side", [Number(room.number), room.side]): True for room in layout.rooms}
    assert star.orders == [sides | dict.fromkeys(layout.corners, True)]
    assert [each for each in star.nogoods.values() if each] == [star.orders]
    assert star.misfits == 0


def test_rooms_that_others_might_replace_are_counted_up_to_a_limit(family: Builder) -> None:
    star = draft(family)
    layout = star.sample()
    for _ in range(MOST_MISFITS - 1):
        star.learn(layout, Misfit(False, 1))
    assert (star.misfits, star.orders) == (MOST_MISFITS - 1, [])
    assert not any(star.nogoods.values())
    with pytest.raises(LimitReached, match=f"^{MOST_MISFITS} times the sampled rooms left the main room"):
        star.learn(layout, Misfit(False, 1))


def test_conflicts_of_furniture_are_minimal_from_the_third_attempt_on(
    family: Builder, monkeypatch: pytest.MonkeyPatch
) -> None:
    place, minimal = family.placer.place, list[bool]()

    def refuses_twice(layout: Any, *others: Any, **how: bool) -> Any:
        minimal.append(how["minimal"])
        if len(minimal) > 2:
            return place(layout, *others, **how)
        furniture = {atom: True for atom in layout.rooms[0].furniture if atom.name == "on"}
        raise Infeasible({0: Conflict(furniture, ())}, 1)

    monkeypatch.setattr(family.placer, "place", refuses_twice)
    family.maker.made(FOUR, Work(np.random.default_rng(1), 10**8))
    assert minimal == [False, False, True]
