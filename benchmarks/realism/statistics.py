"""How far two samples lie apart: distances with what halves of one sample have, and a two-sample classifier.

The test is that of Lopez-Paz and Oquab, "Revisiting Classifier Two-Sample Tests" (ICLR 2017); where it tells
nothing apart the area under its curve is 0.5, with the error of Hanley and McNeil (Radiology 143, 1982).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import rankdata, wasserstein_distance

Array = NDArray[np.float64]

FOLDS = 10
SHUFFLES = 200
"""How often the pooled values are cut in two, to know how far apart samples of one set lie."""
PENALTY = 1.0
"""Of the squared weights of the classifier, over all plans."""


class Distance(NamedTuple):
    """The 1-D Wasserstein distance of two samples, in their unit."""

    distance: float
    by_halves: float
    """What 95 of 100 random cuts of both samples together stay below."""


class Area(NamedTuple):
    """The area under a receiver operating characteristic, and its standard error."""

    area: float
    error: float


def distance(one: Array, other: Array, rng: np.random.Generator) -> Distance:
    """How far two samples are apart, and how far samples of their sizes are that are of one set."""
    pooled, size = np.concatenate([one, other]), len(one)
    cuts = [rng.permutation(pooled) for _ in range(SHUFFLES)]
    halves = [wasserstein_distance(cut[:size], cut[size:]) for cut in cuts]
    return Distance(float(wasserstein_distance(one, other)), float(np.quantile(halves, 0.95)))


def told_apart(one: Array, other: Array, rng: np.random.Generator) -> Area:
    """How well a classifier tells rows of two tables apart that it has not seen: logistic regression of the
    features and their squares, by cross-validation.
    """
    table = np.vstack([one, other])
    table = np.hstack([table, table**2])
    label = np.repeat([1.0, 0.0], [len(one), len(other)])
    folds = np.empty(len(label), int)
    for each in (0.0, 1.0):  # As many of both in each fold.
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
    """The area under the curve of scores, the higher the likelier 1."""
    ones, zeros = float(label.sum()), float((1 - label).sum())
    area = (rankdata(scores)[label == 1].sum() - ones * (ones + 1) / 2) / (ones * zeros)
    q1, q2 = area / (2 - area), 2 * area**2 / (1 + area)
    variance = area * (1 - area) + (ones - 1) * (q1 - area**2) + (zeros - 1) * (q2 - area**2)
    return Area(float(area), float(np.sqrt(max(variance, 0.0) / (ones * zeros))))


def _fitted(seen: Array, label: Array, unseen: Array) -> Array:
    """The scores of unseen rows."""
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
