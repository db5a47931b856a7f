"""Hindsight experience replay (Andrychowicz et al. 2017) with Stable-Baselines3.

The agent also learns from an episode that misses its target, as if the target had been where the body ended.

./run python examples/hindsight.py houses.jsonl --steps 200000
"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import gymnasium
import numpy as np
import tyro
from gymnasium.spaces import Box, Dict
from gymnasium.vector.utils import batch_space
from stable_baselines3 import DQN, HerReplayBuffer
from stable_baselines3.common.vec_env import VecMonitor

from vitruvius.sim import DEFAULT
from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv

CONFIG = replace(DEFAULT, observe=("rays", "odometry"), flat=True, steps=200)
REACH_M = (max(CONFIG.body) + CONFIG.target) / 2
"""Metres along each axis within which the body overlaps the target."""


class Goals(gymnasium.vector.VectorWrapper):
    """Observations with the eye's place as the achieved goal and the target's place as the desired goal."""

    def __init__(self, env: gymnasium.vector.VectorEnv) -> None:
        super().__init__(env)
        place, seen = Box(-np.inf, np.inf, (2,), np.float32), env.single_observation_space
        self.single_observation_space = Dict(observation=seen, achieved_goal=place, desired_goal=place)
        self.observation_space = batch_space(self.single_observation_space, env.num_envs)

    def compute_reward(self, achieved: np.ndarray, desired: np.ndarray, info: Any) -> np.ndarray:
        """Return 1 for each body that overlaps its target; the replay buffer calls this method by name."""
        return (np.abs(achieved - desired).max(axis=-1) < REACH_M).astype(np.float32)

    def goals(self, seen: np.ndarray, info: dict[str, Any]) -> dict[str, np.ndarray]:
        """Return observations with their goals."""
        return {"observation": seen, "achieved_goal": info["pose"][:, :2], "desired_goal": info["target"]}

    def reset(self, **arguments: Any) -> tuple[Any, dict[str, Any]]:
        """Begin episodes."""
        seen, info = self.env.reset(**arguments)
        return self.goals(seen, info), info

    def step(self, actions: Any) -> tuple[Any, ...]:
        """Step the environments; final observations have goals, too."""
        seen, *outcome, info = self.env.step(actions)
        if "final_obs" in info:
            info["final_obs"] = self.goals(info["final_obs"], info["final_info"])
        return self.goals(seen, info), *outcome, info


def main(
    houses: Annotated[Path, tyro.conf.Positional], steps: int = 200_000, environments: int = 16, seed: int = 0
) -> float:
    """Train a DQN with hindsight; print and return the fraction of the last episodes that reached targets."""
    envs = gymnasium.make_vec(
        "vitruvius:Vitruvius/House-v0", environments, houses=houses, preset=CONFIG, seed=seed,
        targets={"task": "all", "terms": {"targets": 1}}, autoreset_mode="SameStep",
    )  # fmt: skip
    theirs, first = VecMonitor(StableBaselinesVecEnv(Goals(envs))), (CONFIG.steps + 1) * environments
    model = DQN(
        "MultiInputPolicy", theirs, seed=seed, device="cpu", train_freq=8,
        replay_buffer_class=HerReplayBuffer, learning_starts=first,  # hindsight needs an episode's end
    )  # fmt: skip
    model.learn(steps)
    reached = float(np.mean([episode["r"] for episode in model.ep_info_buffer or [{"r": 0.0}]]))
    print(f"{steps:,} steps: {100 * reached:.0f} % of the last episodes reached their target")
    return reached


if __name__ == "__main__":
    tyro.cli(main)
