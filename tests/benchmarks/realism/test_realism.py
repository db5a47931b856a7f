"""Two sets of plans: their figures, their distance, and weights that bring them closer."""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from benchmarks.realism.figures import PlanFigures, features, measured
from benchmarks.realism.fit import fitted, off, shares, with_weights
from benchmarks.realism.plans import plans_of
from benchmarks.realism.run import Realism, stated_weights
from benchmarks.realism.statistics import area_under, distance, told_apart
from tests.logic.readers.written import WRITERS
from vitruvius.logic import RequestError, generate, save
from vitruvius.logic.grammar import find
from vitruvius.logic.house.house import House
from vitruvius.logic.house.parts import Door, Room

pytestmark = pytest.mark.second_part("each study is run in small")

ROWS = 150


def test_rooms_doors_and_shared_walls_of_a_plan_are_counted() -> None:
    """Two rooms are side by side, and a third touches the second only at a corner."""
    rooms = (Room(0, 0, 4, 3, "A", "den"), Room(4, 0, 2, 3, "B", "cave"), Room(6, 3, 2, 2, "C", "den"))
    doors = (Door(4, 1, 0, 0.8, ("A", "B")), Door(0, 1, 0, 0.8, ("outside", "A")))
    plan = measured(House(rooms, doors, ()))
    assert plan.rooms == (("den", 12, pytest.approx(4 / 3)), ("cave", 6, 1.5), ("den", 4, 1))
    assert (plan.doors, plan.adjacent) == (1, Counter({("cave", "den"): 1}))
    assert plan.share("den") == pytest.approx(16 / 22)


def test_plans_of_other_programs_have_the_figures_of_their_houses(tmp_path: Path) -> None:
    homes = list(generate(6, grammar="home", seed=0, count=4))
    for number, home in enumerate(homes):
        content = WRITERS["houseexpo"](home, np.random.default_rng(0), 0.0)
        (tmp_path / f"{number}.json").write_bytes(content)
    save(homes, tmp_path / "homes.jsonl")
    read, own = (plans_of(str(tmp_path / name), (), 0, 0) for name in ("", "homes.jsonl"))
    assert len(read) == 8
    for one, other in zip(read[:4], own, strict=True):
        assert one.types == other.types
        assert one.area == pytest.approx(other.area, rel=0.01)


def test_the_distance_of_samples_is_that_by_which_one_is_moved() -> None:
    rng = np.random.default_rng(0)
    values = rng.normal(size=200)
    assert distance(values, values, rng).distance == 0
    moved = distance(values, values + 1.5, rng)
    assert moved.distance == pytest.approx(1.5)
    assert moved.by_halves < 0.6
    other = distance(values, rng.normal(size=200), rng)
    assert other.distance < other.by_halves


@pytest.mark.parametrize(
    ("shift", "spread", "least", "most"), [(0, 1, 0.4, 0.6), (1.5, 1, 0.8, 1), (0, 3, 0.75, 1)]
)
def test_the_classifier_tells_apart_what_differs_and_nothing_else(
    shift: float, spread: float, least: float, most: float
) -> None:
    """Samples differ in the mean, or only in the spread; the error bounds the error of the area."""
    rng = np.random.default_rng(1)
    one, other = rng.normal(size=(ROWS, 4)), rng.normal(size=(ROWS, 4))
    other[:, 0] = shift + spread * other[:, 0]
    area = told_apart(one, other, rng)
    assert least <= area.area <= most
    assert 0 < area.error < 0.05


def test_the_area_under_the_curve_is_the_share_of_pairs_in_order() -> None:
    scores, label = np.array([1.0, 2.0, 2.0, 3.0]), np.array([0.0, 0.0, 1.0, 1.0])
    assert area_under(scores, label).area == (1 + 0.5 + 1 + 1) / 4


def test_each_plan_has_a_row_with_the_same_features() -> None:
    plans = [
        PlanFigures((("den", 4, 1), ("den", 6, 2)), 1, Counter({("den", "den"): 1})),
        PlanFigures((("cave", 2, 1),), 0, Counter()),
    ]
    rows = features(plans, {"den", "cave"})
    assert rows.shape == (2, 3 + 2 * 3 + 3)
    assert rows[0].tolist() == [2, 10, 0.5, 0, 0, 0, 2, 5, 1.5, 0, 0, 1]


def test_weights_are_fitted_to_how_often_types_are_wanted() -> None:
    """Rooms depend only on weights: the fit finds the frequencies of the other set."""
    grammar = find("home")
    stated = stated_weights(grammar)
    assert (stated["bedroom"], stated["wc"], stated["kitchen"]) == (6, 2, 1)

    def plans(weights: dict[str, int]) -> list[PlanFigures]:
        whole = sum(weights.values())
        rooms = [
            (type_, 1.0, 1.0)
            for type_, weight in weights.items()
            for _ in range(round(1000 * weight / whole))
        ]
        return [PlanFigures(tuple(rooms), 0, Counter())]

    def make(folder: Path) -> Sequence[PlanFigures]:
        text = "".join(file.read_text() for file in folder.glob("*.lp"))
        return plans({type_: int(weight) for type_, weight in re.findall(r"weight\((\w+),(\d+)\)", text)})

    wanted = plans({**stated, "study": 9, "bedroom": 1})
    said = list[str]()
    found = fitted(grammar, stated, wanted, make, 3, said.append)
    assert off(shares(plans(found)), shares(wanted)) < 0.02 * off(shares(plans(stated)), shares(wanted))
    assert len(said) == 4


def test_a_grammar_with_fitted_weights_has_these_alone_and_makes_houses(tmp_path: Path) -> None:
    grammar = find("home")
    weights = dict.fromkeys(stated_weights(grammar), 1) | {"study": 50}
    mine = find(with_weights(grammar, weights, tmp_path / "mine"))
    assert stated_weights(mine) == weights
    assert next(generate(5, grammar=tmp_path / "mine", seed=0))


def test_too_few_plans_and_a_file_that_is_none_are_named(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="give 20 or more of each"):
        Realism(houses=1, rooms=(4, 5), out=tmp_path).run()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("no plan")
    with pytest.raises(RequestError, match="0 plans were read"):
        plans_of(str(tmp_path / "mine"), (), 0, 0)
