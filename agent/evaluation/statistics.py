"""Figures with intervals: the interquartile mean and the stratified bootstrap (Agarwal et al. 2021).

``scipy.stats.bootstrap`` gives the same interval for one run, but does not support several runs. The paper's
own library rliable does, but samples from NumPy's global generator, so that no seed repeats an interval.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np


class Estimate(NamedTuple):
    """Figure with its 95 % confidence interval."""

    value: float
    low: float
    high: float

    def text(self, digits: int = 2) -> str:
        """Return the figure as ``0.93 [0.90, 0.95]``."""
        return f"{self.value:.{digits}f} [{self.low:.{digits}f}, {self.high:.{digits}f}]"

    def signed(self, digits: int = 2) -> str:
        """Return a difference as ``-0.01 [-0.02, +0.01]``."""
        return f"{self.value:+.{digits}f} [{self.low:+.{digits}f}, {self.high:+.{digits}f}]"


def interquartile_mean(scores: np.ndarray, resamples: int = 2000, seed: int = 0) -> Estimate:
    """Return the mean of the middle half of ``scores``: (H,), one for each house, or (S, H) of S runs.

    See ``bootstrap`` for the interval. Raises ``ValueError`` for no score or one that is not a number.
    """
    return bootstrap(scores, _interquartile_mean, resamples, seed)


def paired_difference(
    scores: np.ndarray, others: np.ndarray, resamples: int = 2000, seed: int = 0
) -> Estimate:
    """Return the interquartile mean of ``scores`` minus that of ``others``.

    Both are (H,) or (S, H), of the same houses. The bootstrap samples pairs, so the interval does not include
    what makes a house hard for both. Raises ``ValueError`` for unequal shapes, and as ``bootstrap`` does.
    """
    if np.shape(scores) != np.shape(others):
        raise ValueError(f"paired scores need the same shape, not {np.shape(scores)} and {np.shape(others)}")
    pairs = np.stack([np.atleast_2d(scores), np.atleast_2d(others)])
    numbers = np.arange(pairs[0].size).reshape(pairs[0].shape)

    def figure(chosen: np.ndarray) -> np.ndarray:
        one, other = pairs.reshape(2, -1)[:, chosen.astype(int)]
        return _interquartile_mean(one) - _interquartile_mean(other)

    return bootstrap(numbers, figure, resamples, seed)


def mean(scores: np.ndarray, resamples: int = 2000, seed: int = 0) -> Estimate:
    """Return the plain mean, for fractions, with the same interval."""
    return bootstrap(scores, lambda flat: flat.mean(axis=-1), resamples, seed)


def bootstrap(
    scores: np.ndarray, figure: Callable[[np.ndarray], np.ndarray], resamples: int = 2000, seed: int = 0
) -> Estimate:
    """Return a figure of all scores (H,) or (S, H), with its percentile interval by a stratified bootstrap.

    ``figure`` maps (..., S * H) to (...). A resample has H houses, sampled with replacement. For each of them
    it has S of the house's runs, sampled with replacement and independently of other houses. So the interval
    states how the figure would vary over other training runs and over other houses of the same kind; with one
    run, over houses alone. Raises ``ValueError`` for no score or one that is not a number.

    Source: "Deep RL at the edge of the statistical precipice", arXiv:2108.13264. The method is that of its
    library rliable with ``task_bootstrap=True``.
    """
    scores = np.atleast_2d(np.asarray(scores, dtype=float))
    if scores.ndim != 2 or not scores.size or not np.isfinite(scores).all():
        raise ValueError("a figure needs at least one score, all finite, with a row for each run")
    rng, (runs, houses) = np.random.default_rng(seed), scores.shape
    columns = rng.integers(houses, size=(resamples, 1, houses))
    rows = rng.integers(runs, size=(resamples, runs, houses)) if runs > 1 else 0
    low, high = np.percentile(figure(scores[rows, columns].reshape(resamples, -1)), [2.5, 97.5])
    return Estimate(float(figure(scores.reshape(-1))), float(low), float(high))


def _interquartile_mean(flat: np.ndarray) -> np.ndarray:
    from scipy.stats import trim_mean  # here: it takes longer to import than all else of this package

    return trim_mean(flat, 0.25, axis=-1)
