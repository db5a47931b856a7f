"""Results small enough to compute by hand, and short evaluations."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from vitruvius.agent.evaluation.episodes import EpisodeScores
from vitruvius.agent.evaluation.result import Result
from vitruvius.sim.config import DEFAULT, PRESETS

SHORT = replace(DEFAULT, steps=600)
"""Simulator settings of an episode in ``short_episodes``."""


@contextmanager
def short_episodes() -> Iterator[None]:
    """Let evaluations use short episodes within this block."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(PRESETS, "default", SHORT)
        yield


def scores(targets, first=None, **more) -> EpisodeScores:
    """Return scores of episodes with these targets; ``first`` are the steps to the first, by default 1."""
    first = np.ones(len(targets)) if first is None else first
    more = {
        "steps": 1500 * len(targets),
        "blocked": 0,
        "interventions": 0,
        "coverage": np.zeros((2, len(targets))),
        "rooms": np.zeros(len(targets), int),
    } | more
    return EpisodeScores(np.array(targets, float), first=np.array(first, float), **more)


def result(*runs, oracle=(10, 20), mode="secondary", rooms=(2, 4), shortest=(100, 200), others=()) -> Result:
    """Return a result of ``agent``, other policies by name, and the oracle, by default in two houses."""
    policies = {"agent": runs, **{name: (each,) for name, each in dict(others).items()}}
    policies["oracle"] = (scores(oracle, shortest),)
    return Result(mode, np.array(rooms), np.array(shortest, float), policies)
