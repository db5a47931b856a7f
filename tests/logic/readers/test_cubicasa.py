"""A model of CubiCasa5K is the same plan after a drawing program saved, moved or scaled its parts."""

import itertools
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from shapely import Polygon, affinity

from tests.logic.readers.written import cubicasa
from vitruvius.logic import RequestError, load
from vitruvius.logic.request.given_plan import read_plan
from vitruvius.logic.request.own_plan import OwnPlan

pytestmark = pytest.mark.filterwarnings("ignore::logic.PlanWarning")

ROOT = Path(__file__).parents[3]
CASES = ROOT.parent / "shared" / "cases"
POINTS = re.compile(r'points="([^"]*)"')

Change = Callable[[Polygon], Polygon]


@pytest.fixture(scope="module")
def model() -> str:
    [home] = load(ROOT / "agent" / "houses" / "home-test-v1.jsonl.gz")[:1]
    return cubicasa(home, np.random.default_rng(0), 0.0).decode()


@pytest.fixture(scope="module")
def plan(model: str, tmp_path_factory: pytest.TempPathFactory) -> OwnPlan:
    return read(model, tmp_path_factory.mktemp("model"))


def read(model: str, folder: Path) -> OwnPlan:
    (folder / "model.svg").write_text(model)
    return read_plan(folder / "model.svg")


def same(one: OwnPlan, other: OwnPlan) -> bool:
    """Return True if two plans have the same rooms, doors and windows, to half a millimetre."""
    parts = [(*plan.rooms, *plan.doors, *plan.windows) for plan in (one, other)]
    boxes = [[part.box for part in some] for some in parts]
    return len(boxes[0]) == len(boxes[1]) and np.allclose(*boxes, atol=5e-4)


def moved(model: str, change: Change) -> str:
    """Return a model with all of its shapes changed."""

    def points(found: re.Match[str]) -> str:
        corners = [tuple(map(float, pair.split(","))) for pair in found[1].split()]
        return f'points="{" ".join(f"{x},{y}" for x, y in change(Polygon(corners)).exterior.coords[:-1])}"'

    return POINTS.sub(points, model)


def test_doors_and_windows_are_known_by_their_class_whatever_ids_they_got(
    model: str, plan: OwnPlan, tmp_path: Path
) -> None:
    numbers = itertools.count()
    saved = re.sub(r'id="(Door|Window|Wall)"', lambda _: f'id="g{next(numbers)}"', model)
    assert next(numbers) > 10
    assert read(saved, tmp_path) == plan


@pytest.mark.parametrize(
    ("transform", "back"),
    [
        ("translate(30,-40)", lambda shape: affinity.translate(shape, -30, 40)),
        ("translate(25)", lambda shape: affinity.translate(shape, -25)),
        ("scale(2)", lambda shape: affinity.scale(shape, 0.5, 0.5, origin=(0, 0))),
        ("scale(-1 .5)", lambda shape: affinity.scale(shape, -1, 2, origin=(0, 0))),
        ("rotate(30)", lambda shape: affinity.rotate(shape, -30, origin=(0, 0))),
        ("rotate(-90, 300, 1e2)", lambda shape: affinity.rotate(shape, 90, origin=(300, 100))),
        ("matrix(0 1 -1 0 5 7)", lambda shape: affinity.affine_transform(shape, (0, 1, -1, 0, -7, 5))),
        ("skewX(20)", lambda shape: affinity.affine_transform(shape, (1, -np.tan(np.pi / 9), 0, 1, 0, 0))),
        (
            " translate(9 8), scale(2)rotate(10)\n",
            lambda shape: affinity.rotate(
                affinity.scale(affinity.translate(shape, -9, -8), 0.5, 0.5, origin=(0, 0)), -10, origin=(0, 0)
            ),
        ),
    ],
)
def test_a_transform_of_a_group_of_a_room_and_of_a_shape_is_applied(
    transform: str, back: Change, model: str, plan: OwnPlan, tmp_path: Path
) -> None:
    """Shapes have their coordinates before the transform. That of nested groups is the product of both."""
    once, twice = moved(model, back), moved(moved(model, back), back)
    whole = once.replace('<g id="Model"', f'<g transform="{transform}" id="Model"')
    shapes = once.replace("<polygon", f'<polygon transform="{transform}"')
    nested = twice.replace("<polygon", f'<polygon transform="{transform}"')
    for changed in (whole, shapes, nested.replace('<g id="Model"', f'<g transform="{transform}" id="Model"')):
        assert same(read(changed, tmp_path), plan)


def test_rectangles_and_paths_of_straight_lines_are_shapes_too(
    plan: OwnPlan, model: str, tmp_path: Path
) -> None:
    def shape(found: re.Match[str]) -> str:
        corners = [tuple(map(float, pair.split(","))) for pair in found[1].split()]
        (west, north), (east, south) = np.min(corners, 0), np.max(corners, 0)
        numbers = next(turn)
        if numbers == "rect":
            return f'<rect x="{west}" y="{north}" width="{east - west}" height="{south - north}"/>'
        d = f"M{west},{north}H{east}V{south}L{west} {south}Z M 0 0 L 9 9"
        if numbers == "relative":
            d = f"m {west},{north} {east - west},0 0,{south - north} h{west - east} z"
        return f'<path d="{d}"/>'

    turn = itertools.cycle(["rect", "absolute", "relative"])
    drawn = re.sub(r'<polygon points="([^"]*)"/>', shape, model)
    assert same(read(drawn, tmp_path), plan)


@pytest.mark.parametrize(
    "transform", ["turn(30)", "rotate()", "scale(1,2,3)", "scale(2", "translate(1,2)x", " ," * 999]
)
def test_a_transform_that_cannot_be_read_is_named_in_one_line(
    transform: str, model: str, tmp_path: Path
) -> None:
    wrong = model.replace('<g id="Model"', f'<g transform="{transform}" id="Model"')
    with pytest.raises(
        RequestError, match=r"plan: the transform of Model Model v1-1, .* cannot be read: apply"
    ):
        read(wrong, tmp_path)


@pytest.mark.skipif(not CASES.exists(), reason="the cases are beside the project")
@pytest.mark.parametrize(
    ("case", "size"),
    [
        ("inkscape-ids/saved-by-inkscape", 8),
        ("svg-transform/group-scaled", 16),
        ("svg-transform/room-moved", 8),
    ],
)
def test_models_that_once_lost_doors_or_their_places_keep_them(case: str, size: float) -> None:
    plan = read_plan(CASES / f"{case}.svg")
    assert (len(plan.rooms), len(plan.doors), len(plan.windows)) == (6, 6, 4)
    assert plan.outline == (0, 0, size, size * 7.5 / 8)
