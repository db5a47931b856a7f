"""The algorithms and presets, by name. A new algorithm is a folder with a config and a learner, and a line.

Cheap to import: learners, which need torch, are named by strings; ``build`` imports them.
"""

from typing import NamedTuple

from agent.algorithms.dqn.config import DQNConfig
from agent.algorithms.map_completion.config import CompletionConfig
from agent.algorithms.paper.config import PaperConfig
from agent.algorithms.pqn.config import PQNConfig
from agent.algorithms.search.config import SearchConfig
from agent.learning.config import TrainConfig


class Algorithm(NamedTuple):
    """What learns."""

    config: type[TrainConfig]
    learner: str
    """``module:Class`` of a ``Learner``."""


TABLE = (
    Algorithm(PQNConfig, "agent.algorithms.pqn.learner:PQN"),
    Algorithm(CompletionConfig, "agent.algorithms.map_completion.learner:MapCompletion"),
    Algorithm(SearchConfig, "agent.algorithms.search.learner:LearnedSearch"),
    Algorithm(DQNConfig, "agent.algorithms.dqn.learner:DQN"),
    Algorithm(PaperConfig, "agent.algorithms.paper.learner:Paper"),
)

ALGORITHMS = {each.config.algorithm: each for each in TABLE}
"""By name."""

PRESETS = {name: config for each in TABLE for name, config in each.config.presets().items()}
"""Configs that run by name."""
