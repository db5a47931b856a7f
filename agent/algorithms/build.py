"""Factories of what a config names: its algorithm's learner and network, and the policy that plays by it."""

from importlib import import_module
from typing import Any

from vitruvius.agent.algorithms.table import ALGORITHMS
from vitruvius.agent.learning.config import TrainConfig
from vitruvius.agent.learning.learner import Learner
from vitruvius.agent.policies.policies import Explorer, QPolicy
from vitruvius.sim import HouseVectorEnv


def algorithm_of(config: TrainConfig) -> Any:
    """Return the class of a config's algorithm, a ``Learner``."""
    module, _, name = ALGORITHMS[config.algorithm].learner.partition(":")
    return getattr(import_module(module), name)


def learner_of(config: TrainConfig, envs: HouseVectorEnv) -> Learner:
    """Return a new run; ``envs`` has this rank's share of the config's environments."""
    return algorithm_of(config)(config, envs)


def network_of(config: TrainConfig) -> Any:
    """Return a new network: see ``Learner.network_of``."""
    return algorithm_of(config).network_of(config)


def policy_of(network: Any, config: TrainConfig, envs: HouseVectorEnv, seed: int = 0) -> QPolicy | Explorer:
    """Return the policy that plays by a network: see ``Learner.policy_of``."""
    return algorithm_of(config).policy_of(network, config, envs, seed)
