"""The learner of each algorithm."""

from collections.abc import Callable
from typing import Any

from agent.algorithms.dqn import DQN
from agent.algorithms.map_completion.learner import MapCompletion
from agent.algorithms.paper import Paper
from agent.algorithms.pqn import PQN
from agent.learning.learner import Learner
from sim import HouseVectorEnv

LEARNERS: dict[str, Callable[[Any, HouseVectorEnv], Learner]] = {
    "pqn": PQN,
    "dqn": DQN,
    "paper": Paper,
    "map-completion": MapCompletion,
}
"""The class of each algorithm, made of a config of ``presets.ALGORITHMS`` and environments."""
