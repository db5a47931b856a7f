"""Agents that a study compares, by name: their policies, and keys for their scores."""

import hashlib
import importlib
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
import torch
from torch import Tensor

from benchmarks.planner import prior
from benchmarks.planner.prior import Informed
from benchmarks.planner.truth import truth
from vitruvius.agent.algorithms.build import policy_of
from vitruvius.agent.baselines.table import BASELINES
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.learning.environments import shield
from vitruvius.agent.policies.policies import Explorer, Policy
from vitruvius.agent.runs import checkpoint
from vitruvius.agent.runs.released import located
from vitruvius.logic.errors import RequestError
from vitruvius.logic.spelling import unknown
from vitruvius.sim import HouseVectorEnv

EXPLORER = "explorer"

PRIORS = {f"prior-{what}": what for what in (prior.FLOOR, prior.ROOMS)}
"""Explorers that know a part of the house from the start. They must be better: they test the study itself."""

TRUTH = "truth"
"""Explorer that predicts the truth: the upper limit of map completion."""

SOURCES = "planner", "policies", "algorithms", "avoidance.py"
"""Folders and files of ``agent`` that determine how its agents play."""

Maker = Callable[[HouseVectorEnv], Policy]
Playing = TypeVar("Playing", bound=Policy)


@dataclass(frozen=True)
class Contender:
    """One run of an agent."""

    make: Maker
    """Function that makes the agent's policy for environments."""

    key: str
    """Key for everything that the agent's scores depend on, except the environments."""

    config: TrainConfig | None = None
    """Config of the training run, whose sensor the agent uses; None for the simulator's default sensor."""


def contender(name: str) -> Contender:
    """Return the agent of a name.

    A name is a baseline, a prior, ``truth``, ``module:function``, a released agent or a checkpoint.
    ``function`` takes environments and returns a policy; it may have an attribute ``config``, that of a
    training run. Raises ``RequestError`` and ``CheckpointError``.
    """
    if name in PRIORS:
        return Contender(lambda envs: informed(envs, PRIORS[name]), _key(name, inspect.getsource(prior)))
    if name == TRUTH:
        return Contender(truth, _key(name, inspect.getsource(inspect.getmodule(truth) or truth)))
    if name in BASELINES:
        return Contender(lambda envs: BASELINES[name](envs, 0), _key(name))
    if ":" in name:
        make = imported(name)
        key = _key(name, inspect.getsource(inspect.getmodule(make) or make))
        return Contender(make, key, getattr(make, "config", None))
    path = located(name)
    kept = checkpoint.load(path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return Contender(lambda envs: policy_of(kept.network, kept.config, envs), _key(digest), kept.config)


def imported(name: str) -> Maker:
    """Return the function of ``module:function``. Raises ``RequestError`` if there is none."""
    module, _, function = name.partition(":")
    try:
        found = importlib.import_module(module)
    except ImportError as error:
        raise RequestError(f"--agent {name}: {error}. Give module:function that Python can import") from None
    if not callable(make := getattr(found, function, None)):
        public = [key for key, value in vars(found).items() if getattr(value, "__module__", "") == module]
        raise RequestError(f"--agent {name}: {unknown('function', function, public)}")
    return cast(Maker, make)


def informed(envs: HouseVectorEnv, what: str) -> Explorer:
    """Return an explorer with a prior: see ``benchmarks.planner.prior``."""
    policy = Explorer(shield(envs), envs.config)
    policy.tracker = Informed(envs, what)
    return policy


def with_shuffled_predictions(policy: Playing, name: str) -> Playing:
    """Return the policy, with the prediction of another environment, in another house, for each environment.

    Predictions are the results of its tracker's method ``predict``: an array or a tuple of arrays (n, ...), a
    row for each of n environments. Raises ``RequestError`` if there is no such method.
    """
    tracker: Any = getattr(policy, "tracker", None)
    if not hasattr(tracker, "predict"):
        raise RequestError(
            f"--shuffled {name}: the agent's tracker has no method predict: leave --shuffled out"
        )
    tracker.predict = Shuffled(tracker.predict)
    return policy


class Shuffled:
    """Predictor that gives row k the prediction for row k - 1.

    The first row gets the last prediction of the last call. So a batch of one is shuffled too. In the first
    call, the first row gets the prediction for its own last row.
    """

    def __init__(self, predict: Callable[..., Any]) -> None:
        """Shuffle the results of ``predict``."""
        self._predict, self._last = predict, []

    def __call__(self, *given: Any) -> Any:
        """Return the predictions with exchanged rows."""
        made = self._predict(*given)
        columns = list(made) if isinstance(made, tuple) else [made]
        before, self._last = self._last, [column[-1:] for column in columns]
        moved = [
            _joined(last, column[:-1]) for last, column in zip(before or self._last, columns, strict=True)
        ]
        if not isinstance(made, tuple):
            return moved[0]
        return cast(Any, made)._make(moved) if hasattr(made, "_make") else tuple(moved)


def _joined(first: Any, rest: Any) -> Any:
    return torch.cat([first, rest]) if isinstance(rest, Tensor) else np.concatenate([first, rest])


def _key(*parts: str) -> str:
    """Return a hash of the parts, and of ``SOURCES``."""
    root = Path(__file__).parents[2] / "agent"
    files = [file for name in SOURCES for file in sorted([root / name, *(root / name).rglob("*.py")])]
    text = [file.read_text() for file in files if file.is_file()]
    return hashlib.sha256(repr([*parts, *text]).encode()).hexdigest()
