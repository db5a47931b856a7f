"""Continuous control: PPO of Stable-Baselines3 drives a body by its speeds, in the backend free.

./run python examples/free_motion.py houses.jsonl --steps 3000000
"""

from dataclasses import dataclass

import tyro
from driving import Driving
from stable_baselines3 import PPO

from vitruvius.sim.adapters.stable_baselines import StableBaselinesVecEnv


@dataclass(frozen=True)
class Example(Driving):
    """Train an agent and compare it with two baselines."""

    def run(self) -> dict[str, float]:
        """Train for all steps, then evaluate; return the targets in an episode of each policy."""
        envs = StableBaselinesVecEnv(self.to_learn_in())
        model = PPO(
            "MlpPolicy",
            envs,
            n_steps=max(2, min(64, self.steps // self.environments)),
            batch_size=2048,
            n_epochs=4,
            learning_rate=1e-3,
            gamma=0.98,
            ent_coef=0.003,
            policy_kwargs={"net_arch": [128, 128]},
            seed=self.seed,
            device="cpu",
        )
        model.learn(self.steps)
        return self.score("SB3 PPO", lambda seen: model.predict(seen, deterministic=False)[0])


if __name__ == "__main__":
    tyro.cli(Example).run()
