"""The loop of generation: it learns from each failure, and takes the layout that a failure leads to."""

from collections.abc import Iterator

import numpy as np
import pytest

from vitruvius.logic.errors import OutOfInferences
from vitruvius.logic.generation.loop import Stages, Work, made
from vitruvius.logic.placement.placer import Failure


def stages(fails_at: dict[str, str], layouts: Iterator[str], learnt: list[str]) -> Stages[str, str, str]:
    """Return stages whose layouts fail at ``place`` or ``furnish``; ``learnt`` receives the failures."""

    def place(layout: str) -> str:
        if fails_at.get(layout) == "place":
            raise Failure(layout)
        return f"places of {layout}"

    def furnish(layout: str, placed: str) -> str:
        if fails_at.get(layout) == "furnish":
            raise Failure(placed)
        return f"a house with {placed}"

    def learn(layout: str, failure: Failure) -> str | None:
        learnt.append(str(failure))
        return "another" if layout == "first" else None

    return Stages(lambda: next(layouts), place, furnish, learn)


def test_each_failure_is_learnt_until_a_layout_passes_all_stages() -> None:
    learnt: list[str] = []
    layouts = iter(["one", "two", "three"])
    house = made(stages({"one": "place", "two": "furnish"}, layouts, learnt))
    assert (house, learnt) == ("a house with places of three", ["one", "places of two"])


def test_a_failure_may_lead_to_the_next_layout() -> None:
    learnt: list[str] = []
    house = made(stages({"first": "place"}, iter(["first", "second"]), learnt))
    assert (house, learnt) == ("a house with places of another", ["first"])


def test_a_failure_ends_the_work_without_inferences_and_a_success_does_not() -> None:
    work = Work(np.random.default_rng(0), 10)
    work.spend_in_vain(9)
    work.spend(1)
    with pytest.raises(OutOfInferences):
        work.spend_in_vain(0)
