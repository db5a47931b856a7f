"""The learner of each algorithm."""

from collections.abc import Callable
from typing import Any

from agent.dqn import DQN
from agent.learner import Learner
from agent.map_completion.learner import MapCompletion
from agent.paper import Paper
from agent.pqn import PQN
from agent.viewpoint_q.learner import ViewpointQ
from sim import HouseVectorEnv

LEARNERS: dict[str, Callable[[Any, HouseVectorEnv], Learner]] = {
    "pqn": PQN,
    "dqn": DQN,
    "paper": Paper,
    "map-completion": MapCompletion,
    "viewpoint-q": ViewpointQ,
}
"""The class of each algorithm, made of a config of ``agent.presets.ALGORITHMS`` and environments."""
