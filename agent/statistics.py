"""Figures with intervals: the interquartile mean and the stratified bootstrap (Agarwal et al. 2021)."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.stats import trim_mean


class Estimate(NamedTuple):
    """A figure and the interval that holds it with 95 % confidence."""

    value: float
    low: float
    high: float

    def text(self, digits: int = 2) -> str:
        """``0.93 [0.90, 0.95]``."""
        return f"{self.value:.{digits}f} [{self.low:.{digits}f}, {self.high:.{digits}f}]"


def interquartile_mean(scores: np.ndarray, resamples: int = 2000, seed: int = 0) -> Estimate:
    """Mean of the middle half of ``scores`` (H,), one for each house, or (S, H) of S training runs.

    See ``bootstrap`` for its interval. Raises ``ValueError`` for no score or one that is not a number.
    """
    return bootstrap(scores, lambda flat: trim_mean(flat, 0.25, axis=-1), resamples, seed)


def mean(scores: np.ndarray, resamples: int = 2000, seed: int = 0) -> Estimate:
    """Plain mean, for shares, with the same interval."""
    return bootstrap(scores, lambda flat: flat.mean(axis=-1), resamples, seed)


def bootstrap(
    scores: np.ndarray, figure: Callable[[np.ndarray], np.ndarray], resamples: int = 2000, seed: int = 0
) -> Estimate:
    """A figure of all the scores (H,) or (S, H), and its percentile interval by a stratified bootstrap.

    ``figure`` maps (..., S * H) to (...). Houses are drawn with replacement, and for each drawn one as many
    of its S runs, apart from those of other houses. So the interval says how the figure would vary over other
    training runs and over other houses of the same kind; with one run, over houses alone.
    Source: "Deep RL at the edge of the statistical precipice", arXiv:2108.13264; what its library rliable
    does with ``task_bootstrap=True``.
    """
    scores = np.atleast_2d(np.asarray(scores, dtype=float))
    if scores.ndim != 2 or not scores.size or not np.isfinite(scores).all():
        raise ValueError("a figure needs finite scores, at least one: a row for each run")
    rng, (runs, houses) = np.random.default_rng(seed), scores.shape
    drawn = rng.integers(houses, size=(resamples, 1, houses))
    rows = rng.integers(runs, size=(resamples, runs, houses)) if runs > 1 else 0
    low, high = np.percentile(figure(scores[rows, drawn].reshape(resamples, -1)), [2.5, 97.5])
    return Estimate(float(figure(scores.reshape(-1))), float(low), float(high))
