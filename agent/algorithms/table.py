"""Table of the algorithms and presets, by name.

A new algorithm needs a folder with a config and a learner, and a line here. The table is cheap to import: it
names learners, which need torch, by strings; ``build`` imports them.
"""

from typing import NamedTuple

from agent.algorithms.dqn.config import DQNConfig
from agent.algorithms.map_completion.config import CompletionConfig
from agent.algorithms.paper.config import PaperConfig
from agent.algorithms.pqn.config import PQNConfig
from agent.algorithms.search.config import SearchConfig
from agent.learning.config import TrainConfig


class Algorithm(NamedTuple):
    """Algorithm: its config and its learner."""

    config: type[TrainConfig]
    learner: str
    """Learner, as ``module:Class``."""


TABLE = (
    Algorithm(PQNConfig, "agent.algorithms.pqn.learner:PQN"),
    Algorithm(CompletionConfig, "agent.algorithms.map_completion.learner:MapCompletion"),
    Algorithm(SearchConfig, "agent.algorithms.search.learner:LearnedSearch"),
    Algorithm(DQNConfig, "agent.algorithms.dqn.learner:DQN"),
    Algorithm(PaperConfig, "agent.algorithms.paper.learner:Paper"),
)

ALGORITHMS = {each.config.algorithm: each for each in TABLE}
"""Algorithms by name."""

PRESETS = {name: config for each in TABLE for name, config in each.config.presets().items()}
"""Configs that run by name."""
