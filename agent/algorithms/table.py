"""Table of the algorithms and presets, by name.

A new algorithm needs a folder with a config and a learner, and a line here. The table is cheap to import: it
names learners, which need torch, by strings; ``build`` imports them.
"""

from typing import NamedTuple

from vitruvius.agent.algorithms.dqn.config import DQNConfig
from vitruvius.agent.algorithms.map_completion.config import CompletionConfig
from vitruvius.agent.algorithms.paper.config import PaperConfig
from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.search.config import SearchConfig
from vitruvius.agent.learning.config import TrainConfig


class Algorithm(NamedTuple):
    """Algorithm: its config and its learner."""

    config: type[TrainConfig]
    learner: str
    """Learner, as ``module:Class``."""


TABLE = (
    Algorithm(PQNConfig, "vitruvius.agent.algorithms.pqn.learner:PQN"),
    Algorithm(CompletionConfig, "vitruvius.agent.algorithms.map_completion.learner:MapCompletion"),
    Algorithm(SearchConfig, "vitruvius.agent.algorithms.search.learner:LearnedSearch"),
    Algorithm(DQNConfig, "vitruvius.agent.algorithms.dqn.learner:DQN"),
    Algorithm(PaperConfig, "vitruvius.agent.algorithms.paper.learner:Paper"),
)

ALGORITHMS = {each.config.algorithm: each for each in TABLE}
"""Algorithms by name."""

PRESETS = {name: config for each in TABLE for name, config in each.config.presets().items()}
"""Configs that run by name."""
