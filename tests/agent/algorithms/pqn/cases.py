"""Cases of parallel Q-learning: see ``tests.agent.algorithms.cases``."""

from dataclasses import replace

from vitruvius.agent.algorithms.pqn.config import PQNConfig
from vitruvius.agent.algorithms.table import PRESETS

SMALL = {
    "pqn": PQNConfig(num_envs=8, num_steps=16, steps=1500, seed=2),
    "pqn-recurrent": replace(PRESETS["pqn-recurrent"], num_envs=8, num_steps=16, steps=1500),
}

WRONG = [
    ("num_envs", 0),
    ("steps", -1),
    ("gamma", 1.5),
    ("epsilon", -0.1),
    ("seconds", 0.0),
    ("num_minibatches", 9000),
    ("half_lives", (4.0, 0.0)),
    ("num_steps", 0),
    ("q_lambda", 2.0),
    ("num_minibatches", {"network": "recurrent", "num_envs": 2}),
]
