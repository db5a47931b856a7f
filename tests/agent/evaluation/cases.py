"""Results small enough to be worked out by hand, and evaluations that are soon over."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from agent.evaluation.episodes import EpisodeScores
from agent.evaluation.result import Result
from sim.config import DEFAULT, PRESETS

SHORT = replace(DEFAULT, steps=600)
"""Of an episode in ``short_episodes``."""


@contextmanager
def short_episodes() -> Iterator[None]:
    """Within this, agents are measured in such episodes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(PRESETS, "default", SHORT)
        yield


def scores(targets, first=None, **more) -> EpisodeScores:
    """Episodes with these targets; the first one picked up after these steps, by default at once."""
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
    """A result of ``agent``, by default in two houses, of other policies by name, and of the oracle."""
    policies = {"agent": runs, **{name: (each,) for name, each in dict(others).items()}}
    policies["oracle"] = (scores(oracle, shortest),)
    return Result(mode, np.array(rooms), np.array(shortest, float), policies)
