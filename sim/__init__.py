"""Houses simulated thousands at a time: environments for Gymnasium, registered on import.

``gymnasium.make_vec("sim:Vitruvius/House-v0", num_envs=4096, houses="houses.jsonl")``
"""

import gymnasium

from sim.config import DEFAULT, PAPER, Config
from sim.env import HouseEnv
from sim.vector import HouseVectorEnv

__all__ = ["DEFAULT", "PAPER", "Config", "HouseEnv", "HouseVectorEnv"]

gymnasium.register(
    "Vitruvius/House-v0", entry_point="sim.env:HouseEnv", vector_entry_point="sim.vector:HouseVectorEnv"
)
