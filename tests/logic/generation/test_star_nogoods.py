"""Rooms of a star that do not fit: the nogoods from them, and the limit at which the maker gives up."""

from typing import Any

import numpy as np
import pytest
from clingo import Function, Number

from vitruvius.logic.errors import LimitReached
from vitruvius.logic.generation.builder import Builder
from vitruvius.logic.generation.star import MOST_MISFITS, Nogoods, StarMaker
from vitruvius.logic.grammar import find
from vitruvius.logic.layout.program import Conflict
from vitruvius.logic.placement.placer import Infeasible, Misfit
from vitruvius.logic.request.house_request import HouseRequest

FOUR = HouseRequest(4)


@pytest.fixture(scope="module")
def maker() -> StarMaker:
    found = Builder(find("family")).maker_of(FOUR)
    assert isinstance(found, StarMaker)
    return found


def test_an_order_that_cannot_fit_is_excluded_with_its_sides_and_corners(maker: StarMaker) -> None:
    nogoods = Nogoods()
    layout = maker.layout(FOUR, np.random.default_rng(1), nogoods)
    maker._learn_misfit(Misfit(True, 1), layout, FOUR, nogoods)
    sides = {Function("side", [Number(room.number), room.side]): True for room in layout.rooms}
    assert nogoods.orders == [sides | dict.fromkeys(layout.corners, True)]
    assert [each for each in nogoods.of.values() if each] == [nogoods.orders]
    assert nogoods.misfits == 0


def test_rooms_that_others_might_replace_are_counted_up_to_a_limit(maker: StarMaker) -> None:
    nogoods = Nogoods()
    layout = maker.layout(FOUR, np.random.default_rng(1), nogoods)
    for _ in range(MOST_MISFITS - 1):
        maker._learn_misfit(Misfit(False, 1), layout, FOUR, nogoods)
    assert (nogoods.misfits, nogoods.orders) == (MOST_MISFITS - 1, [])
    assert not any(nogoods.of.values())
    with pytest.raises(LimitReached, match=f"^{MOST_MISFITS} times the sampled rooms did not leave"):
        maker._learn_misfit(Misfit(False, 1), layout, FOUR, nogoods)


def test_conflicts_of_furniture_are_minimal_from_the_third_attempt_on(
    maker: StarMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    place, minimal = maker._placer.place, list[bool]()

    def refuses_twice(layout: Any, *others: Any, **how: bool) -> Any:
        minimal.append(how["minimal"])
        if len(minimal) > 2:
            return place(layout, *others, **how)
        furniture = {atom: True for atom in layout.rooms[0].furniture if atom.name == "on"}
        raise Infeasible({0: Conflict(furniture, ())}, 1)

    monkeypatch.setattr(maker._placer, "place", refuses_twice)
    maker.made(FOUR, np.random.default_rng(1), 10**8)
    assert minimal == [False, False, True]
