"""Cases of deep Q-learning from a replay buffer: see ``tests.agent.algorithms.cases``."""

from dataclasses import replace

from vitruvius.agent.algorithms.table import PRESETS

SMALL = {
    "dqn": replace(
        PRESETS["dqn"], num_envs=8, steps=4000, buffer_size=1000, learning_starts=100, batch_size=32
    )
}

WRONG = [
    ("num_envs", 0),
    ("gamma", 1.5),
    ("buffer_size", 10),
    ("train_frequency", -1),
    ("batch_size", 0),
    ("device", "cuda"),
]

QUICK = {"buffer_size": 8000, "learning_starts": 1000, "batch_size": 128}
