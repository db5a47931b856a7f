"""The configs that run by name, and the kinds of configs by the names of their algorithms.

Cheap to import: the learners, which need torch, are in ``agent.algorithms.learners``.
"""

from dataclasses import replace

from agent.algorithms.map_completion.config import CompletionConfig
from agent.learning.config import DQNConfig, PaperConfig, PQNConfig, TrainConfig

ALGORITHMS: dict[str, type[TrainConfig]] = {
    kind.algorithm: kind for kind in (PQNConfig, DQNConfig, PaperConfig, CompletionConfig)
}
"""The config of each algorithm."""

PQN = PQNConfig()

PRESETS: dict[str, TrainConfig] = {
    # More environments, and one pass over each rollout: half the time a step.
    "pqn": replace(PQN, num_envs=512, num_steps=16, update_epochs=1, learning_rate=1.5e-3),
    "map-completion": CompletionConfig(
        targets="secondary", num_envs=512, steps=6_000_000, threads=2, learning_rate=3e-3
    ),
    "pqn-recurrent": replace(PQN, network="recurrent", half_lives=(), steps=4_500_000),
    "dqn": DQNConfig(
        num_envs=64, learning_rate=5e-4, final_lr_fraction=0.1, epsilon=1.0, exploration_fraction=0.1
    ),
    "paper": PaperConfig(
        targets="paper-main",
        world="paper",
        avoidance="paper",
        num_envs=1,
        steps=1_225_500,  # 817 episodes at most
        learning_rate=1e-2,
        epsilon=1.0,
        final_epsilon=0.025,
        forward=0.92,
    ),
}
"""Configs that run by name."""

LEARNT_IN = {"paper": "paper-house"}
"""Houses that a preset learns in where none are given: a name of ``sim.environment.arguments``."""
