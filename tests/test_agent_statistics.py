"""The interquartile mean and its interval."""

import numpy as np
import pytest

from agent.statistics import Estimate, interquartile_mean


def test_the_outer_quarters_do_not_count():
    assert interquartile_mean(np.array([-1e9, 1, 2, 3, 4, 5, 6, 1e9])).value == 3.5


def test_equal_scores_have_no_spread():
    assert interquartile_mean(np.full(10, 0.9)) == pytest.approx((0.9, 0.9, 0.9))


def test_the_interval_holds_the_true_figure_about_19_times_in_20():
    """100 samples of 32 normal scores around 5: fewer than 85 or 100 of 100 would be no 95 % interval."""
    rng = np.random.default_rng(1)
    estimates = [interquartile_mean(rng.normal(5, 1, 32), resamples=400) for _ in range(100)]
    assert 85 <= sum(e.low <= 5 <= e.high for e in estimates) < 100


def test_the_interval_is_a_function_of_scores_and_seed():
    scores = np.random.default_rng(2).random(32)
    assert interquartile_mean(scores) == interquartile_mean(scores)
    assert interquartile_mean(scores) != interquartile_mean(scores, seed=1)


@pytest.mark.parametrize("scores", [[], [1.0, np.nan], [[1.0], [2.0]]])
def test_what_has_no_mean_is_refused(scores):
    with pytest.raises(ValueError, match="finite scores"):
        interquartile_mean(np.array(scores))


def test_an_estimate_reads_as_value_and_interval():
    assert Estimate(0.926, 0.9, 0.951).text() == "0.93 [0.90, 0.95]"
