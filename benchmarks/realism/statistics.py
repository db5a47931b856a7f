"""Comparison of two samples: distances, with those of random halves as a scale, and a two-sample classifier.

The test is that of Lopez-Paz and Oquab, "Revisiting Classifier Two-Sample Tests" (ICLR 2017). Without a
difference, the area under its curve is 0.5, with the error of Hanley and McNeil (Radiology 143, 1982).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import rankdata, wasserstein_distance

Array = NDArray[np.float64]

FOLDS = 10
SHUFFLES = 200
"""Number of random divisions of the pooled values, which give the distances of samples from one set."""
PENALTY = 1.0
"""Penalty of the squared weights of the classifier, over all plans."""


class Distance(NamedTuple):
    """1-D Wasserstein distance of two samples, in their unit."""

    distance: float
    by_halves: float
    """Distance that 95 of 100 random divisions of both samples together stay below."""


class Area(NamedTuple):
    """Area under a receiver operating characteristic, and its standard error."""

    area: float
    error: float


def distance(one: Array, other: Array, rng: np.random.Generator) -> Distance:
    """Return the distance of two samples, and the distance of samples of their sizes from one set."""
    pooled, size = np.concatenate([one, other]), len(one)
    cuts = [rng.permutation(pooled) for _ in range(SHUFFLES)]
    halves = [wasserstein_distance(cut[:size], cut[size:]) for cut in cuts]
    return Distance(float(wasserstein_distance(one, other)), float(np.quantile(halves, 0.95)))


def told_apart(one: Array, other: Array, rng: np.random.Generator) -> Area:
    """Return how well a classifier distinguishes unseen rows of two tables.

    The classifier is a logistic regression of the features and their squares, with cross-validation.
    """
    table = np.vstack([one, other])
    table = np.hstack([table, table**2])
    label = np.repeat([1.0, 0.0], [len(one), len(other)])
    folds = np.empty(len(label), int)
    for each in (0.0, 1.0):  # as many of both in each fold
        (rows,) = np.nonzero(label == each)
        folds[rng.permutation(rows)] = np.arange(len(rows)) % FOLDS
    scores = np.empty(len(label))
    for fold in range(FOLDS):
        seen, unseen = folds != fold, folds == fold
        scores[unseen] = _fitted(table[seen], label[seen], table[unseen])
        # Scores of two classifiers are compared by their ranks.
        scores[unseen] = rankdata(scores[unseen]) / unseen.sum()
    return area_under(scores, label)


def area_under(scores: Array, label: Array) -> Area:
    """Return the area under the curve of scores; a higher score makes 1 more likely."""
    ones, zeros = float(label.sum()), float((1 - label).sum())
    area = (rankdata(scores)[label == 1].sum() - ones * (ones + 1) / 2) / (ones * zeros)
    q1, q2 = area / (2 - area), 2 * area**2 / (1 + area)
    variance = area * (1 - area) + (ones - 1) * (q1 - area**2) + (zeros - 1) * (q2 - area**2)
    return Area(float(area), float(np.sqrt(max(variance, 0.0) / (ones * zeros))))


def _fitted(seen: Array, label: Array, unseen: Array) -> Array:
    """Return the scores of unseen rows."""
    mean, spread = seen.mean(axis=0), seen.std(axis=0)
    spread[spread < 1e-12] = 1.0
    table, sign = (seen - mean) / spread, 2 * label - 1

    def loss(weights: Array) -> tuple[float, Array]:
        margin = sign * (table @ weights[1:] + weights[0])
        pull = -sign / (1 + np.exp(np.clip(margin, -500, 500)))
        slope = np.concatenate([[pull.sum()], table.T @ pull + PENALTY * weights[1:]])
        return float(np.logaddexp(0, -margin).sum() + PENALTY / 2 * weights[1:] @ weights[1:]), slope

    found = minimize(loss, np.zeros(table.shape[1] + 1), jac=True, method="L-BFGS-B").x
    return ((unseen - mean) / spread) @ found[1:]
