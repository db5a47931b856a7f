"""Figures with intervals: the interquartile mean and its bootstrap (Agarwal et al. 2021)."""

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
    """Mean of the middle half of ``scores`` (H,), one for each house, with a percentile bootstrap.

    Source: "Deep RL at the edge of the statistical precipice", arXiv:2108.13264.

    Houses are what is resampled: the interval says how the figure would vary over other houses of the same
    kind, not over other training runs. Raises ``ValueError`` for no score or one that is not a number.
    """
    scores = np.asarray(scores, dtype=float)
    if scores.ndim != 1 or not len(scores) or not np.isfinite(scores).all():
        raise ValueError("an interquartile mean needs a list of finite scores, at least one")
    drawn = np.random.default_rng(seed).integers(len(scores), size=(resamples, len(scores)))
    low, high = np.percentile(trim_mean(scores[drawn], 0.25, axis=1), [2.5, 97.5])
    return Estimate(float(trim_mean(scores, 0.25)), float(low), float(high))
