"""Interquartile mean and its interval."""

import numpy as np
import pytest
from scipy import stats

from vitruvius.agent.evaluation.statistics import (
    Estimate,
    bootstrap,
    interquartile_mean,
    mean,
    paired_difference,
)


def test_the_outer_quarters_do_not_count():
    assert interquartile_mean(np.array([-1e9, 1, 2, 3, 4, 5, 6, 1e9])).value == 3.5


def test_the_quarters_are_those_of_all_runs_and_houses_together():
    """``aggregate_iqm`` of rliable trims the flat matrix, too; the middle half of 1 to 8 is 3 to 6."""
    assert interquartile_mean(np.array([[1, 8, 2, 7], [3, 6, 4, 5]])).value == 4.5


def test_equal_scores_have_no_spread():
    assert interquartile_mean(np.full(10, 0.9)) == pytest.approx((0.9, 0.9, 0.9))


def test_the_interval_holds_the_true_figure_about_19_times_in_20():
    """A 95 % interval must hold the figure in 85 to 99 of 100 samples of 32 normal scores around 5."""
    rng = np.random.default_rng(1)
    estimates = [interquartile_mean(rng.normal(5, 1, 32), resamples=400) for _ in range(100)]
    assert 85 <= sum(e.low <= 5 <= e.high for e in estimates) < 100


def test_the_bootstrap_samples_houses_and_for_each_as_many_of_its_own_runs():
    """The resamples follow rliable's ``task_bootstrap``: 2 runs of 2 houses give 4 x 4 houses and runs.

    For equal houses, a resample's mean is that of 4 samples of the 2 runs; for equal runs, that of 2 houses.
    """
    runs = bootstrap(np.array([[0.0, 0.0], [1.0, 1.0]]), spread, resamples=20_000)
    assert runs.low == pytest.approx(np.sqrt(0.25 / 4), abs=0.005)
    houses = bootstrap(np.array([[0.0, 1.0], [0.0, 1.0]]), spread, resamples=20_000)
    assert houses.low == pytest.approx(np.sqrt(0.25 / 2), abs=0.005)


def spread(flat: np.ndarray) -> np.ndarray:
    """Return the standard deviation of the resamples' means in place of each: it shows the distribution."""
    means = flat.mean(axis=-1)
    return np.full_like(means, means.std())


@pytest.mark.parametrize("houses", [6, 64, 256])
def test_with_one_run_the_interval_is_scipys(houses):
    """With one run only houses are sampled, which is the percentile bootstrap of ``scipy.stats``."""
    scores = np.random.default_rng(3).random(houses)

    def figure(flat, axis):
        return stats.trim_mean(flat, 0.25, axis=axis)

    theirs = stats.bootstrap(
        (scores,), figure, n_resamples=2000, method="percentile", rng=np.random.default_rng(0)
    ).confidence_interval
    ours = interquartile_mean(scores)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), rel=1e-12)
    assert ours == interquartile_mean(scores[None])


def test_an_interval_matches_another_implementation_of_the_definition():
    """It works resample by resample: draw tasks, draw runs for each, trim, take percentiles."""
    scores = np.random.default_rng(4).random((3, 20))
    rng, figures = np.random.default_rng(5), []
    for _ in range(3000):
        columns = [scores[rng.integers(3, size=3), house] for house in rng.integers(20, size=20)]
        middle = np.sort(np.concatenate(columns))[15:45]
        figures.append(middle.mean())
    ours = interquartile_mean(scores, resamples=3000)
    assert (ours.low, ours.high) == pytest.approx(np.percentile(figures, [2.5, 97.5]), abs=0.01)


def test_a_paired_difference_does_not_vary_with_how_hard_the_houses_are():
    rng = np.random.default_rng(6)
    hard, gain = rng.random(64), 0.05 + rng.normal(0, 0.01, 64)
    found = paired_difference(hard + gain, hard)
    assert found.value == pytest.approx(0.05, abs=0.02)
    assert found.high - found.low < (interquartile_mean(hard).high - interquartile_mean(hard).low) / 2


def test_equal_scores_differ_by_nothing_whatever_is_resampled():
    scores = np.random.default_rng(7).random((3, 20))
    assert paired_difference(scores, scores) == (0, 0, 0)
    with pytest.raises(ValueError, match="paired scores need the same shape"):
        paired_difference(scores, scores[:2])


def test_a_mean_counts_all():
    assert mean(np.array([True, False, False, False])).value == 0.25


def test_the_interval_is_a_function_of_scores_and_seed():
    scores = np.random.default_rng(2).random(32)
    assert interquartile_mean(scores) == interquartile_mean(scores)
    assert interquartile_mean(scores) != interquartile_mean(scores, seed=1)


@pytest.mark.parametrize("scores", [[], [1.0, np.nan], [[[1.0]]]])
def test_what_has_no_mean_is_refused(scores):
    with pytest.raises(ValueError, match="a figure needs at"):
        interquartile_mean(np.array(scores))


def test_an_estimate_reads_as_value_and_interval():
    assert Estimate(0.926, 0.9, 0.951).text() == "0.93 [0.90, 0.95]"
    assert Estimate(-0.001, -0.01, 0.002).signed(3) == "-0.001 [-0.010, +0.002]"
