"""Series and laws are read from reports of pytest-benchmark, fitted as in a textbook, and drawn."""

import numpy as np
import pytest

from benchmarks.common.plot import plot
from benchmarks.common.series import fitted_exponent, law, series_of
from tests.benchmarks.reports import ROOMS, report, simulator_report

pytestmark = pytest.mark.second_part("each study is run in small")


def test_a_power_law_is_fitted() -> None:
    exponent, error = fitted_exponent(ROOMS, [3 * n**1.25 for n in ROOMS])
    assert exponent == pytest.approx(1.25)
    assert error == pytest.approx(0, abs=1e-6)


def test_a_power_law_has_its_exponent_and_interval() -> None:
    """The interval equals that of a textbook's formula, with Student's t for two degrees of freedom."""
    sizes, noise = np.array(ROOMS), np.exp([0.1, -0.1, -0.1, 0.1])
    points = np.stack([sizes, 3 * sizes**1.25 * noise, sizes, sizes, 0 * sizes], axis=1)
    x = np.log(sizes) - np.log(sizes).mean()
    margin = 4.303 * np.sqrt(0.04 / 2 / (x**2).sum())
    assert law(points, False) == f"time ~ size^1.25 ± {margin:.2f} from 4 to 32"


def test_what_runs_into_its_limit_is_fitted_by_its_growth_without_what_is_censored() -> None:
    points = series_of(report())["rejection"]
    assert points[:, 4].tolist() == [0, 0, 0, 1]
    assert points[3, 1] == 20
    assert law(points, False) == "each room more takes 10.0 times [10.0, 10.0] as long, from 4 to 6"


@pytest.mark.parametrize("made", [report(), simulator_report()], ids=["seconds", "rates"])
def test_a_study_is_drawn(made) -> None:
    assert plot(made).startswith(b"\x89PNG")


@pytest.mark.parametrize("count", [1, 2])
def test_too_few_sizes_are_not_fitted(count: int) -> None:
    assert law(np.ones((count, 5)) * 4, False) == "too few sizes for a fit"
